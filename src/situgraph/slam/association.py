"""Which map plane is each piece of wall a keyframe sees.

First the keyframe is aligned as a whole: the small motion in the plan under which most of its
pieces lie on map planes (iteratively reweighted least squares, the gate closing from half a
cupboard to a few centimetres). Then each piece takes the nearest plane within the gate. Front and
back of a wall differ by the direction of their normals and are never confused.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from situgraph.geometry.poses import Array, rotation2, wrap_angle
from situgraph.slam.config import MapConfig
from situgraph.slam.planemap import MapPlane
from situgraph.slam.sightings import Sighting

ROUNDS = 6
IN_LINE = 3.0  # sigmas; pieces of one wall are no farther off its line


class Association(NamedTuple):
    """``correction`` (3,) x, y, yaw about the robot, in the map; ``plane`` a piece or None."""

    correction: Array
    plane: list[int | None]


def associate(
    pieces: Sequence[Sighting],
    level: Array,
    planes: Sequence[MapPlane],
    config: MapConfig,
) -> Association:
    """Pair the pieces of a keyframe with map planes.

    Args:
        pieces: as seen, in the level frame of the keyframe.
        level: (3,) x, y, yaw of that level frame in the map, as predicted.
        planes: the candidates, those of the keyframe's storey.
        config: gates.
    """
    if not pieces or not planes:
        return Association(np.zeros(3), [None] * len(pieces))
    angles = np.array([s.angle for s in pieces])
    middles = np.array([s.ends.mean(axis=0) for s in pieces])
    halves = np.array([s.length / 2 for s in pieces])
    turn_weights = np.array([1.0 / (s.covariance[0, 0] + 1e-4) for s in pieces])
    weights = np.array([_weight(s, config) for s in pieces])
    normals = np.array([p.normal for p in planes])
    offsets = np.array([p.offset for p in planes])
    facing = np.arctan2(normals[:, 1], normals[:, 0])

    correction = np.zeros(3)
    prior = np.array([config.sigma_position, config.sigma_position, config.sigma_yaw]) ** -2.0
    near = np.zeros((len(pieces), len(planes)), dtype=bool)
    for step in range(ROUNDS):
        yaw = level[2] + correction[2]
        centre = level[:2] + correction[:2]
        arms = middles @ rotation2(yaw).T
        turn = wrap_angle(angles[:, None] + yaw - facing[None, :])
        across = (centre + arms) @ normals.T + offsets
        if step in (0, 2):  # which planes reach so far hardly changes with the correction
            near = _near(centre + arms, halves, planes, config.gap)
        gate = max(config.search * 0.6**step, config.offset)
        cost = np.where(near & (np.abs(turn) < config.angle), np.abs(across), np.inf)
        best = cost.argmin(axis=1)
        rows = np.flatnonzero(cost[np.arange(len(pieces)), best] < gate)
        if len(rows) == 0:
            break
        n, r = normals[best[rows]], across[rows, best[rows]]
        # moving by (x, y) and turning by t changes the distance by n.(x, y) + t n.(z cross arm)
        lever = n[:, 1] * arms[rows, 0] - n[:, 0] * arms[rows, 1]
        jacobian = np.column_stack([n, lever])
        w = weights[rows] / (1.0 + (r / (0.5 * gate)) ** 2)
        turns = np.zeros((len(rows), 3))
        turns[:, 2] = 1.0
        turn_weight = turn_weights[rows]
        information = (
            np.diag(prior)
            + (jacobian * w[:, None]).T @ jacobian
            + (turns * turn_weight[:, None]).T @ turns
        )
        right = (
            -prior * correction
            - jacobian.T @ (w * r)
            - turns.T @ (turn_weight * turn[rows, best[rows]])
        )
        correction = correction + np.linalg.solve(information, right)
    return Association(
        correction,
        _pairs(pieces, level + correction, planes, normals, offsets, facing, config),
    )


def one_wall(pieces: Sequence[Sighting], config: MapConfig) -> list[list[int]]:
    """Pieces of one scan that lie on one line, side by side: a wall and the doors in it.

    Indices of the pieces of each wall, its longest piece first.
    """
    walls: list[list[int]] = []
    for i in sorted(range(len(pieces)), key=lambda i: -pieces[i].length):
        for wall in walls:
            if _in_line(pieces[wall[0]], pieces[i], config) and any(
                _gap(pieces[k], pieces[i]) <= config.gap for k in wall
            ):
                wall.append(i)
                break
        else:
            walls.append([i])
    return walls


def _in_line(longer: Sighting, shorter: Sighting, config: MapConfig) -> bool:
    """Whether the shorter piece lies on the line of the longer one, as far as that is known."""
    turn = abs(float(wrap_angle(longer.angle - shorter.angle)))
    middle = shorter.ends.mean(axis=0)
    lever = float(longer.tangent @ middle)
    # x(s) = -offset n + s t: the line at s has moved by the offset's error and -s the angle's.
    across = _variance(longer, lever) + _variance(shorter, float(shorter.tangent @ middle))
    sigma = np.sqrt(longer.covariance[0, 0] + shorter.covariance[0, 0])
    away = abs(float(longer.normal @ middle) + longer.offset)
    return bool(
        turn < min(IN_LINE * sigma, config.angle)
        and away < min(IN_LINE * np.sqrt(across), config.offset)
    )


def _variance(piece: Sighting, along: float) -> float:
    """Variance (m2) of a piece's line, across it, at ``along`` metres from the sensor's foot."""
    c = piece.covariance
    return float(c[1, 1] + 2.0 * along * c[0, 1] + along**2 * c[0, 0])


def _gap(piece: Sighting, other: Sighting) -> float:
    """Metres between two pieces along the first one, 0 where they overlap."""
    mine, its = np.sort(piece.ends @ piece.tangent), np.sort(other.ends @ piece.tangent)
    return max(float(its[0] - mine[1]), float(mine[0] - its[1]), 0.0)


def _weight(piece: Sighting, config: MapConfig) -> float:
    shift = piece.covariance[1, 1] - piece.covariance[0, 1] ** 2 / piece.covariance[0, 0]
    return float(1.0 / (max(shift, 0.0) + (0.3 * config.offset) ** 2))


def _near(middles: Array, halves: Array, planes: Sequence[MapPlane], gap: float) -> Array:
    out = np.zeros((len(middles), len(planes)), dtype=bool)
    for j, plane in enumerate(planes):
        along = middles @ plane.tangent
        low, high = along - halves, along + halves
        for a, b in plane.intervals:
            out[:, j] |= (a - high <= gap) & (low - b <= gap)
    return out


def _pairs(
    pieces: Sequence[Sighting],
    level: Array,
    planes: Sequence[MapPlane],
    normals: Array,
    offsets: Array,
    facing: Array,
    config: MapConfig,
) -> list[int | None]:
    out: list[int | None] = []
    rotation = rotation2(level[2])
    middles = np.array([s.ends.mean(axis=0) for s in pieces]) @ rotation.T + level[:2]
    halves = np.array([s.length / 2 for s in pieces])
    near = _near(middles, halves, planes, config.gap)
    again = _near(middles, halves - np.minimum(halves, config.seen_again), planes, 0.0)
    for i, piece in enumerate(pieces):
        turn = np.abs(wrap_angle(piece.angle + level[2] - facing))
        across = np.abs(normals @ middles[i] + offsets)
        angle_gate = config.angle / 2 + 2.0 * np.sqrt(piece.covariance[0, 0])
        gate = np.where(again[i], config.offset, config.extend)
        fits = near[i] & (turn < min(angle_gate, config.angle)) & (across < gate)
        out.append(
            planes[int(np.where(fits, across, np.inf).argmin())].number if fits.any() else None
        )
    return out
