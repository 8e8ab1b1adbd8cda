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
    faces = _Faces(site, level, graph)
    for start, end in edges(level.walls):
        site.mesh.upright(start, end, level.elevation, top, faces.number(start, end))
    for o in level.openings:
        around = [(a, b, faces.number(a, b)) for a, b in edges(o.polygon)]
        for low, high in ((level.elevation, o.low), (o.high, top)):
            if high > low:
                for start, end, number in around:
                    site.mesh.upright(start, end, low, high, number)
        reveal = faces.reveal(o.rooms[0])
        if o.low > level.elevation:
            site.mesh.level(o.polygon, o.low, reveal, up=True)
        site.mesh.level(o.polygon, o.high, reveal, up=False)
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


class _Faces:
    """Part numbers of wall faces: one for each plane of each room, painted by room."""

    def __init__(self, site: Site, level: Level, graph: SceneGraph) -> None:
        self._site, self._level, self._graph = site, level, graph
        self._paint = {room: site.looks.draw("wall") for room in level.rooms}
        self._facade = site.part("wall", "facade")
        self._reveal = {
            r: site.part("wall", "reveal", room=r, look=self._paint[r]) for r in level.rooms
        }
        self._faces: dict[tuple[str, str | None], int] = {}

    def reveal(self, room: str) -> int:
        """The inner sides of openings, painted like ``room``."""
        return self._reveal[room]

    def number(self, start: Array, end: Array) -> int:
        """The part of the face over an edge of the plan view, solid on its left."""
        room, plane = _face(self._level, self._graph, start, end)
        if room is None:
            near = _nearest_room(self._level, (start + end) / 2)
            return self._facade if near is None else self._reveal[near]
        key = (room, plane)
        if key not in self._faces:
            look = self._paint[room]
            self._faces[key] = self._site.part("wall", "wall", None, plane, room, look)
        return self._faces[key]


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
