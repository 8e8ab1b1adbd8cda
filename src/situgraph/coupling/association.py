"""Which planned faces and rooms are those seen, once it is known where the map lies."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np

from situgraph.coupling.config import CouplingConfig
from situgraph.coupling.deviation import along_of
from situgraph.coupling.panes import is_pane
from situgraph.coupling.walls import stretch
from situgraph.geometry.poses import Array, Placement
from situgraph.scenegraph.graph import Plane, Room, SceneGraph


class Option(NamedTuple):
    """An online plane may be a planned face; the least is the best.

    ``short``: it covers less than half of the face; ``loose``: it bounds no room. ``away`` (m) is
    how far from the face it is, ``offset`` (m) where: positive behind the face.
    """

    short: bool
    loose: bool
    away: float
    name: str
    face: str
    offset: float


def associate_planes(
    online: SceneGraph,
    prior: SceneGraph,
    placement: Placement,
    storeys: Mapping[str, str],
    matched: Mapping[str, str],
    config: CouplingConfig,
) -> tuple[tuple[str, str], ...]:
    """Pairs (online plane, planned face): those matched, and others by their place.

    A plane of the map may be several faces of the plan in one line, and one face may be seen as
    several planes. A face gets the nearest plane of its direction that covers half of it, else the
    nearest with a common stretch, one that bounds a room before others; further ones only in the
    surface of that one, wherever it stands: a window pane or a cupboard before the wall is not the
    wall. So what bounds no room and covers less than half of a face is the face in its surface
    only. The leaf of a shut door or a pane in the wall's depth (``panes.py``) is not the wall
    either, whatever the match says; and where a face is virtual there is none.

    Args:
        online: in the map frame.
        prior: the plan.
        placement: map to building.
        storeys: online storey -> planned storey; a plane of an unknown one is left alone.
        matched: pairs of the match; they stay, but for panes.
        config: how near is near.
    """
    floors, own = _floors(prior), _floors(online)
    by_storey: dict[str | None, list[Plane]] = {}
    for face in prior.planes:
        for storey in floors.get(face.id, {None}):
            by_storey.setdefault(storey, []).append(face)
    only = set(storeys.values())
    options: list[Option] = []
    for plane in online.planes:
        levels = {storeys.get(s) if s else None for s in own.get(plane.id, set())}
        faces = [f for level in levels or only for f in by_storey.get(level, [])]
        if levels or len(only) == 1:
            options += _options(plane, faces, plane.id in own, placement, config)
    pairs = {
        (k, v)
        for k, v in matched.items()
        if k in online.plane_by_id and _is_wall(k, v, online, prior, placement, config)
    }
    surface = {taken: 0.0 for _, taken in pairs}
    surface |= {o.face: o.offset for o in options if (o.name, o.face) in pairs}
    for o in sorted(options):
        if not _is_wall(o.name, o.face, online, prior, placement, config):
            continue
        if abs(o.offset - surface.setdefault(o.face, o.offset)) <= config.same_surface:
            pairs.add((o.name, o.face))
    return tuple(sorted(pairs))


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


def _options(
    plane: Plane, faces: list[Plane], bounds: bool, placement: Placement, config: CouplingConfig
) -> Iterator[Option]:
    """The planned faces that an online plane may be; ``bounds``: whether it bounds a room."""
    n, d = _line(plane)
    normal = placement.vectors(n)
    offset = d - float(normal @ np.array([placement.x, placement.y]))
    along = np.array([-normal[1], normal[0]])
    seen = stretch(plane, along, placement)
    for face in faces:
        planned = stretch(face, along)
        if seen is None or planned is None:
            continue
        if float(_line(face)[0] @ normal) < math.cos(config.same_angle):
            continue
        common = min(seen[1], planned[1]) - max(seen[0], planned[0])
        half = 0.5 * (planned[1] - planned[0])
        if common < min(config.least_overlap, half):
            continue
        beside = _common(face, along, seen) @ normal + offset
        away = float(np.mean(np.abs(beside)))
        short = common < half
        if away <= (config.same_surface if short and not bounds else config.same_offset):
            yield Option(short, not bounds, away, plane.id, face.id, float(np.mean(beside)))


def _is_wall(
    name: str,
    face: str,
    online: SceneGraph,
    prior: SceneGraph,
    placement: Placement,
    config: CouplingConfig,
) -> bool:
    """Whether a plane can be the wall of a planned face: there is one, and it is no pane in it."""
    plane, planned = online.plane_by_id[name], prior.plane_by_id[face]
    if planned.virtual or planned.extent is None:
        return not planned.virtual
    n, d = _line(plane)
    normal = placement.vectors(n)
    offset = d - float(normal @ np.array([placement.x, placement.y]))
    along = along_of(planned)
    span = stretch(plane, along, placement)
    if span is None:
        return True
    behind = float(np.mean(_common(planned, along, span) @ normal + offset))
    if behind <= config.told_offset:
        return True
    bounds = bool(online.rooms_by_plane.get(name))
    return not is_pane(span, behind, planned, prior, bounds)


def _common(face: Plane, along: Array, span: tuple[float, float]) -> Array:
    """The ends (2, 2) of the part of a face between two places along it.

    A plane askew to a face is as far from it as it is where it was seen.
    """
    ends = np.asarray(face.extent, dtype=float)
    a, b = ends @ along
    places = np.clip(span, min(a, b), max(a, b))
    out: Array = ends[0] + ((places - a) / (b - a))[:, None] * (ends[1] - ends[0])
    return out


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
