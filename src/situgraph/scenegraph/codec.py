"""Scene-graph JSON, version 1: reading, writing and the dictionary form.

``docs/graph-format.md`` describes the format; ``schema.json`` beside this module is its schema.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal

import msgspec

from situgraph.errors import InputError
from situgraph.scenegraph.files import write_atomic
from situgraph.scenegraph.graph import (
    FORMAT,
    VERSION,
    Keyframe,
    Object,
    Plane,
    Room,
    Scalar,
    SceneGraph,
    Storey,
    Warning,
)
from situgraph.scenegraph.validation import validate

MAX_BYTES = 1 << 29  # 512 MiB: several hundred thousand rooms; more is not a scene graph


class Document(msgspec.Struct, frozen=True, omit_defaults=True, kw_only=True):
    """The JSON document: a scene graph with its format and version, where lists may be null."""

    format: Literal["situgraph/scene-graph"]
    version: Literal[1]
    name: str | None = None
    kind: Literal["prior", "online"]
    storeys: tuple[Storey, ...] | None = ()
    rooms: tuple[Room, ...]
    planes: tuple[Plane, ...]
    objects: tuple[Object, ...] | None = ()
    keyframes: tuple[Keyframe, ...] | None = ()
    warnings: tuple[Warning, ...] | None = ()
    modelled_categories: tuple[str, ...] | None = None
    attributes: dict[str, Scalar] | None = None

    def graph(self) -> SceneGraph:
        """The scene graph that the document describes."""
        return SceneGraph(
            name=self.name,
            kind=self.kind,
            storeys=self.storeys or (),
            rooms=self.rooms,
            planes=self.planes,
            objects=self.objects or (),
            keyframes=self.keyframes or (),
            warnings=self.warnings or (),
            modelled_categories=self.modelled_categories,
            attributes=self.attributes or {},
        )


def _plain(value: Any) -> object:
    """A number or an array of numpy's, of which graphs made by programs are full."""
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"a scene graph cannot hold a {type(value).__name__}")


_decoder = msgspec.json.Decoder(Document)
_encoder = msgspec.json.Encoder(enc_hook=_plain)


def _document(graph: SceneGraph) -> Document:
    return Document(
        format=FORMAT,
        version=VERSION,
        name=graph.name,
        kind=graph.kind,
        storeys=graph.storeys,
        rooms=graph.rooms,
        planes=graph.planes,
        objects=graph.objects,
        keyframes=graph.keyframes,
        warnings=graph.warnings,
        modelled_categories=graph.modelled_categories,
        attributes=graph.attributes or None,
    )


def decode(data: bytes, source: object) -> SceneGraph:
    """The valid scene graph in ``data``.

    Raises:
        InputError: the bytes are no scene-graph JSON, or the graph is not valid; the message names
            ``source`` and the place in it.
    """
    if not data.strip(b" \t\r\n\0"):
        raise InputError(source, "the file is empty", "export the scene graph again")
    try:
        document = _decoder.decode(data)
    except msgspec.ValidationError as error:
        raise InputError(source, _place(str(error)), "see docs/graph-format.md") from None
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        hint = "NaN, infinity and comments are not JSON; check that the file is complete"
        raise InputError(source, f"is not valid JSON ({_place(str(error))})", hint) from None
    except RecursionError:
        raise InputError(source, "is nested too deeply", "export the scene graph again") from None
    return validate(document.graph(), source)


def read_json(path: str | Path) -> SceneGraph:
    """The scene graph stored in a JSON file.

    Raises:
        InputError: as ``decode``, and for a missing, unreadable or oversized file.
    """
    path = Path(path)
    try:
        size = path.stat().st_size
        if size > MAX_BYTES:
            raise InputError(
                path, f"{size / 1e6:.0f} MB is more than a scene graph has", "split it by building"
            )
        return decode(path.read_bytes(), path)
    except FileNotFoundError:
        raise InputError(path, "no such file", "check the path") from None
    except IsADirectoryError:
        raise InputError(path, "is a directory", "name a scene-graph file") from None
    except OSError as error:
        raise InputError(path, f"cannot be read ({error.strerror})") from None


def encode(graph: SceneGraph) -> bytes:
    """The graph as JSON bytes, one node a line; reading them back gives an equal graph."""
    raw = msgspec.to_builtins(_document(validate(graph, graph.name or "graph")), enc_hook=_plain)
    lines = []
    for key, value in raw.items():
        name = _encoder.encode(key)
        if isinstance(value, list | tuple) and value and isinstance(value[0], dict):
            items = b",\n  ".join(_encoder.encode(item) for item in value)
            lines.append(name + b": [\n  " + items + b"]")
        else:
            lines.append(name + b": " + _encoder.encode(value))
    return b"{" + b",\n ".join(lines) + b"}\n"


def write_json(graph: SceneGraph, path: str | Path) -> None:
    """Write the graph; the file appears whole or not at all.

    Raises:
        InputError: the graph is not valid, or the file cannot be written.
    """
    write_atomic(Path(path), encode(graph))


def to_dict(graph: SceneGraph) -> dict[str, Any]:
    """The graph as plain dictionaries and lists, as in the JSON."""
    return msgspec.json.decode(encode(graph))  # type: ignore[no-any-return]


def from_dict(document: Mapping[str, Any], source: object = "graph") -> SceneGraph:
    """The valid scene graph that a JSON-like dictionary describes.

    Raises:
        InputError: as ``decode``.
    """
    try:
        return validate(msgspec.convert(dict(document), Document).graph(), source)
    except msgspec.ValidationError as error:
        raise InputError(source, _place(str(error)), "see docs/graph-format.md") from None


def json_schema() -> dict[str, Any]:
    """The JSON Schema (2020-12) of the format, made from the types."""
    schema = msgspec.json.decode(_encoder.encode(msgspec.json.schema(Document)))
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "situgraph scene graph, version 1",
        **schema,
    }


def _place(message: str) -> str:
    """Turn msgspec's ``... - at `$.rooms[3].center``` into ``rooms[3].center: ...``."""
    found = re.fullmatch(r"(?s)(.*?) - at `(?:key in )?\$\.?(.*?)`", message)
    if not found:
        return message[:300]
    what, where = found.groups()
    return f"{where}: {what}"[:300] if where else what[:300]
