"""Which planned faces and rooms are those seen, once it is known where the map lies."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from situgraph.coupling.config import CouplingConfig
from situgraph.coupling.walls import stretch
from situgraph.geometry.poses import Array, Placement
from situgraph.scenegraph.graph import Plane, Room, SceneGraph, Vec2


def associate_planes(
    online: SceneGraph,
    prior: SceneGraph,
    placement: Placement,
    storeys: Mapping[str, str],
    matched: Mapping[str, str],
    config: CouplingConfig,
) -> dict[str, str]:
    """Online planes and the planned faces they are: those matched, and the others by their place.

    A plane of the map may be several faces of the plan in one line, and the other way round; each
    online plane gets the one that is nearest, of the same direction, with a common stretch.

    Args:
        online: in the map frame.
        prior: the plan.
        placement: map to building.
        storeys: online storey -> planned storey; a plane of an unknown one is left alone.
        matched: pairs of the match; they stay.
        config: how near is near.
    """
    pairs = {k: v for k, v in matched.items() if k in online.plane_by_id}
    floors = _floors(prior)
    own = _floors(online)
    faces = [(p, _line(p)) for p in prior.planes]
    by_storey: dict[str | None, list[tuple[Plane, tuple[Array, float]]]] = {}
    for face in faces:
        for storey in floors.get(face[0].id, {None}):
            by_storey.setdefault(storey, []).append(face)
    for plane in online.planes:
        if plane.id in pairs:
            continue
        levels = {storeys.get(s) if s else None for s in own.get(plane.id, set())}
        if not levels:
            levels = {next(iter(storeys.values()))} if len(set(storeys.values())) == 1 else set()
        candidates = [f for level in levels for f in by_storey.get(level, [])]
        chosen = _nearest(plane, candidates, placement, config)
        if chosen is not None:
            pairs[plane.id] = chosen
    return pairs


def associate_rooms(
    online: SceneGraph,
    prior: SceneGraph,
    placement: Placement,
    storeys: Mapping[str, str],
    matched: Mapping[str, str],
    config: CouplingConfig,
) -> dict[str, str]:
    """Online rooms and the planned rooms they lie in: those matched, and the others by area."""
    import shapely

    pairs = {k: v for k, v in matched.items() if k in online.room_by_id}
    shapes = [(r, shapely.Polygon(r.footprint)) for r in prior.rooms if r.footprint]
    for room in online.rooms:
        if room.id in pairs:
            continue
        level = storeys.get(room.storey) if room.storey else None
        there = [(r, s) for r, s in shapes if level is None or r.storey == level]
        found = _covering(room, there, placement, config.room_overlap)
        if found is not None:
            pairs[room.id] = found
    return pairs


def _covering(
    room: Room, shapes: list[tuple[Room, object]], placement: Placement, share: float
) -> str | None:
    import shapely

    if not room.footprint:
        centre = shapely.Point(placement.points(room.center[:2]))
        return next((r.id for r, s in shapes if shapely.contains(s, centre)), None)
    outline = shapely.Polygon(placement.points(room.footprint)).buffer(0)
    common = [(float(outline.intersection(s).area), r.id) for r, s in shapes]
    best = max(common, default=(0.0, ""))
    return best[1] if best[0] >= share * outline.area > 0.0 else None


def _nearest(
    plane: Plane,
    faces: list[tuple[Plane, tuple[Array, float]]],
    placement: Placement,
    config: CouplingConfig,
) -> str | None:
    n, d = _line(plane)
    normal = placement.vectors(n)
    offset = d - float(normal @ np.array([placement.x, placement.y]))
    along = np.array([-normal[1], normal[0]])
    seen = stretch(plane, along, placement)
    best: tuple[float, str] | None = None
    for face, (m, _) in faces:
        if float(m @ normal) < math.cos(config.same_angle):
            continue
        planned = stretch(face, along)
        if seen is None or planned is None:
            continue
        common = min(seen[1], planned[1]) - max(seen[0], planned[0])
        if common < min(config.least_overlap, 0.5 * (planned[1] - planned[0])):
            continue
        away = float(np.mean(np.abs(_ends(face) @ normal + offset)))
        if away <= config.same_offset and (best is None or (away, face.id) < best):
            best = (away, face.id)
    return None if best is None else best[1]


def _ends(face: Plane) -> Array:
    ends: tuple[Vec2, Vec2] = face.extent or ((0.0, 0.0), (0.0, 0.0))
    return np.asarray(ends, dtype=float)


def _line(plane: Plane) -> tuple[Array, float]:
    """The face in the plan: unit normal (2,) and offset."""
    n = np.asarray(plane.normal[:2], dtype=float)
    length = float(np.linalg.norm(n)) or 1.0
    return n / length, plane.offset / length


def _floors(graph: SceneGraph) -> dict[str, set[str | None]]:
    """The storeys of the rooms each plane bounds."""
    found: dict[str, set[str | None]] = {}
    for room in graph.rooms:
        for plane in room.planes:
            found.setdefault(plane, set()).add(room.storey)
    return found
