"""Which way the surface faces at each point of a scan.

A LiDAR with few rings sees near surfaces as sheets and far ones as single lines. The spread of a
point's neighbours tells which: a sheet gives its normal, a level line on a wall gives the wall's
direction in the plan, and the rest gives nothing.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from situgraph.geometry.poses import Array

NEIGHBOURS = 16
SHEET = 0.35  # third over second principal spread (standard deviations) of a flat neighbourhood
LINE = 0.15  # second over first principal spread of a single ring
UPRIGHT = 0.35  # |z| of a wall's normal at most: 20 deg, more than any robot tilts
FLAT = 0.94  # |z| of a floor's normal at least: 20 deg


class Surfaces(NamedTuple):
    """Points sorted by what they lie on; all (.., 3) arrays in the frame of the input.

    ``walls`` (n, 3) with the angle (n,) of their normal in the plan, turned to the sensor (the
    origin); ``sheets`` (m, 3) normals of those known in three dimensions, walls and floors;
    ``floors`` (k, 3) points on level surfaces.
    """

    walls: Array
    angles: Array
    sheets: Array
    floors: Array


def surfaces(points: Array, reach: float) -> Surfaces:
    """Sort the ``points`` (n, 3) of a scan, roughly level, origin at the sensor.

    ``reach`` (m) is the largest distance of a neighbour at close range; it grows with the range,
    as the distance between points does.
    """
    if len(points) < NEIGHBOURS + 1:
        empty = np.empty((0, 3))
        return Surfaces(empty, np.empty(0), empty, empty)
    spread, axes, near = _principal(points, reach)
    sheet = near & (spread[:, 0] < SHEET * spread[:, 1]) & (spread[:, 1] > LINE * spread[:, 2])
    line = near & (spread[:, 1] <= LINE * spread[:, 2])
    normal, along = axes[:, :, 0], axes[:, :, 2]
    normal = np.where(np.einsum("ij,ij->i", normal, points)[:, None] > 0, -normal, normal)
    level = line & (np.abs(along[:, 2]) < UPRIGHT)
    upright = sheet & (np.abs(normal[:, 2]) < UPRIGHT)
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)
    across = np.where(np.einsum("ij,ij->i", across, points[:, :2])[:, None] > 0, -across, across)
    facing = np.where(sheet[:, None], normal[:, :2], across)
    wall = upright | level
    flat = sheet & (np.abs(normal[:, 2]) > FLAT)
    return Surfaces(
        points[wall],
        np.arctan2(facing[wall, 1], facing[wall, 0]),
        normal[upright | flat],
        points[flat],
    )


def _principal(points: Array, reach: float) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Principal spreads (n, 3) ascending and axes (n, 3, 3) of each point's neighbourhood.

    The last array says where enough neighbours lay within reach.
    """
    from scipy.spatial import cKDTree

    distance, index = cKDTree(points).query(points, NEIGHBOURS + 1)
    limit = np.maximum(reach, 0.08 * np.linalg.norm(points, axis=1))
    within = distance <= limit[:, None]
    count = within.sum(axis=1)
    weight = within / count[:, None]
    neighbours = points[index]
    centred = neighbours - np.einsum("ij,ijk->ik", weight, neighbours)[:, None]
    covariance = np.einsum("ij,ijk,ijl->ikl", weight, centred, centred)
    values, axes = np.linalg.eigh(covariance)
    return np.sqrt(np.maximum(values, 0.0)), axes, count >= 6
