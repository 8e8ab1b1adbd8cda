"""The building to drive in: triangles, what each one belongs to, lamps, and where one can walk."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from situgraph.geometry.poses import Array
from situgraph.scenegraph.graph import Object, SceneGraph
from situgraph.sim import clutter, doors, flights, furniture
from situgraph.sim.config import WorldConfig
from situgraph.sim.doors import Door
from situgraph.sim.flights import Flight
from situgraph.sim.levels import Level, levels_of
from situgraph.sim.looks import Color, Looks, Material
from situgraph.sim.mesh import Mesh
from situgraph.sim.site import Part, Site
from situgraph.sim.structure import build_structure
from situgraph.sim.textures import textures

_LAMPS = 4.0  # m between the lamps of a room
_SWING = 2.0  # m; what is farther from a door is out of its leaf's reach


@dataclass(frozen=True, eq=False)
class Lamp:
    """A light: ``position`` (3,) in the building frame, colour, the room it lights."""

    position: Array
    color: Color
    room: str


@dataclass(frozen=True, eq=False)
class World:
    """Everything sensors and robot need to know about the building as built.

    ``mesh`` is relative to ``origin`` (3,), so that single precision suffices; ``parts[i]``
    has ``id`` i and looks like ``materials[i]``. Of ``levels[i]``, ``bodies[i]`` are the plan views
    (shapely) of objects that stand in the way, by id (of a door: its leaves), and ``obstacles[i]``
    whatever else does: stairs and holes. ``doors`` says how each door was built.
    """

    graph: SceneGraph
    origin: Array
    mesh: Mesh
    parts: tuple[Part, ...]
    materials: tuple[Material, ...]
    textures: NDArray[np.uint8]
    lamps: tuple[Lamp, ...]
    levels: tuple[Level, ...]
    doors: tuple[Door, ...]
    flights: tuple[Flight, ...]
    bodies: tuple[Mapping[str, Any], ...]
    obstacles: tuple[Any, ...]
    notes: tuple[str, ...]

    @property
    def panes(self) -> NDArray[np.bool_]:
        """Which triangles (m,) are window glass."""
        return np.array([m.pane for m in self.materials])[self.mesh.part]


def build_world(graph: SceneGraph, config: WorldConfig, seed: int) -> World:
    """The world of the building as built; the same arguments give the same world.

    Raises:
        InputError: the graph has no footprints to build from.
    """
    levels, notes = levels_of(graph, config)
    ways, more = flights.flights_of(graph, levels)
    site = Site(Looks(seed if config.texture_seed is None else config.texture_seed))
    rng = np.random.default_rng([seed, 7100])
    hung: list[Door] = []
    standing, obstacles = [], []
    for index, level in enumerate(levels):
        named = _furnish(site, graph, level)
        bodies = list(named.values())
        hung += (built := _openings(site, level, bodies, config, rng))
        build_structure(site, level, graph, [f for f in ways if index in (f.lower, f.upper)], index)
        for picture in clutter.pictures(level, config.pictures, bodies, rng):
            part = site.part("picture", "picture", room=picture.room)
            site.mesh.box(picture.center, picture.half, picture.yaw, part)
        standing.append({**named, **_leaves(built)})
        obstacles.append(_obstacles(ways, index))
    for flight in ways:
        part = site.part(flight.object.category, "flight", flight.object.id)
        flights.build_flight(site.mesh, flight, levels, part)
    _ground(site, levels)
    mesh = site.mesh.mesh()
    origin = np.rint(mesh.corners.reshape(-1, 3).mean(axis=0))
    lamps = tuple(lamp for level in levels for lamp in _lamps(site.looks, level))
    texture = textures(seed if config.texture_seed is None else config.texture_seed)
    return World(
        graph,
        origin,
        Mesh(mesh.corners - origin, mesh.uv, mesh.part),
        tuple(site.parts),
        tuple(site.materials),
        texture,
        lamps,
        levels,
        tuple(hung),
        ways,
        tuple(standing),
        tuple(obstacles),
        (*notes, *more),
    )


def _furnish(site: Site, graph: SceneGraph, level: Level) -> dict[str, Any]:
    """Build the objects that stand in the level's rooms; plan views of those in the way, by id."""
    import shapely

    bodies = {}
    for item in graph.objects:
        rooms = [r for r in item.rooms if r in level.rooms]
        if not rooms or item.category in {"door", "window"} or _is_flight(item, graph):
            continue
        ceiling = level.elevation + min(level.heights[r] for r in rooms)
        solid = furniture.Solid(item, level.elevation, ceiling)
        part = site.part(item.category, item.category, item.id, room=rooms[0])
        furniture.build(site.mesh, item.category, solid, part)
        if solid.low < level.elevation + clutter.WALKED_UNDER:
            bodies[item.id] = shapely.Polygon(solid.footprint())
    return bodies


