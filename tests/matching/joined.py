"""Walls in one line seen as one plane: what a map makes of a real building."""

from __future__ import annotations

import math

import msgspec
import numpy as np

from situgraph.scenegraph.graph import Plane, SceneGraph

TURN = math.radians(1.0)  # faces of one line: directions that differ less
NEAR = 0.15  # m; and lines that lie nearer at either room's centre


def joined(graph: SceneGraph) -> SceneGraph:
    """The graph with the faces of one line, of different rooms, as the first of them."""
    kept: list[tuple[Plane, np.ndarray]] = []  # a face, and the centre of its room
    name: dict[str, str] = {}
    rooms = []
    for room in graph.rooms:
        mine, center = [], np.array(room.center)
        for plane in map(graph.plane_by_id.__getitem__, room.planes):
            line = name.get(plane.id) or next(
                (p.id for p, c in kept if p.id not in mine and _one_line(p, plane, (c, center))),
                plane.id,
            )
            if line == plane.id and all(p.id != line for p, _ in kept):
                kept.append((plane, center))
            name[plane.id] = line
            mine.append(line)
        rooms.append(msgspec.structs.replace(room, planes=tuple(mine)))
    objects = tuple(
        msgspec.structs.replace(o, planes=tuple(dict.fromkeys(name.get(p, p) for p in o.planes)))
        for o in graph.objects
    )
    planes = tuple(p for p in graph.planes if name.get(p.id, p.id) == p.id)
    return graph.replace(rooms=tuple(rooms), planes=planes, objects=objects)


def _one_line(one: Plane, two: Plane, places: tuple[np.ndarray, np.ndarray]) -> bool:
    first, second = np.array(one.normal), np.array(two.normal)
    apart = [abs(float((first - second) @ p) + one.offset - two.offset) for p in places]
    return float(first @ second) >= math.cos(TURN) and max(apart) <= NEAR
