"""Openings in walls that part rooms: gaps of door width in a wall's line.

A wall is what lies on one line: every plane that faces the same way there and, a wall's thickness
behind, those that face the other way. A gap in it, or between its end and the wall it runs into,
is a doorway when it is no wider than a door. Where a further wall runs back from an end (an inner
corner of an L-shaped room, the mouth of an alcove), there is no door: the space beyond belongs to
the same room, unless an open leaf hangs at that end.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from situgraph.geometry.poses import Array
from situgraph.slam.config import RoomConfig
from situgraph.slam.planemap import Interval, MapPlane, united

PARALLEL = 0.99  # cosine: 8 deg
HINGE = 0.5  # m; from the seen end of a wall to the leaf beside it: it hides a jamb's width
CROSSED = -0.1  # m; no wall is as thin, but a leaf in the line of one beside it may lie before it


class Gap(NamedTuple):
    """An opening in the line of plane ``plane`` between its ``ends`` (2, 2) in the plan."""

    plane: int
    ends: Array


class _Stretches(NamedTuple):
    """All stretches of all planes: end points and the normal of their plane, each (n, 2)."""

    first: Array
    last: Array
    normal: Array
    tangent: Array
    offset: Array
    owner: Array


def doorways(
    planes: Sequence[MapPlane], config: RoomConfig, leaves: Sequence[MapPlane] = ()
) -> list[Gap]:
    """The doorways in the walls of one storey; ``leaves`` may be open door leaves, or walls."""
    if not planes:
        return []
    every, others = _stretches(planes), _stretches(leaves)
    found: list[Gap] = []
    for plane in planes:
        solid = _solid(plane, every, config)
        back = _turning_back(plane, every, config)
        hung = _hung(plane, others, config)
        for (_, a), (b, _) in pairwise(solid):
            own = any(abs(a - v) < 1e-6 or abs(b - u) < 1e-6 for u, v in plane.intervals)
            mouth = _near(back, a) and _near(back, b)
            door = not mouth or _near(hung, a, HINGE) or _near(hung, b, HINGE)
            if own and b - a <= config.door_width and door:
                found.append(_gap(plane, a, b))
        for end, sign in ((solid[0][0], -1.0), (solid[-1][1], 1.0)):
            hit = _next_wall(plane, end, sign, every, config)
            if hit is not None and not _near(back, end):
                found.append(_gap(plane, min(end, hit), max(end, hit)))
    return found


def without_leaves(planes: Sequence[MapPlane], config: RoomConfig) -> list[MapPlane]:
    """The planes without the open door leaves: stretches that are short and as thin as a board.

    The leaves of two doors may stand in one line and be one plane of the map, so each stretch is
    looked at by itself; but one of the two faces is short as a whole, and the leaf as thin as a
    board, else it could be the pier between two doors in a thin wall.
    """
    most = config.leaf_length + config.corner  # the jamb that it hangs on may be in its line
    short = [(p, a, b) for p in planes for a, b in p.intervals if b - a <= most]
    if not short:
        return list(planes)
    middle = np.array([p.point((a + b) / 2) for p, a, b in short])
    normal = np.array([p.normal for p, _, _ in short])
    length = np.array([b - a for _, a, b in short])
    whole = np.array([p.length <= config.leaf_length for p, _, _ in short])
    apart = middle[:, None] - middle[None]
    behind = np.einsum("ijk,ik->ij", apart, normal)
    along = np.linalg.norm(apart - behind[..., None] * normal[:, None], axis=2)
    board = np.where(whole[:, None] | whole, config.board, -np.inf)
    thick = np.where(whole[:, None] & whole, config.leaf_thickness, board)
    leaf = (
        (normal @ normal.T < -0.97)
        & (behind > CROSSED)
        & (behind < thick)
        & (along <= (length[:, None] + length) / 2)
        & (np.minimum(length[:, None], length) <= config.leaf_length)
    )
    either = leaf.any(axis=0) | leaf.any(axis=1)
    gone = {(p.number, a) for (p, a, _), of in zip(short, either) if of}
    left = [(p, [s for s in p.intervals if (p.number, s[0]) not in gone]) for p in planes]
    return [p if len(s) == len(p.intervals) else replace(p, intervals=s) for p, s in left if s]


def _stretches(planes: Sequence[MapPlane]) -> _Stretches:
    rows = [(p, a, b) for p in planes for a, b in p.intervals]
    return _Stretches(
        np.array([p.point(a) for p, a, _ in rows]).reshape(-1, 2),
        np.array([p.point(b) for p, _, b in rows]).reshape(-1, 2),
        np.array([p.normal for p, _, _ in rows]).reshape(-1, 2),
        np.array([p.tangent for p, _, _ in rows]).reshape(-1, 2),
        np.array([p.offset for p, _, _ in rows]),
        np.array([p.number for p, _, _ in rows]),
    )


def _solid(plane: MapPlane, every: _Stretches, config: RoomConfig) -> list[Interval]:
    """Where the wall is: the plane's own stretches and those of the same wall."""
    facing = every.normal @ plane.normal
    middle = (every.first + every.last) / 2
    before = middle @ plane.normal + plane.offset
    same = (facing > PARALLEL) & (np.abs(before) < config.collinear)
    other = (facing < -PARALLEL) & (before < 0.02) & (before > -config.thickest_wall)
    use = same | other
    u, v = every.first[use] @ plane.tangent, every.last[use] @ plane.tangent
    low, high = np.minimum(u, v), np.maximum(u, v)
    reach = config.door_width + 0.5
    near = (high > plane.intervals[0][0] - reach) & (low < plane.intervals[-1][1] + reach)
    spans = [(float(a), float(b)) for a, b in zip(low[near], high[near])]
    return united([*plane.intervals, *spans], 1e-6)


