"""A world in which every room can be reached: what bars the only way is left out.

Furniture goes, and so do the leaves of doors that open into a narrow place.
"""

from __future__ import annotations

from collections.abc import Sequence

import msgspec
import numpy as np

from situgraph.geometry.poses import Array
from situgraph.scenegraph.graph import SceneGraph
from situgraph.sim.config import RobotConfig, SimConfig
from situgraph.sim.deviations import Deviation, deviate, without
from situgraph.sim.floors import Floor
from situgraph.sim.world import World, build_world

_ROUNDS = 4  # clearing one way can only bare another barrier so often


def build_drivable(
    plan: SceneGraph, config: SimConfig, rooms: Sequence[str], seed: int
) -> tuple[World, tuple[Deviation, ...]]:
    """The world as built and its deviations from ``plan``; see ``deviate``.

    Raises:
        InputError: the plan has no footprints to build from.
    """
    rng = np.random.default_rng([seed, 7200])
    graph, deviations = deviate(plan, config.world, rng)
    for _ in range(_ROUNDS):
        world = build_world(graph, config.world, seed)
        barriers = _barriers(world, config.robot, rooms)
        if not barriers:
            break
        for name in sorted(barriers):
            if graph.object_by_id[name].category == "door":
                graph = _unhinged(graph, name)
            else:
                graph = without(graph, name)
                deviations = (*deviations, Deviation("left-out", (name,)))
    return world, deviations


def _unhinged(graph: SceneGraph, name: str) -> SceneGraph:
    """The graph with the leaf of one door taken off."""
    objects = tuple(
        msgspec.structs.replace(o, attributes={**o.attributes, "state": "none"})
        if o.id == name
        else o
        for o in graph.objects
    )
    return graph.replace(objects=objects)


def _barriers(world: World, config: RobotConfig, rooms: Sequence[str]) -> set[str]:
    """Objects on the way to rooms which could be reached without them."""
    import shapely

    found: set[str] = set()
    for flight in world.flights:
        for bodies in (world.bodies[flight.lower], world.bodies[flight.upper]):
            found |= {k for k, b in bodies.items() if b.intersects(flight.approach)}
    for index, level in enumerate(world.levels):
        if rooms and not any(r in level.rooms for r in rooms):
            continue
        floor = Floor(world, index, config)
        bare = Floor(world, index, config, furnished=False)
        places = {r: _place(bare, shape) for r, shape in level.rooms.items()}
        reached = {
            r for r, shape in level.rooms.items() if (floor.main & floor.inside(shape)).any()
        }
        start = next(
            (places[r] for r in level.rooms if r in reached and places[r] is not None), None
        )
        for room in level.rooms:
            goal = places[room]
            if room in reached or goal is None or start is None:
                continue
            way = bare.way(start, goal)
            if way is not None:
                line = shapely.LineString(way).buffer(config.radius)
                found |= {k for k, b in world.bodies[index].items() if b.intersects(line)}
    return found


def _place(floor: Floor, shape: object) -> Array | None:
    """The place (2,) with the most space in a room; None where the robot fits nowhere."""
    inside = floor.inside(shape)
    clearance = np.where(inside & floor.walkable, floor.clearance, 0.0)
    row, column = np.unravel_index(int(np.argmax(clearance)), clearance.shape)
    return floor.point(int(row), int(column)) if clearance[row, column] > 0 else None