def _is_flight(item: Object, graph: SceneGraph) -> bool:
    storeys = {graph.room_by_id[r].storey for r in item.rooms}
    return item.category in flights.CATEGORIES and len(storeys) > 1


def _openings(
    site: Site, level: Level, bodies: list[Any], config: WorldConfig, rng: np.random.Generator
) -> list[Door]:
    import shapely

    hung: list[Door] = []
    for opening in level.openings:
        item = opening.object
        room = opening.rooms[0]
        if item.category == "window":
            names = {"frame": "window frame", "glass": "glass"}
            parts = {k: site.part("window", v, item.id, room=room) for k, v in names.items()}
            doors.build_window(site.mesh, opening, parts)
            continue
        others = [
            *bodies,
            *(s.polygon() for d in hung for s in d.swings),
            *(o.polygon.buffer(0.1) for o in level.openings if o is not opening),
        ]
        near = [o for o in others if shapely.distance(o, opening.polygon) < _SWING]
        blocked = shapely.union_all(near)
        door = doors.hang(opening, level, blocked, config, rng)
        names = {"frame": "door frame", "leaf": "leaf", "handle": "handle"}
        parts = {k: site.part("door", v, item.id, room=room) for k, v in names.items()}
        doors.build_door(site.mesh, door, parts)
        hung.append(door)
    return hung


def _leaves(doors: Sequence[Door]) -> dict[str, Any]:
    """The plan views of leaves by their door's id."""
    import shapely

    return {
        d.opening.object.id: shapely.union_all([s.polygon() for s in d.swings])
        for d in doors
        if d.swings
    }


def _obstacles(ways: tuple[Flight, ...], index: int) -> Any:
    import shapely

    stairs = [f.low_part for f in ways if f.lower == index]
    holes = [f.hole for f in ways if f.upper == index]
    return shapely.union_all([*stairs, *holes])


def _ground(site: Site, levels: tuple[Level, ...]) -> None:
    import shapely

    low = min(level.elevation for level in levels)
    around = shapely.union_all([level.solid for level in levels]).envelope.buffer(60.0)
    ground = site.part("ground", "ground")
    site.mesh.level(around.envelope, low - 0.15, ground, up=True)


def _lamps(looks: Looks, level: Level) -> list[Lamp]:
    """A grid of lamps under each room's ceiling."""
    import shapely

    found = []
    for room, shape in level.rooms.items():
        color = looks.light()
        x0, y0, x1, y1 = shape.bounds
        nx, ny = (max(round((b - a) / _LAMPS), 1) for a, b in ((x0, x1), (y0, y1)))
        xs = x0 + (np.arange(nx) + 0.5) * (x1 - x0) / nx
        ys = y0 + (np.arange(ny) + 0.5) * (y1 - y0) / ny
        points = [p for p in ((x, y) for x in xs for y in ys) if shape.covers(shapely.Point(p))]
        points = points or [tuple(shape.representative_point().coords[0])]
        height = level.elevation + level.heights[room] - 0.25
        found += [Lamp(np.array([*p, height]), color, room) for p in points]
    return found


def room_numbers(world: World) -> Mapping[str, int]:
    """A number from 1 for every room that has lamps; 0 stands for no room."""
    names = dict.fromkeys(lamp.room for lamp in world.lamps)
    return {name: i + 1 for i, name in enumerate(names)}
