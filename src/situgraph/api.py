"""The Python interface to files: read a graph of any kind, save one.

``situgraph`` re-exports these names beside those of the stages (``match``, ``PlanIndex`` ...).
"""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import TYPE_CHECKING

from situgraph.errors import InputError

if TYPE_CHECKING:
    from situgraph.io.g2o import Part
    from situgraph.plan.config import PlanConfig
    from situgraph.scenegraph.graph import SceneGraph

PathLike = str | os.PathLike[str]

_BY_SUFFIX = {
    ".json": "json",
    ".ifc": "ifc",
    ".osm": "osm",
    ".g2o": "g2o",
}
_READABLE = (
    "name a scene graph (.json), a building model (.ifc), an indoor map (.osm) or a .g2o log"
)


def load(path: PathLike, part: Part | None = None, *, plan: PlanConfig | None = None) -> SceneGraph:
    """The scene graph in a file of any readable kind; what the file holds decides, then its name.

    Args:
        path: scene-graph JSON, IFC, OSM indoor map, or S-Graphs+ ``.g2o``.
        part: of a ``.g2o``, the ``"free"`` or the ``"fixed"`` part (default: the free one, unless
            only the other has rooms); no other kind has parts.
        plan: settings for building models.

    Raises:
        InputError: no such file, a folder, an empty or unknown file, or one its reader refuses.
    """
    source = Path(path)
    kind = _kind(source)
    if kind == "json":
        from situgraph.scenegraph.codec import read_json

        return read_json(source)
    if kind == "g2o":
        from situgraph.io.g2o import read_g2o

        return read_g2o(source, part)
    return read_plan(source, plan)


def load_prior(
    path: PathLike, part: Part | None = None, *, plan: PlanConfig | None = None
) -> SceneGraph:
    """A graph in the role of PRIOR: of a ``.g2o`` the FIXed part, or the free one if none is FIXed.

    Raises:
        InputError: as ``load``.
    """
    source = Path(path)
    if part is None and _kind(source) == "g2o":
        from situgraph.io.g2o import read_g2o

        return read_g2o(source, prefer="fixed")
    return load(source, part, plan=plan)


def save(graph: SceneGraph, path: PathLike) -> None:
    """Write a graph as scene-graph JSON; the file appears whole or not at all.

    Raises:
        InputError: the name ends like another kind of file, the graph is not valid, or the file
            cannot be written.
    """
    from situgraph.scenegraph.codec import write_json

    target = Path(path)
    if _BY_SUFFIX.get(target.suffix.lower(), "json") != "json":
        problem = f"a scene graph is written as JSON, not as {target.suffix}"
        raise InputError(target, problem, f"name it {target.with_suffix('.json').name}")
    write_json(graph, target)


def read_plan(
    path: PathLike, config: PlanConfig | None = None, *, cached: bool = True
) -> SceneGraph:
    """The A-Graph of a building: from an IFC file or an OSM indoor map, else as ``load_prior``.

    An IFC file that was read before with the same settings and version comes from the user's cache.

    Raises:
        InputError: as ``load``.
    """
    source = Path(path)
    kind = _kind(source)
    if kind == "osm":
        from situgraph.plan.osmag import read_osm

        return read_osm(source, config)
    if kind != "ifc":
        return load_prior(source)
    from situgraph.plan.config import PlanConfig

    settings = config or PlanConfig()
    return _cached_ifc(source, settings) if cached else _read_ifc(source, settings)


def _read_ifc(source: Path, config: PlanConfig) -> SceneGraph:
    from situgraph.plan.ifc import read_ifc

    return read_ifc(source, config)


def _cached_ifc(source: Path, config: PlanConfig) -> SceneGraph:
    import msgspec

    from situgraph import __version__
    from situgraph.cache import code_key, content_key, plan_cache
    from situgraph.scenegraph.codec import decode, encode

    cache = plan_cache()
    code = code_key("geometry", "scenegraph", "plan")
    settings = msgspec.json.encode(config).decode()
    # The name is part of the key because warnings and graph may be named after the file.
    key = content_key(source, __version__, code, settings, source.name)
    kept = cache.get(key)
    if kept is not None:
        try:
            return decode(kept, source)
        except InputError:
            pass  # the entry was damaged: read the model again
    graph = _read_ifc(source, config)
    cache.put(key, encode(graph))
    return graph


def _kind(path: Path) -> str:
    """What kind of graph the file holds: json, ifc, osm or g2o."""
    try:
        with open(path, "rb") as file:
            head = file.read(4096)
    except FileNotFoundError:
        raise InputError(path, "no such file", "check the path") from None
    except IsADirectoryError:
        raise InputError(path, "is a folder, not a graph", _READABLE) from None
    except (OSError, ValueError) as error:
        raise InputError(path, f"cannot be read ({error})", "check the path") from None
    if not head.strip(b"\0 \t\r\n"):
        problem = "is empty" if not head else "holds nothing but zeros or blanks"
        raise InputError(path, problem, _READABLE)
    text = head.removeprefix(b"\xef\xbb\xbf").lstrip()
    if text.startswith(b"ISO-10303-21"):
        return "ifc"
    if text.startswith((b"{", b"[")):
        return "json"
    if re.match(rb"(VERTEX_|EDGE_|FIX\s|PARAMS_)", text):
        return "g2o"
    if re.match(rb"<(\?xml|osm|!--)", text) and b"<osm" in head:
        return "osm"
    kind = _BY_SUFFIX.get(path.suffix.lower())
    if kind is None:
        raise InputError(path, "is no kind of graph situgraph reads", _READABLE)
    return kind
