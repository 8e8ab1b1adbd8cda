"""What a solution predicts of things not seen yet, in the map frame.

Objects on the walls of the rooms that were seen, walls of theirs that were not, and the rooms next
to them. Predictions of several solutions about one thing have the same ``key``, or lie at the same
``place``, and can be compared.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Literal, NamedTuple

import numpy as np

from situgraph.geometry.poses import Placement
from situgraph.matching.bent_solution import Answer
from situgraph.matching.tables import Floats
from situgraph.scenegraph.graph import Object, Room, SceneGraph

Kind = Literal["object", "wall", "room"]
Outline = tuple[tuple[float, float], ...]
Entrance = tuple[tuple[float, float], str | None, Room]

FACING = math.radians(30)  # walls whose directions differ less are on one side of a room
GAP = 0.6  # metres; two faces this near are those of one wall
STEP = 0.8  # metres from an entrance into the room behind it
BESIDE = 1.0  # metres by which a room may lie aside of the wall to the next one


class Prediction(NamedTuple):
    """One thing a solution predicts.

    ``outcome`` are numbers that say how it looks, to be compared with a tolerance: places of
    objects, distances of walls, walls of a room by direction and offset.
    """

    kind: Kind
    room: str  # the online room from which it is seen
    look_for: str
    plane: str | None  # the online plane it is on, where it is known
    planned_plane: str | None
    planned_room: str
    place: tuple[float, float]
    outcome: Outline
    contents: tuple[tuple[str, int], ...] = ()


def predictions(solution: Answer, online: SceneGraph, prior: SceneGraph) -> list[Prediction]:
    """All that a solution predicts about what was not seen."""
    back = solution.transform.inverse()
    found: list[Prediction] = []
    for mine, theirs in solution.rooms.items():
        room = prior.room_by_id[theirs]
        found += _objects(solution, online, prior, back, mine, room)
        found += _walls(solution, online, prior, back, mine, room)
        found += _rooms(solution, prior, back, mine, room)
    return found


def _objects(
    solution: Answer,
    online: SceneGraph,
    prior: SceneGraph,
    back: Placement,
    mine: str,
    room: Room,
) -> Iterator[Prediction]:
    """The objects of each category on each wall."""
    seen = {solution.planes[p]: p for p in online.room_by_id[mine].planes if p in solution.planes}
    by_wall: dict[tuple[str | None, str], list[Object]] = {}
    for item in prior.objects_by_room.get(room.id, ()):
        if item.category in prior.modelled:
            wall = next((p for p in item.planes if p in seen), None)
            by_wall.setdefault((wall, item.category), []).append(item)
    for (wall, category), items in by_wall.items():
        places = _places(items, back)
        yield Prediction(
            "object", mine, category, seen.get(wall or ""), wall, room.id, places[0], places
        )


def _walls(
    solution: Answer,
    online: SceneGraph,
    prior: SceneGraph,
    back: Placement,
    mine: str,
    room: Room,
) -> Iterator[Prediction]:
    """The walls of a room that was seen without them, by their distance from its centre."""
    seen = online.room_by_id[mine]
    matched = {solution.planes[p] for p in seen.planes if p in solution.planes}
    center = np.array(seen.center[:2])
    for name in room.planes:
        plane = prior.plane_by_id[name]
        flat = math.hypot(*plane.normal[:2])
        if name in matched or flat < 0.5:
            continue
        normal, offset = _line(plane.normal, plane.offset, room.center[2], back)
        distance = float(normal @ center) + offset
        place = center - distance * normal
        angle = math.atan2(normal[1], normal[0])
        where = (float(place[0]), float(place[1]))
        yield Prediction("wall", mine, "wall", None, name, room.id, where, ((angle, distance),))


def _rooms(
    solution: Answer, prior: SceneGraph, back: Placement, mine: str, room: Room
) -> Iterator[Prediction]:
    """The rooms behind the doors of a room; where no door joins two rooms, those behind walls."""
    taken = set(solution.rooms.values())
    for entrance, plane, other in entrances(prior, room):
        if other.id in taken:
            continue
        place = _places_of(_through(prior, entrance, plane, other)[None], back)[0]
        outline = tuple(sorted(_outline(prior, other, back, place)))
        counts: dict[str, int] = {}
        for item in prior.objects_by_room.get(other.id, ()):
            if item.category in prior.modelled:
                counts[item.category] = counts.get(item.category, 0) + 1
        behind = next((s for s, a in solution.planes.items() if a == plane), None)
        contents = tuple(sorted(counts.items()))
        yield Prediction("room", mine, "room", behind, plane, room.id, place, outline, contents)


def _through(
    prior: SceneGraph, entrance: tuple[float, float], plane: str | None, other: Room
) -> Floats:
    """A place just behind an entrance."""
    at = np.array(entrance)
    if plane is None:
        way = np.array(other.center[:2]) - at
        return np.asarray(at + STEP * way / max(STEP, float(np.linalg.norm(way))), dtype=float)
    normal = np.array(prior.plane_by_id[plane].normal[:2])
    return np.asarray(at - STEP * normal, dtype=float)


def depth(outline: Outline, place: tuple[float, float], point: tuple[float, float]) -> float:
    """How far a point is inside an outline (direction and distance from ``place`` of each wall)."""
    x, y = point[0] - place[0], point[1] - place[1]
    return min((d + math.cos(a) * x + math.sin(a) * y for a, d in outline), default=-math.inf)


def seen_from(item: Prediction, point: tuple[float, float]) -> Prediction:
    """A room with its walls measured from another place."""
    x, y = point[0] - item.place[0], point[1] - item.place[1]
    outline = tuple((a, d + math.cos(a) * x + math.sin(a) * y) for a, d in item.outcome)
    return item._replace(place=point, outcome=outline)


def entrances(prior: SceneGraph, room: Room) -> list[Entrance]:
    """Where one gets from a room into others: the place, the plane of the room, the other room."""
    found: list[Entrance] = []
    for item in prior.objects_by_room.get(room.id, ()):
        if item.category == "door":
            wall = next((p for p in item.planes if p in room.planes), None)
            others = [prior.room_by_id[r] for r in item.rooms if r != room.id]
            found += [((item.center[0], item.center[1]), wall, other) for other in others]
    if found or any(o.category == "door" and len(o.rooms) > 1 for o in prior.objects):
        return found
    return _neighbours(prior, room)


def _neighbours(prior: SceneGraph, room: Room) -> list[Entrance]:
    """The rooms on the other side of a room's walls, for a plan whose doors join none."""
    found: list[Entrance] = []
    for name in room.planes:
        n, d = np.array(prior.plane_by_id[name].normal), prior.plane_by_id[name].offset
        for other in prior.rooms:
            center = np.array(other.center)
            if other.storey != room.storey or other.id == room.id or n @ center + d >= 0:
                continue
            backs = (
                prior.plane_by_id[p]
                for p in other.planes
                if np.dot(prior.plane_by_id[p].normal, n) < -math.cos(FACING)
            )
            if not any(abs(q.offset + d) <= GAP for q in backs):
                continue
            foot = center - (n @ center + d) * n
            inside = all(
                np.dot(prior.plane_by_id[p].normal, foot) + prior.plane_by_id[p].offset >= -BESIDE
                for p in room.planes
            )
            if inside:
                found.append(((float(foot[0]), float(foot[1])), name, other))
    return found


