"""S-Graphs+ logs (``graph.g2o``) as scene graphs.

Such a log holds one factor graph: keyframes, vertical planes, rooms (four planes), corridors (two
planes) and floors. Its free vertices are the S-Graph; the FIXed ones are the A-Graph it was given,
and of a logged A-Graph everything is FIXed. The ids of the vertices are kept as ids of our nodes.
"""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Literal

import msgspec

from situgraph.errors import InputError
from situgraph.geometry.planes import orient_towards
from situgraph.io.g2o_text import G2oText, parse_g2o
from situgraph.scenegraph.graph import Keyframe, Plane, Pose, Room, SceneGraph, Storey, Warning
from situgraph.scenegraph.validation import validate

Part = Literal["free", "fixed"]

MAX_STAMP_FOLDERS = 100_000
STEEPEST = 0.5  # |n_z| of a plane that no longer counts as a wall (30 degrees off the vertical)


def read_g2o(path: str | Path, part: Part | None = None, *, prefer: Part = "free") -> SceneGraph:
    """The scene graph in an S-Graphs+ log; frame: the log's map frame, z up, metres.

    Normals are turned into the room they bound; those that bound none face the first keyframe
    that saw them. A plane with rooms on both sides becomes two faces (``"66"`` and ``"66b"``).
    Stamps come from the keyframe folders beside the file (``000007/data``), else keyframes are
    counted 0, 1, 2.

    Args:
        path: the ``.g2o`` file.
        part: ``"free"`` (the S-Graph) or ``"fixed"`` (the A-Graph); None takes the preferred one
            if it has rooms, else the other.
        prefer: the part that None prefers.

    Raises:
        InputError: as ``parse_g2o``, or the part has no rooms.
    """
    log = parse_g2o(Path(path))
    other: Part = "fixed" if (part or prefer) == "free" else "free"
    for choice in (part,) if part else (prefer, other):
        if _vertices(log, "VERTEX_ROOM", choice):
            return validate(_graph(log, choice), log.source)
    if part is not None and log.vertices["VERTEX_ROOM"]:
        raise InputError(log.source, f"has no {part} room", f"its {other} part has some")
    raise InputError(log.source, "has no VERTEX_ROOM", "log the S-Graph after rooms were found")


def _vertices(log: G2oText, tag: str, part: str) -> dict[str, tuple[float, ...]]:
    fixed = part == "fixed"
    return {k: v for k, v in log.vertices[tag].items() if (k in log.fixed) == fixed}


def _graph(log: G2oText, part: Part) -> SceneGraph:
    centers = {k: v[:3] for k, v in _vertices(log, "VERTEX_ROOM", part).items()}
    walls = {
        k: v[:4] for k, v in log.vertices["VERTEX_PLANE"].items() if abs(_unit(v)[2]) < STEEPEST
    }
    # A corridor's edge names, last, the vertex of its cluster's centre, which is no room itself.
    helpers = {names[3] for _, names in log.edges["EDGE_ROOM_2PLANES"]}
    bounds: dict[str, list[str]] = {room: [] for room in centers if room not in helpers}
    for tag, count in (("EDGE_ROOM_4PLANES", 4), ("EDGE_ROOM_2PLANES", 2)):
        for _, (room, *names) in log.edges[tag]:
            if room in bounds:
                new = [p for p in names[:count] if p in walls and p not in bounds[room]]
                bounds[room].extend(new)
    planes, rooms_planes = _faces(log, part, walls, centers, bounds)
    storeys, storey_of = _storeys(log, part, bounds)
    flat = [p for p in _vertices(log, "VERTEX_PLANE", part) if p not in walls]
    message = f"{len(flat)} planes of the log are no walls (too far off the vertical) and left out"
    return SceneGraph(
        name=log.source.resolve().parent.name if log.source.stem == "graph" else log.source.stem,
        kind="online" if part == "free" else "prior",
        storeys=storeys,
        rooms=tuple(
            Room(id=r, center=_vec3(centers[r]), planes=rooms_planes[r], storey=storey_of.get(r))
            for r in bounds
        ),
        planes=planes,
        keyframes=_keyframes(log) if part == "free" else (),
        warnings=(Warning("plane-not-vertical", message, tuple(flat)),) if flat else (),
    )


