"""All settings in one typed record: the stages' own records, a YAML file, and overrides by key.

Every setting is a field of its stage's ``config.py`` with a unit, a source and bounds; none of them
depends on the input.
"""

from __future__ import annotations

import contextlib
import difflib
import math
import os
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import msgspec
from msgspec import inspect

from situgraph.coupling.config import CouplingConfig
from situgraph.errors import ConfigError
from situgraph.matching.config import MatchingConfig
from situgraph.objects.config import ObjectsConfig
from situgraph.plan.config import PlanConfig
from situgraph.sim.config import SimConfig
from situgraph.slam.config import SlamConfig
from situgraph.view.config import ViewConfig

MAX_BYTES = 1_000_000  # a settings file is a page of text


class Settings(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The settings of every stage."""

    plan: PlanConfig = msgspec.field(default_factory=PlanConfig)
    sim: SimConfig = msgspec.field(default_factory=SimConfig)
    slam: SlamConfig = msgspec.field(default_factory=SlamConfig)
    objects: ObjectsConfig = msgspec.field(default_factory=ObjectsConfig)
    matching: MatchingConfig = msgspec.field(default_factory=MatchingConfig)
    coupling: CouplingConfig = msgspec.field(default_factory=CouplingConfig)
    view: ViewConfig = msgspec.field(default_factory=ViewConfig)


class Setting(msgspec.Struct, frozen=True):
    """One setting, as ``situgraph config`` lists it."""

    key: str
    value: Any
    default: Any
    unit: str
    source: str
    description: str


def load_settings(
    file: str | os.PathLike[str] | None = None, overrides: Sequence[str] = ()
) -> Settings:
    """The defaults, changed by a YAML file and then by ``key=value`` overrides, in that order.

    Args:
        file: YAML with one mapping a stage, e.g. ``matching: {rival_ratio: 0.02}``.
        overrides: such as ``"matching.rival_ratio=0.02"``; the value is read as YAML.

    Raises:
        ConfigError: an unknown key (the nearest known one is named), a value of the wrong type or
            out of its bounds, or a file that cannot be read.
    """
    settings = Settings()
    if file is not None:
        settings = _changed(settings, _read_yaml(file), str(file))
    for text in overrides:
        settings = _overridden(settings, text)
    return settings


def describe(settings: Settings | None = None) -> list[Setting]:
    """Every setting with value, default, unit, source and description, stage by stage."""
    return list(_described(settings or Settings(), Settings(), ""))


def to_yaml(settings: Settings) -> str:
    """The settings as commented YAML that ``load_settings`` reads back to the same record."""
    import yaml

    lines: list[str] = []
    shown: tuple[str, ...] = ()
    for item in describe(settings):
        *parents, name = item.key.split(".")
        for depth, parent in enumerate(parents):
            if shown[: depth + 1] != tuple(parents[: depth + 1]):
                lines.append(f"{'  ' * depth}{parent}:")
        shown = tuple(parents)
        comment = (
            " ".join(f"{item.description} [{item.unit}]".split()) if item.unit else item.description
        )
        indent = "  " * len(parents)
        lines += [f"{indent}# {' '.join(comment.split())}"] if comment else []
        flow = yaml.safe_dump(
            {name: item.value}, default_flow_style=True, width=10**6, sort_keys=False
        )
        lines.append(indent + flow.strip()[1:-1])
    return "\n".join(lines) + "\n"


def _read_yaml(file: str | os.PathLike[str]) -> Any:
    import yaml

    try:
        with open(file, "rb") as stream:
            data = stream.read(MAX_BYTES + 1)
        if len(data) > MAX_BYTES:
            raise ConfigError(f"{file}: larger than {MAX_BYTES} bytes; is it a settings file?")
        # Aliases could unfold a small file to any size, and settings have no use for them.
        if any(isinstance(event, yaml.AliasEvent) for event in yaml.parse(data, yaml.SafeLoader)):
            raise ConfigError(f"{file}: YAML aliases are not accepted; write the value out")
        return yaml.safe_load(data)
    except OSError as error:
        raise ConfigError(f"{file}: cannot be read ({error.strerror}); name a YAML file") from error
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        reason = " ".join(str(error).split()) or type(error).__name__
        raise ConfigError(f"{file}: not YAML ({reason}); see `situgraph config --yaml`") from error


def _overridden(settings: Settings, text: str) -> Settings:
    import yaml

    key, equals, value = text.partition("=")
    if not equals:
        raise ConfigError(f"--set {text}: expected KEY=VALUE, e.g. matching.rival_ratio=0.02")
    try:
        parsed = yaml.safe_load(value)
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        raise ConfigError(f"--set {text}: the value is not YAML; quote it") from error
    try:
        return _changed(settings, _nested(key, parsed), f"--set {key}")
    except ConfigError:
        if isinstance(parsed, str):
            raise
        # A text setting takes 12 or `it: is` as they stand; anything else refuses the text too.
        with contextlib.suppress(ConfigError):
            return _changed(settings, _nested(key, value), f"--set {key}")
        raise


def _nested(key: str, value: Any) -> Any:
    for part in reversed(key.strip().split(".")):
        value = {part: value}
    return value


def _changed(settings: Settings, change: Any, place: str) -> Settings:
    """The settings with a nested mapping of changes laid over them, validated."""
    plain = msgspec.to_builtins(settings)
    merged = _laid_over(plain, {} if change is None else change, Settings, place, "")
    try:
        # Not strict: YAML takes 1e-3 for a string, and tuples are written as lists.
        return msgspec.convert(merged, Settings, strict=False)
    except msgspec.ValidationError as error:
        problem, _, where = str(error).partition(" - at ")
        key = where.strip("`").removeprefix("$.")
        raise ConfigError(f"{place}: {key}: {problem[:1].lower()}{problem[1:]}") from error


def _laid_over(plain: dict[str, Any], change: Any, record: Any, place: str, prefix: str) -> Any:
    if not isinstance(change, Mapping):
        raise ConfigError(
            f"{place}: {prefix.rstrip('.') or 'the file'} must be a mapping of settings"
        )
    types = {f.name: _bare(f.type) for f in inspect.type_info(record).fields}  # type: ignore[attr-defined]
    merged = dict(plain)
    for name, value in change.items():
        if name not in types:
            raise ConfigError(
                f"{place}: unknown setting {prefix}{name}{_nearest(f'{prefix}{name}')}"
            )
        kind = types[name]
        if isinstance(kind, inspect.StructType):
            merged[name] = _laid_over(plain[name], value, kind.cls, place, f"{prefix}{name}.")
        elif isinstance(kind, inspect.DictType) and isinstance(value, Mapping):
            merged[name] = {**plain[name], **value}
        else:
            merged[name] = value
        if not _finite(merged[name]):
            raise ConfigError(f"{place}: {prefix}{name} must be a finite number")
    return merged


def _finite(value: Any) -> bool:
    if isinstance(value, Mapping):
        return all(_finite(v) for v in value.values())
    if isinstance(value, list | tuple):
        return all(_finite(v) for v in value)
    if isinstance(value, str):
        return value.strip().lower().lstrip("+-") not in ("nan", "inf", "infinity")
    return not isinstance(value, float) or math.isfinite(value)


def _nearest(key: str) -> str:
    known = [item.key for item in describe()] if "." in key else list(Settings.__struct_fields__)
    found = difflib.get_close_matches(key, known, n=1, cutoff=0.5)
    # A key typed without its stage is meant by its last part.
    found = [item.key for item in describe() if item.key.endswith(f".{key}")][:1] or found
    return f"; the nearest is {found[0]}" if found else "; see `situgraph config`"


def _described(value: Any, default: Any, prefix: str) -> Iterator[Setting]:
    for field in inspect.type_info(type(value)).fields:  # type: ignore[attr-defined]
        now, before = getattr(value, field.name), getattr(default, field.name)
        if isinstance(_bare(field.type), inspect.StructType):
            yield from _described(now, before, f"{prefix}{field.name}.")
            continue
        meta = (
            field.type if isinstance(field.type, inspect.Metadata) else inspect.Metadata(field.type)
        )
        extra, schema = meta.extra or {}, meta.extra_json_schema or {}
        yield Setting(
            key=f"{prefix}{field.name}",
            value=msgspec.to_builtins(now),
            default=msgspec.to_builtins(before),
            unit=str(extra.get("unit", "")),
            source=str(extra.get("source", "")),
            description=str(schema.get("description", "")),
        )


def _bare(kind: inspect.Type) -> inspect.Type:
    return kind.type if isinstance(kind, inspect.Metadata) else kind
