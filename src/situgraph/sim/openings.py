"""Holes through walls for doors and windows, and how objects lie in the plan view."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from situgraph.geometry.poses import Array
from situgraph.scenegraph.graph import Object, SceneGraph, Storey
from situgraph.sim.mesh import edges, polygons

Polygon = Any  # a shapely geometry of areal type

REACH = 0.7  # m; an opening is cut this far to either side of its centre: walls are thinner
_NEAR = 0.35  # m; a piece of wall this near the opening's centre is the one it stands in
_STEP = 0.35  # m; a door that begins lower than this begins at the floor
_TRIM = 0.05  # m; left of a wall above an opening, at least


@dataclass(frozen=True, eq=False)
class Opening:
    """A hole through a wall for one door or window.

    ``polygon`` is its plan view, ``along`` (2,) the wall's direction and ``across`` (2,) its
    normal, both unit; ``middle`` (2,) the hole's centre, ``width`` and ``depth`` its size in
    those directions; ``low`` and ``high`` its heights, all metres in the building frame.
    """

    object: Object
    polygon: Polygon
    middle: Array
    along: Array
    across: Array
    width: float
    depth: float
    low: float
    high: float
    rooms: tuple[str, ...]


def cut(
    item: Object,
    plan: SceneGraph,
    storey: Storey,
    heights: Mapping[str, float],
    shapes: Mapping[str, Polygon],
    solid: Polygon,
) -> Opening | None:
    """The hole that a door or window makes in ``solid``; None where it stands in no wall.

    ``heights`` are the ceilings above the storey's floor and ``shapes`` the plan views by room.
    """
    import shapely

    center = np.asarray(item.center)
    across = across_of(item, plan)
    along = np.array([-across[1], across[0]])
    width = 2.0 * _reach(item, np.array([*along, 0.0]), 0.45)
    half = _reach(item, np.array([0.0, 0.0, 1.0]), 1.05 if item.category == "door" else 0.6)
    corners = [
        center[:2] + s * width / 2 * along + t * REACH * across
        for s, t in ((-1, -1), (1, -1), (1, 1), (-1, 1))
    ]
    point = shapely.Point(center[:2])
    pieces = [
        p
        for p in polygons(shapely.Polygon(corners).intersection(solid))
        if shapely.distance(p, point) < _NEAR
    ]
    rooms = tuple(r for r in item.rooms if r in shapes)
    ceiling = storey.elevation + min(heights[r] for r in rooms)
    low, high = max(center[2] - half, storey.elevation), min(center[2] + half, ceiling - _TRIM)
    if item.category == "door" and low < storey.elevation + _STEP:
        low = storey.elevation
    if not pieces or high - low < 0.2:
        return None
    hole = shapely.union_all(pieces)
    # A hair more, so that the hole ends in the rooms and not at the wall's face.
    xy = np.array([p for edge in edges(hole) for p in edge]) - center[:2]
    t0, t1 = float((xy @ across).min()), float((xy @ across).max())
    s0, s1 = float((xy @ along).min()), float((xy @ along).max())
    middle = center[:2] + across * (t0 + t1) / 2 + along * (s0 + s1) / 2
    polygon = hole.buffer(1e-4, join_style="mitre")
    return Opening(
        item, polygon, middle, along, across, s1 - s0, t1 - t0, float(low), float(high), rooms
    )


def across_of(item: Object, plan: SceneGraph) -> Array:
    """The unit normal (2,) of the wall that ``item`` stands in, into its first room if known."""
    for plane in item.planes:
        normal = np.asarray(plan.plane_by_id[plane].normal[:2], dtype=float)
        if (length := float(np.linalg.norm(normal))) > 0.5:
            return normal / length
    if item.ellipsoid is None:
        return np.array([1.0, 0.0])
    turn, axes = _turn(item), item.ellipsoid.axes
    thin = min((i for i in range(3) if abs(turn[2, i]) < 0.5), key=lambda i: axes[i])
    normal = turn[:2, thin]
    return np.asarray(normal / np.linalg.norm(normal))


def _reach(item: Object, direction: Array, usual: float) -> float:
    """How far the object's ellipsoid reaches from its centre in a unit direction (3,), m."""
    if item.ellipsoid is None:
        return usual
    return float(np.linalg.norm(np.asarray(item.ellipsoid.axes) * (_turn(item).T @ direction)))


def _turn(item: Object) -> Array:
    from situgraph.geometry.poses import pose_to_matrix

    assert item.ellipsoid is not None
    return pose_to_matrix([0.0, 0.0, 0.0, *item.ellipsoid.rotation])[:3, :3]


def yaw_of(item: Object) -> float:
    """Yaw of an object's own x axis in the building, radians."""
    if item.ellipsoid is None:
        return 0.0
    turn = _turn(item)
    return math.atan2(turn[1, 0], turn[0, 0])
