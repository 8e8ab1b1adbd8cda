"""The passages of an indoor OSM map: doors with the rooms they join and the faces they are in."""

from __future__ import annotations

import math
from collections.abc import Sequence

import msgspec
import numpy as np

from situgraph.plan.config import PlanConfig
from situgraph.plan.hosting import RoomFaces, hosts
from situgraph.plan.openings import Box
from situgraph.plan.osm_areas import Areas, level_of
from situgraph.plan.osm_file import OsmMap, Way

PARALLEL = math.cos(math.radians(15.0))  # hand-drawn passages follow their wall no better


class Passage(msgspec.Struct, frozen=True):
    """A door: its way, box, rooms and faces by number, and the names that no area has."""

    way: Way
    box: Box
    rooms: tuple[int, ...]
    faces: tuple[tuple[int, int], ...]
    unknown: tuple[str, ...] = ()


def find_passages(
    source: OsmMap, areas: Areas, faces: RoomFaces, config: PlanConfig
) -> list[Passage]:
    """Every passage of the map with the areas it names, by name and level or by way id.

    Where a name fits no area, the room on that side of the passage is found by geometry. A face
    hosts the passage when it runs along at least half of it within ``passage_gap``.
    """
    names = _names(areas)
    found = []
    for way in source.ways:
        if way.tags.get("osmAG:type") == "passage" and len(way.points) > 1:
            found.append(_passage(way, names, areas, faces, config))
    return found


def _names(areas: Areas) -> dict[tuple[str, float | None], list[int]]:
    """Rooms by name and level, by name alone, and by way id."""
    names: dict[tuple[str, float | None], list[int]] = {}
    for number, (way, level) in enumerate(zip(areas.ways, areas.levels, strict=True)):
        name = way.tags.get("name", way.id)
        for key in ((name, level), (name, None), (way.id, None)):
            names.setdefault(key, []).append(number)
    return names


def _passage(
    way: Way,
    names: dict[tuple[str, float | None], list[int]],
    areas: Areas,
    faces: RoomFaces,
    config: PlanConfig,
) -> Passage:
    level = level_of(way)
    box = _box(way, level, areas, config)
    rooms: list[int] = []
    unknown: list[str] = []
    for tag in ("osmAG:from", "osmAG:to"):
        name = way.tags.get(tag, "")
        known = names.get((name, level)) or names.get((name, None)) or []
        if known:
            rooms.append(min(known, key=lambda n: (_distance(areas, n, box), n)))
        else:
            unknown.append(name)
    rooms = list(dict.fromkeys(rooms))
    on = {room: face for room in rooms if (face := _face(areas, room, box, config)) is not None}
    for host in hosts(box, faces, config.door_overlap, config) if unknown else []:
        if len(on) < 2 and host.room not in rooms and _opposite(areas, on, host.room, host.face):
            rooms.append(host.room)
            on[host.room] = host.face
    return Passage(way, box, tuple(rooms), tuple(on.items()), tuple(unknown))


def _box(way: Way, level: float | None, areas: Areas, config: PlanConfig) -> Box:
    """From the first to the last point of the passage, as high as a usual door."""
    start, end = np.array(way.points[0]), np.array(way.points[-1])
    width = float(np.linalg.norm(end - start))
    along = (end - start) / width if width > 1e-6 else np.array([1.0, 0.0])
    storey = areas.storeys.get(level or 0.0)
    middle, z = 0.5 * (start + end), storey.elevation if storey is not None else 0.0
    return Box(
        (float(middle[0]), float(middle[1]), z + 0.5 * config.door_height),
        (float(-along[1]), float(along[0])),
        (0.5 * width, 0.0, 0.5 * config.door_height),
    )


def _distance(areas: Areas, room: int, box: Box) -> float:
    from shapely import Point

    return float(areas.shapes[room].outline.distance(Point(box.center[:2])))


def _face(areas: Areas, room: int, box: Box, config: PlanConfig) -> int | None:
    """The face of a room that runs along at least half of the passage, the nearest of them."""
    n, t, middle = np.array(box.across), np.array(box.along), np.array(box.center[:2])
    best: tuple[float, int] | None = None
    for number, face in enumerate(areas.shapes[room].faces):
        if abs(np.dot(face.normal, n)) < PARALLEL:
            continue
        low, high = sorted(
            float((np.array(face.point(u)) - middle) @ t) for u in (face.low, face.high)
        )
        shared = min(high, box.half[0]) - max(low, -box.half[0])
        distance = abs(float(np.dot(face.normal, middle)) + face.offset)
        if distance > config.passage_gap or shared < config.door_overlap * 2.0 * box.half[0]:
            continue
        if best is None or (round(distance, 3), number) < best:
            best = (round(distance, 3), number)
    return None if best is None else best[1]


def _opposite(areas: Areas, on: dict[int, int], room: int, face: int) -> bool:
    """Whether a face looks the other way than all faces that carry the passage already."""
    normal = np.array(areas.shapes[room].faces[face].normal)
    taken: Sequence[tuple[float, float]] = [areas.shapes[r].faces[f].normal for r, f in on.items()]
    return all(float(np.dot(normal, other)) < 0.0 for other in taken)
