"""The plan view of a storey as built: rooms, the solid between them, openings through it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from situgraph.errors import InputError
from situgraph.scenegraph.graph import Object, Room, SceneGraph, Storey
from situgraph.sim.config import WorldConfig
from situgraph.sim.mesh import polygons
from situgraph.sim.openings import REACH, Opening, cut

Polygon = Any  # a shapely geometry of areal type

_THIN = 0.04  # m; half the thickness of a wall between rooms drawn without a gap


@dataclass(frozen=True, eq=False)
class Level:
    """A storey's plan view. ``heights`` are the ceilings above ``elevation``, by room.

    ``solid`` is wall, openings not yet cut; ``passages`` is where rooms join without a wall.
    """

    storey: str
    elevation: float
    rooms: Mapping[str, Polygon]
    heights: Mapping[str, float]
    solid: Polygon
    passages: Polygon
    openings: tuple[Opening, ...]

    @property
    def height(self) -> float:
        """The highest ceiling above the floor."""
        return max(self.heights.values())

    @property
    def walls(self) -> Polygon:
        """The solid that stands from floor to ceiling: openings and passages cut out."""
        import shapely

        return self.solid.difference(
            shapely.union_all([o.polygon for o in self.openings] + [self.passages])
        )

    def room_at(self, x: float, y: float) -> str | None:
        """The room over a point of the plan view, if any."""
        import shapely

        point = shapely.Point(x, y)
        return next((k for k, p in self.rooms.items() if p.covers(point)), None)


def levels_of(plan: SceneGraph, config: WorldConfig) -> tuple[tuple[Level, ...], tuple[str, ...]]:
    """The storeys of ``plan`` from low to high, and sentences about what could not be built.

    Raises:
        InputError: no room has a footprint, or a footprint has no area.
    """
    if not any(r.footprint for r in plan.rooms):
        raise InputError(
            plan.name or "plan",
            "no room has a footprint, so there is no building to drive in",
            "give a layout or an IFC model",
        )
    odd = [f"room {r.id} has no footprint and is not built" for r in plan.rooms if not r.footprint]
    storeys = plan.storeys or (Storey(id=""),)
    found = []
    for storey in sorted(storeys, key=lambda s: s.elevation):
        rooms = [r for r in plan.rooms if r.footprint and (r.storey or storeys[0].id) == storey.id]
        if rooms:
            found.append(_level(plan, storey, rooms, config, odd))
    return tuple(found), tuple(odd)


def _level(
    plan: SceneGraph, storey: Storey, rooms: list[Room], config: WorldConfig, odd: list[str]
) -> Level:
    import shapely

    shapes = {r.id: _shape(r, plan) for r in rooms}
    heights = {r.id: _height(r, storey, config) for r in rooms}
    union = shapely.union_all(list(shapes.values()))
    solid = union.buffer(config.outer_wall, join_style="mitre").difference(union)
    thin = _thin_walls(plan, rooms, shapes)
    solid = solid.union(thin)
    if not thin.is_empty:
        shapes = {k: p.difference(thin) for k, p in shapes.items()}
    passages = _passages(plan, rooms, shapes, solid)
    openings = []
    for item in plan.objects:
        if item.category in {"door", "window"} and _storey_of(item, plan, shapes):
            opening = cut(item, plan, storey, heights, shapes, solid)
            if opening is None:
                odd.append(f"{item.category} {item.id} stands in no wall and is not built")
            else:
                openings.append(opening)
    return Level(storey.id, storey.elevation, shapes, heights, solid, passages, tuple(openings))


def _shape(room: Room, plan: SceneGraph) -> Polygon:
    import shapely

    polygon = shapely.Polygon(room.footprint)
    whole = polygon if polygon.is_valid else polygon.buffer(0)
    if whole.area < 0.01:
        raise InputError(
            plan.name or "plan", f"room {room.id} has a footprint of no area", "correct it"
        )
    return shapely.set_precision(whole, 1e-6)


def _height(room: Room, storey: Storey, config: WorldConfig) -> float:
    """The ceiling above the floor: twice the centre's height where that is plausible."""
    usual = storey.height or config.storey_height
    by_center = 2.0 * (room.center[2] - storey.elevation)
    return by_center if 2.0 <= by_center <= 12.0 else usual


def _thin_walls(plan: SceneGraph, rooms: list[Room], shapes: Mapping[str, Polygon]) -> Polygon:
    """Walls where the plan draws two rooms without a gap between them."""
    import shapely

    lines = []
    for i, a in enumerate(rooms):
        for b in rooms[i + 1 :]:
            if shapes[a.id].distance(shapes[b.id]) < 1e-3:
                shared = shapes[a.id].buffer(2e-3).boundary.intersection(shapes[b.id].buffer(2e-3))
                virtual = shapely.union_all(_virtual(plan, a) + _virtual(plan, b)).buffer(0.02)
                lines.append(shared.difference(virtual))
    long = [
        line
        for line in shapely.get_parts(shapely.union_all(lines))
        if line.geom_type == "LineString" and line.length > 0.1
    ]
    return shapely.union_all(long).buffer(_THIN, cap_style="square")


def _virtual(plan: SceneGraph, room: Room) -> list[Polygon]:
    import shapely

    return [
        shapely.LineString(plan.plane_by_id[p].extent)
        for p in room.planes
        if plan.plane_by_id[p].virtual and plan.plane_by_id[p].extent
    ]


def _passages(
    plan: SceneGraph, rooms: list[Room], shapes: Mapping[str, Polygon], solid: Polygon
) -> Polygon:
    """Where a face is virtual and another room lies behind: no wall is built."""
    import shapely

    found = []
    for room in rooms:
        others = shapely.union_all([p for k, p in shapes.items() if k != room.id])
        for plane in (plan.plane_by_id[p] for p in room.planes):
            if not (plane.virtual and plane.extent):
                continue
            a, b = np.asarray(plane.extent, dtype=float)
            back = -REACH * np.asarray(plane.normal[:2]) / np.linalg.norm(plane.normal[:2])
            strip = shapely.Polygon([a, b, b + back, a + back]).intersection(solid)
            found += [
                piece
                for piece in polygons(strip)
                if shapely.distance(piece, others) < 0.01
                and shapely.distance(piece, shapes[room.id]) < 0.01
            ]
    return shapely.union_all(found)


def _storey_of(item: Object, plan: SceneGraph, shapes: Mapping[str, Polygon]) -> bool:
    return any(r in shapes for r in item.rooms)