def _outline(
    prior: SceneGraph, room: Room, back: Placement, place: tuple[float, float]
) -> Iterator[tuple[float, float]]:
    """The walls of a room by direction in the map and distance from a place in it."""
    for name in room.planes:
        plane = prior.plane_by_id[name]
        if math.hypot(*plane.normal[:2]) < 0.5:
            continue
        normal, offset = _line(plane.normal, plane.offset, room.center[2], back)
        distance = float(normal @ np.array(place)) + offset
        yield math.atan2(normal[1], normal[0]), distance


def _line(
    normal: tuple[float, float, float], offset: float, height: float, back: Placement
) -> tuple[Floats, float]:
    """A plane as a line in the map, cut at a height of the building: normal (2,) and offset."""
    flat = math.hypot(normal[0], normal[1])
    there = np.array(normal[:2]) / flat
    c, s = math.cos(back.yaw), math.sin(back.yaw)
    here = np.array([c * there[0] - s * there[1], s * there[0] + c * there[1]])
    return here, (offset + normal[2] * height) / flat - float(here @ (back.x, back.y))


def _places(items: list[Object], back: Placement) -> Outline:
    """Where objects are in the map, in an order that does not depend on their names."""
    return tuple(sorted(_places_of(np.array([o.center[:2] for o in items]), back)))


def _places_of(points: Floats, back: Placement) -> list[tuple[float, float]]:
    c, s = math.cos(back.yaw), math.sin(back.yaw)
    moved = points @ np.array([[c, s], [-s, c]]) + (back.x, back.y)
    return [(float(x), float(y)) for x, y in moved]
