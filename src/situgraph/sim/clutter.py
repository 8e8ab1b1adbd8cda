"""Things that no plan has: extra furniture along walls, pictures and boards on them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from situgraph.geometry.poses import Array
from situgraph.scenegraph.graph import Ellipsoid, Object, SceneGraph
from situgraph.sim.flights import CATEGORIES
from situgraph.sim.furniture import Solid
from situgraph.sim.levels import Level
from situgraph.sim.mesh import edges
from situgraph.sim.openings import across_of

# Category and half sizes (m): along the wall, off the wall, upwards.
_PIECES = (
    ("cabinet", 0.45, 0.22, 0.9),
    ("shelf", 0.4, 0.17, 1.0),
    ("box", 0.3, 0.25, 0.25),
    ("desk", 0.6, 0.35, 0.37),
    ("sofa", 0.8, 0.4, 0.4),
)
WALKED_UNDER = 1.2  # m; what hangs higher is in nobody's way
_LANE = 0.85  # m; straight through a door the way is clear this far ...
_BODY = 0.33  # m; ... and this wide to either side
_ELBOW = 0.9  # m; a new piece keeps this far from the middle of what is there
_CLEAR = 0.25  # m; a picture keeps this far from openings and corners


@dataclass(frozen=True, eq=False)
class Picture:
    """A flat thing on a wall: ``center`` (3,), half sizes (3,), ``yaw`` along the wall."""

    center: Array
    half: Array
    yaw: float
    room: str


def in_doorways(plan: SceneGraph) -> tuple[str, ...]:
    """The ids of objects that stand in the way of who walks straight through an inner door."""
    import shapely

    lanes = []
    for door in plan.objects:
        if door.category == "door" and len(door.rooms) > 1:
            reach = across_of(door, plan) * _LANE
            ends = [door.center[:2] - reach, door.center[:2] + reach]
            lanes.append(shapely.LineString(ends).buffer(_BODY, cap_style="flat"))
    tree = shapely.STRtree(lanes)
    found = []
    for item in plan.objects:
        if item.category in {"door", "window"} | CATEGORIES:
            continue
        solid = Solid(item, -np.inf, np.inf)
        body = shapely.Polygon(solid.footprint())
        if len(tree.query(body, predicate="intersects")) and not _overhead(item, solid, plan):
            found.append(item.id)
    return tuple(found)


def _overhead(item: Object, solid: Solid, plan: SceneGraph) -> bool:
    named = [plan.room_by_id[r].storey or "" for r in item.rooms]
    floors = [plan.storey_by_id[s].elevation for s in named if s in plan.storey_by_id]
    return solid.low > min(floors, default=0.0) + WALKED_UNDER


def extra_furniture(plan: SceneGraph, count: int, rng: np.random.Generator) -> list[Object]:
    """Up to ``count`` pieces along walls, clear of everything the plan has and of each other."""
    import shapely

    shapes = [(r, shapely.Polygon(r.footprint)) for r in plan.rooms if r.footprint]
    taken = [shapely.Point(o.center[:2]).buffer(_ELBOW) for o in plan.objects]
    floors = {s.id: s.elevation for s in plan.storeys}
    found: list[Object] = []
    for _ in range(30 * count):
        if len(found) == count:
            break
        room, shape = shapes[rng.integers(len(shapes))]
        category, hx, hy, hz = _PIECES[rng.integers(len(_PIECES))]
        at, along = _along_wall(shape, float(rng.random()), float(rng.uniform(0.15, 0.85)))
        inward = np.array([-along[1], along[0]])
        middle = at + inward * (hy + 0.02)
        body = _rectangle(middle, along, inward, hx, hy)
        if not shape.contains(body) or any(body.intersects(t) for t in taken):
            continue
        taken.append(body.buffer(0.3))
        half_turn = 0.5 * float(np.arctan2(along[1], along[0]))
        turn = (0.0, 0.0, float(np.sin(half_turn)), float(np.cos(half_turn)))
        height = floors.get(room.storey or "", 0.0) + hz
        center = (float(middle[0]), float(middle[1]), height)
        name = f"extra{len(found)}"
        found.append(Object(name, category, center, Ellipsoid((hx, hy, hz), turn), (room.id,)))
    return found


def pictures(
    level: Level, share: float, bodies: Sequence[Any], rng: np.random.Generator
) -> list[Picture]:
    """About ``share`` pictures a room, clear of openings and of ``bodies`` (shapely plan views)."""
    import shapely

    taken = shapely.union_all(
        [*bodies, *(o.polygon.buffer(_CLEAR) for o in level.openings), level.passages]
    )
    found = []
    for room, shape in level.rooms.items():
        for _ in range(int(rng.poisson(share))):
            at, along = _along_wall(shape, float(rng.random()), float(rng.uniform(0.1, 0.9)))
            inward = np.array([-along[1], along[0]])
            hx, hz = float(rng.uniform(0.15, 0.7)), float(rng.uniform(0.15, 0.5))
            height = level.elevation + float(rng.uniform(1.3, 1.7))
            middle = at + inward * 0.012
            near = _rectangle(middle, along, inward, hx + _CLEAR, 0.3)
            body = _rectangle(middle, along, inward, hx, 0.011)
            if near.intersects(taken) or not shape.buffer(0.01).contains(body):
                continue
            taken = taken.union(near)
            center = np.array([*middle, height])
            yaw = float(np.arctan2(along[1], along[0]))
            found.append(Picture(center, np.array([hx, 0.01, hz]), yaw, room))
    return found


def _along_wall(shape: Any, pick: float, part: float) -> tuple[Array, Array]:
    """A point (2,) on a footprint's edge, inside on the left, and the edge's direction (2,)."""
    sides = [(a, b) for a, b in edges(shape) if float(np.linalg.norm(b - a)) > 0.5]
    a, b = sides[int(pick * len(sides))] if sides else edges(shape)[0]
    return a + part * (b - a), (b - a) / max(float(np.linalg.norm(b - a)), 1e-9)


def _rectangle(middle: Array, along: Array, inward: Array, hx: float, hy: float) -> Any:
    import shapely

    signs = ((-1, -1), (1, -1), (1, 1), (-1, 1))
    return shapely.Polygon([middle + a * hx * along + b * hy * inward for a, b in signs])
