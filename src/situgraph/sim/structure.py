"""The carcass of a storey: walls face by face, lintels and sills, floors and ceilings."""

from __future__ import annotations

import numpy as np

from situgraph.geometry.poses import Array
from situgraph.scenegraph.graph import SceneGraph
from situgraph.sim.flights import Flight
from situgraph.sim.levels import Level
from situgraph.sim.mesh import edges
from situgraph.sim.site import Site


def build_structure(
    site: Site, level: Level, graph: SceneGraph, ways: list[Flight], index: int
) -> None:
    """Add the carcass of ``level`` (number ``index``) with holes where ``ways`` pass its slabs."""
    import shapely

    top = level.elevation + level.height
    paint = {room: site.looks.draw("wall") for room in level.rooms}
    facade = site.part("wall", "facade")
    reveal = {r: site.part("wall", "reveal", room=r, look=paint[r]) for r in level.rooms}
    numbers: dict[tuple[str, str | None], int] = {}
    for start, end in edges(level.walls):
        room, plane = _face(level, graph, start, end)
        if room is None:
            near = _nearest_room(level, (start + end) / 2)
            number = facade if near is None else reveal[near]
        else:
            key = (room, plane)
            if key not in numbers:
                numbers[key] = site.part("wall", "wall", None, plane, room, paint[room])
            number = numbers[key]
        site.mesh.upright(start, end, level.elevation, top, number)
    for o in level.openings:
        number = reveal[o.rooms[0]]
        if o.low > level.elevation:
            site.mesh.prism(o.polygon, level.elevation, o.low, number)
        site.mesh.prism(o.polygon, o.high, top, number)
    up_holes = shapely.union_all([f.hole for f in ways if f.lower == index])
    down_holes = shapely.union_all([f.hole for f in ways if f.upper == index])
    floor = site.part("floor", "floor")
    ground = level.solid.union(shapely.union_all(list(level.rooms.values())))
    rooms = shapely.union_all(list(level.rooms.values()))
    site.mesh.level(
        ground.difference(rooms).difference(down_holes), level.elevation, floor, up=True
    )
    site.mesh.level(level.passages, level.elevation + min(level.heights.values()), floor, up=False)
    for room, shape in level.rooms.items():
        here = site.part("floor", "floor", room=room)
        site.mesh.level(shape.difference(down_holes), level.elevation, here, up=True)
        above = site.part("ceiling", "ceiling", room=room)
        height = level.elevation + level.heights[room]
        site.mesh.level(shape.difference(up_holes), height, above, up=False)


def _face(
    level: Level, graph: SceneGraph, start: Array, end: Array
) -> tuple[str | None, str | None]:
    """The room in front of a wall's edge and the plane of that room that the edge lies on."""
    edge = end - start
    length = float(np.linalg.norm(edge))
    if length < 1e-9:
        return None, None
    out = np.array([edge[1], -edge[0]]) / length
    middle = (start + end) / 2
    room = level.room_at(*(middle + 0.005 * out))
    if room is None:
        return None, None
    for plane in (graph.plane_by_id[p] for p in graph.room_by_id[room].planes):
        normal = np.asarray(plane.normal[:2])
        if normal @ out > 0.98 and abs(normal @ middle + plane.offset) < 0.06:
            return room, plane.id
    return room, None


def _nearest_room(level: Level, point: Array) -> str | None:
    """The room of an opening's or passage's side; None for the building's outside."""
    import shapely

    at = shapely.Point(point)
    for o in level.openings:
        if shapely.distance(o.polygon, at) < 0.01:
            return o.rooms[0]
    if shapely.distance(level.passages, at) < 0.01:
        return min(level.rooms, key=lambda r: shapely.distance(level.rooms[r], at))
    return None
