"""The text of an S-Graphs+ ``.g2o`` log: its vertices and edges, checked line by line."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from situgraph.errors import InputError

MAX_BYTES = 1 << 28  # 256 MiB, a million edges; a building's log has less than one

# How many numbers follow the id of a vertex.
VERTICES = {
    "VERTEX_SE3:QUAT": (7,),
    "VERTEX_PLANE": (4, 7),  # with or without the colour g2o adds
    "VERTEX_ROOM": (7,),
    "VERTEX_FLOOR": (7,),
}
# What kinds of vertices an edge names, and how many fields it has in all.
EDGES = {
    "EDGE_ROOM_4PLANES": (("VERTEX_ROOM", *["VERTEX_PLANE"] * 4), 10),
    "EDGE_ROOM_2PLANES": (("VERTEX_ROOM", "VERTEX_PLANE", "VERTEX_PLANE", "VERTEX_ROOM"), 9),
    "EDGE_FLOOR_ROOM": (("VERTEX_FLOOR", "VERTEX_ROOM"), 7),
    "EDGE_SE3_PLANE": (("VERTEX_SE3:QUAT", "VERTEX_PLANE"), 12),
}


@dataclass
class G2oText:
    """Vertices by tag and id; edges by tag as (line, vertices named); ids of FIXed vertices."""

    source: Path
    vertices: dict[str, dict[str, tuple[float, ...]]] = field(
        default_factory=lambda: {tag: {} for tag in VERTICES}
    )
    edges: dict[str, list[tuple[int, tuple[str, ...]]]] = field(
        default_factory=lambda: {tag: [] for tag in EDGES}
    )
    fixed: set[str] = field(default_factory=set)

    def error(self, line: int, problem: str, remedy: str = "is the file complete?") -> InputError:
        """What is wrong in a line of the file."""
        return InputError(self.source, f"line {line}: {problem}", remedy)


def parse_g2o(path: Path) -> G2oText:
    """Read the lines situgraph has a use for; lines of other tags are passed over.

    Raises:
        InputError: no such file, a line that is incomplete or not numeric, two vertices of one id,
            or an edge that names a vertex that is not there; file and line are named.
    """
    text = G2oText(path)
    seen: set[str] = set()
    for number, (tag, *rest) in _lines(path):
        if tag in VERTICES:
            _add_vertex(text, seen, number, tag, rest)
        elif tag in EDGES:
            kinds, length = EDGES[tag]
            if len(rest) != length:
                raise text.error(number, f"{tag} has {len(rest)} fields, expected {length}")
            text.edges[tag].append((number, tuple(rest[: len(kinds)])))
        elif tag == "FIX":
            if not rest or not all(name.isdigit() for name in rest):
                raise text.error(number, "FIX names no vertex")
            text.fixed.update(rest)
        elif not re.fullmatch(r"[A-Z][A-Z0-9_:]*", tag):
            raise text.error(number, f"{tag[:40]!r} is no g2o tag", "name a g2o text file")
    _check_references(text)
    return text


def _add_vertex(text: G2oText, seen: set[str], line: int, tag: str, fields: list[str]) -> None:
    if len(fields) - 1 not in VERTICES[tag]:
        expected = " or ".join(str(n) for n in VERTICES[tag])
        problem = f"{tag} has {max(0, len(fields) - 1)} numbers, expected {expected}"
        raise text.error(line, problem)
    name = fields[0]
    if not name.isdigit():
        raise text.error(line, f"{name[:40]!r} is no vertex id", "ids are whole numbers")
    if name in seen:
        raise text.error(line, f"a second vertex {name}", "ids must be unique")
    seen.add(name)
    text.vertices[tag][name] = _numbers(text, line, tag, fields[1:])


def _lines(path: Path) -> Iterator[tuple[int, list[str]]]:
    """Line numbers and fields of the lines that are neither empty nor comments."""
    try:
        size = path.stat().st_size
        if size > MAX_BYTES:
            raise InputError(path, f"{size / 1e6:.0f} MB is more than a log of one building has")
        data = path.read_bytes()
    except FileNotFoundError:
        raise InputError(path, "no such file", "check the path") from None
    except IsADirectoryError:
        raise InputError(path, "is a directory", "name the graph.g2o in it") from None
    except OSError as error:
        raise InputError(path, f"cannot be read ({error.strerror})") from None
    if b"\0" in data[:4096] or not data.strip():
        raise InputError(path, "is empty or not text", "name a g2o text file")
    for number, line in enumerate(data.decode("utf-8", "replace").splitlines(), start=1):
        fields = line.split()
        if fields and not fields[0].startswith("#"):
            yield number, fields


def _numbers(text: G2oText, line: int, tag: str, fields: list[str]) -> tuple[float, ...]:
    try:
        values = tuple(float(f) for f in fields)
    except ValueError:
        raise text.error(line, f"{tag} has a field that is not a number", "log it again") from None
    if not all(math.isfinite(v) for v in values):
        raise text.error(line, f"{tag} has a number that is not finite", "log it again")
    if tag == "VERTEX_PLANE" and math.hypot(*values[:3]) < 1e-6:
        raise text.error(line, "VERTEX_PLANE has a zero normal", "log it again")
    if tag == "VERTEX_SE3:QUAT" and math.hypot(*values[3:]) < 1e-6:
        raise text.error(line, "VERTEX_SE3:QUAT has a zero quaternion", "log it again")
    return values


def _check_references(text: G2oText) -> None:
    for tag, edges in text.edges.items():
        kinds, _ = EDGES[tag]
        for line, names in edges:
            for name, kind in zip(names, kinds):
                if name not in text.vertices[kind]:
                    problem = f"{tag} names {kind} {name[:40]}, which is not in the file"
                    raise text.error(line, problem)