def _turning_back(plane: MapPlane, every: _Stretches, config: RoomConfig) -> Array:
    """Where (m along the plane) walls longer than a door leaf run away from its room."""
    across = every.tangent @ plane.normal
    first = every.first @ plane.normal + plane.offset
    last = every.last @ plane.normal + plane.offset
    high, low = np.maximum(first, last), np.minimum(first, last)
    back = (
        (np.abs(across) > 0.7) & (np.abs(high) < config.corner + 0.2) & (low < -config.leaf_length)
    )
    top = np.where((first > last)[:, None], every.first, every.last)
    out: Array = top[back] @ plane.tangent
    return out


def _hung(plane: MapPlane, others: _Stretches, config: RoomConfig) -> Array:
    """Where (m along the plane) what may be an open leaf stands out of the wall into its room."""
    if not len(others.owner):
        return np.empty(0)
    first = others.first @ plane.normal + plane.offset
    last = others.last @ plane.normal + plane.offset
    high, low = np.maximum(first, last), np.minimum(first, last)
    reach = config.corner + 0.2
    leaf = (
        (np.abs(others.tangent @ plane.normal) > 0.7)
        & (np.abs(low) < reach)
        & (high > reach)
        & (high - low < config.leaf_length)
    )
    foot = np.where((first < last)[:, None], others.first, others.last)
    out: Array = foot[leaf] @ plane.tangent
    return out


def _near(places: Array, along: float, reach: float = 0.3) -> bool:
    return bool((np.abs(places - along) < reach).any())


def _gap(plane: MapPlane, low: float, high: float) -> Gap:
    return Gap(plane.number, np.array([plane.point(low), plane.point(high)]))


def _next_wall(
    plane: MapPlane, end: float, sign: float, every: _Stretches, config: RoomConfig
) -> float | None:
    """Where the line of ``plane`` meets the next wall within a door's width; None if nowhere."""
    slope = every.normal @ plane.tangent
    with np.errstate(divide="ignore", invalid="ignore"):
        hit = end - (every.normal @ plane.point(end) + every.offset) / slope
        crossing = plane.point(0.0) + hit[:, None] * plane.tangent
    width = (hit - end) * sign
    along = np.einsum("ij,ij->i", crossing, every.tangent)
    u = np.einsum("ij,ij->i", every.first, every.tangent)
    v = np.einsum("ij,ij->i", every.last, every.tangent)
    beside = np.maximum(np.minimum(u, v) - along, along - np.maximum(u, v))
    good = (
        (slope * sign < -0.7)  # only walls that face the end
        & (width > config.corner)
        & (width <= config.end_door_width)
        & (beside < config.corner + 0.2)
    )
    return float(hit[good][np.argmin(width[good])]) if good.any() else None
