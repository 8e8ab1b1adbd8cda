"""Which output channel of a network is which category: maps in YAML."""

from __future__ import annotations

from importlib import resources
from pathlib import Path

import msgspec
import yaml

from situgraph.errors import InputError
from situgraph.scenegraph.categories import canonical, snake_case

MAX_BYTES = 1 << 20
INCLUDED = ("ade20k", "coco")


class ClassMap(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """``names`` by channel; ``classes`` channels in all; ``stuff`` has no instances of its own.

    Channels that are not named are background: they take pixels and yield no object.
    """

    classes: int
    names: dict[int, str]
    scheme: str = ""
    stuff: tuple[int, ...] = ()

    def category(self, channel: int) -> str | None:
        """The canonical category of a channel, None for background."""
        name = self.names.get(channel)
        if name is None:
            return None
        return canonical(name, self.scheme) if self.scheme else snake_case(name)

    @property
    def categories(self) -> frozenset[str]:
        """All categories the map can give."""
        return frozenset(c for k in self.names if (c := self.category(k)) is not None)


def class_map(source: str | Path) -> ClassMap:
    """A map by name (``ade20k``, ``coco``) or from a YAML file.

    Raises:
        InputError: no such file, or not a class map.
    """
    if str(source) in INCLUDED:
        text = (resources.files("situgraph.objects.classmaps") / f"{source}.yaml").read_text()
    else:
        path = Path(source)
        try:
            if path.stat().st_size > MAX_BYTES:
                raise InputError(path, "is too large for a class map", "see docs/objects.md")
            text = path.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            remedy = f"name a YAML file or one of {', '.join(INCLUDED)}"
            raise InputError(path, f"cannot be read ({error})", remedy) from None
    try:
        found = msgspec.convert(yaml.safe_load(text), ClassMap, strict=True)
    except (msgspec.ValidationError, yaml.YAMLError) as error:
        problem = " ".join(str(error).split())[:200]
        raise InputError(source, f"is no class map ({problem})", "see docs/objects.md") from None
    if found.scheme not in ("", "ade20k", "coco", "ifc", "osm"):
        raise InputError(
            source, f"unknown scheme {found.scheme!r}", "leave it out or use ade20k, coco"
        )
    if any(not 0 <= k < found.classes for k in (*found.names, *found.stuff)):
        raise InputError(source, f"a channel outside 0..{found.classes - 1}", "correct the map")
    return found