def _faces(
    log: G2oText,
    part: Part,
    walls: dict[str, tuple[float, ...]],
    centers: dict[str, tuple[float, ...]],
    bounds: dict[str, list[str]],
) -> tuple[tuple[Plane, ...], dict[str, tuple[str, ...]]]:
    """Each side of a wall on which rooms lie as a plane, and the planes of each room."""
    faces: dict[str, list[Plane]] = {
        name: [] for name in walls if (name in log.fixed) == (part == "fixed")
    }
    of_room = {}
    for room, names in bounds.items():
        chosen = []
        for name in names:
            sides = faces.setdefault(name, [])
            face = _facing(name, walls[name], centers[room])
            if face.normal not in [side.normal for side in sides]:
                sides.append(face if not sides else msgspec.structs.replace(face, id=f"{name}b"))
            chosen.append(next(side.id for side in sides if side.normal == face.normal))
        of_room[room] = tuple(chosen)
    watcher: dict[str, tuple[float, ...]] = {}
    for _, (keyframe, name) in log.edges["EDGE_SE3_PLANE"]:
        if keyframe not in log.fixed:
            watcher.setdefault(name, log.vertices["VERTEX_SE3:QUAT"][keyframe])
    for name, sides in faces.items():
        if not sides:
            sides.append(_facing(name, walls[name], watcher.get(name)))
    return tuple(plane for sides in faces.values() for plane in sides), of_room


def _unit(wall: tuple[float, ...]) -> tuple[float, ...]:
    length = math.hypot(*wall[:3])
    return tuple(v / length for v in wall[:4])


def _facing(name: str, wall: tuple[float, ...], point: tuple[float, ...] | None) -> Plane:
    """The wall's plane, turned to where the point lies, or as logged when there is none."""
    unit = _unit(wall)
    if point is not None:
        normals, offsets = orient_towards([unit[:3]], [unit[3]], point[:3])
        unit = (*normals[0].tolist(), float(offsets[0]))
    return Plane(name, _vec3(unit), unit[3], source=f"VERTEX_PLANE {name}")


def _storeys(
    log: G2oText, part: Part, rooms: dict[str, list[str]]
) -> tuple[tuple[Storey, ...], dict[str, str]]:
    floors = _vertices(log, "VERTEX_FLOOR", part)
    storeys = tuple(Storey(id=name, elevation=pose[2]) for name, pose in floors.items())
    storey_of = {
        room: floor for _, (floor, room) in log.edges["EDGE_FLOOR_ROOM"] if floor in floors
    }
    if len(floors) == 1:  # corridors are not tied to the floor, but there is only one
        storey_of = dict.fromkeys(rooms, storeys[0].id)
    return storeys, storey_of


def _keyframes(log: G2oText) -> tuple[Keyframe, ...]:
    stamps = _stamps(log.source.parent)
    found = []
    for index, (name, values) in enumerate(_vertices(log, "VERTEX_SE3:QUAT", "free").items()):
        length = math.hypot(*values[3:])
        pose: Pose = (*_vec3(values), *(v / length for v in values[3:]))  # type: ignore[assignment]
        found.append(Keyframe(id=name, stamp=stamps.get(name, float(index)), pose=pose))
    return tuple(found)


def _stamps(folder: Path) -> dict[str, float]:
    """Seconds by vertex id, from the ``data`` files of the keyframe folders, if there are any."""
    found = {}
    for index in range(MAX_STAMP_FOLDERS):
        try:
            with open(folder / f"{index:06d}" / "data", encoding="utf-8", errors="replace") as file:
                text = file.read(1 << 16)
        except OSError:
            break
        stamp = re.search(r"^stamp\s+\S+\s+(\d+)\s*$", text, re.MULTILINE)
        vertex = re.search(r"^id\s+(\d+)\s*$", text, re.MULTILINE)
        if stamp and vertex:
            found[vertex[1]] = int(stamp[1]) / 1e9
    return found


def _vec3(values: tuple[float, ...]) -> tuple[float, float, float]:
    return values[0], values[1], values[2]
