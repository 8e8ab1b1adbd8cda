"""Where the estimate starts: the placement under which most walls stand where they were planned.

The kernels of the factor graph forget a wall that is far off, so they keep what they start with.
The placement that the readings give may be a compromise between walls that moved and walls that did
not. Each two walls that are not parallel propose a placement near it, and the one is taken under
which the walls together deviate least, by the same kernel, wall by wall.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from situgraph.coupling.walls import Wall
from situgraph.geometry.poses import Array, Placement, wrap_angle

PARALLEL = 0.5  # sine; walls that differ less propose nothing together
SCALE = 0.03  # m; of the kernel, wider than that of the estimate: the map is not yet bent
MOST = 60  # walls that propose, so that large maps take no longer


def settled(
    parts: Sequence[Sequence[Wall]],
    planes: Mapping[str, Array],
    placement: Placement,
    reach: float,
) -> Placement:
    """A better placement, within ``reach`` m of the given one: farther away is another reading.

    Args:
        parts: the faces of each wall.
        planes: online planes (4,) n, d in the map.
        placement: map to building.
        reach: m.
    """
    first = [wall[0] for wall in parts]
    if not first:
        return placement
    turn = _turn(parts, planes, placement)
    middle = np.mean([w.frame[:2, 3] for w in first], axis=0)
    turned = _about(placement, middle, turn)
    normals = np.array([w.frame[:2, 0] for w in first])
    shifts = np.array([_shift(wall, planes, turned) for wall in parts])
    proposals = [np.zeros(2)]
    rows = range(min(len(first), MOST))
    for i in rows:
        for j in range(i):
            pair = normals[[i, j]]
            if abs(float(np.linalg.det(pair))) > PARALLEL:
                proposals.append(np.linalg.solve(pair, shifts[[i, j]]))
    moves = np.array(proposals)
    moves = moves[np.hypot(*moves.T) <= reach]
    rest = shifts[None, :] - moves @ normals.T
    cost = np.log1p((rest / SCALE) ** 2).sum(axis=1)
    x, y = moves[int(cost.argmin())].tolist()
    return Placement(turned.x - x, turned.y - y, turned.z, turned.yaw)


def _turn(parts: Sequence[Sequence[Wall]], planes: Mapping[str, Array], at: Placement) -> float:
    """How far the walls are turned against the plan: the median."""
    turns = []
    for wall in parts:
        n = at.vectors(planes[wall[0].online][:2])
        planned = wall[0].frame[:2, 0]
        turns.append(math.atan2(n[1], n[0]) - math.atan2(planned[1], planned[0]))
    return float(np.median(wrap_angle(turns)))


def _about(placement: Placement, middle: Array, turn: float) -> Placement:
    """The placement turned back by ``turn`` about a point (2,) of the building."""
    before = placement.inverse().points(middle)
    yaw = placement.yaw - turn
    rotated = Placement(0.0, 0.0, 0.0, yaw).points(before)
    return Placement(float(middle[0] - rotated[0]), float(middle[1] - rotated[1]), placement.z, yaw)


def _shift(wall: Sequence[Wall], planes: Mapping[str, Array], at: Placement) -> float:
    """How far (m) a wall lies from its plan, along the normal of its first face: the median."""
    x = wall[0].frame[:3, 0]
    found = []
    for face in wall:
        (n,), (d,) = at.planes(planes[face.online][None, :3], planes[face.online][3:])
        away = -float(n @ face.frame[:3, 3] + d)
        found.append(away * float(np.sign(face.frame[:3, 0] @ x)))
    return float(np.median(found))
