"""Undo the motion of the LiDAR while it turned."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from situgraph.geometry.poses import Array

# Points are corrected in this many groups a turn: 2.5 ms each at 10 Hz, 2.5 mm at 1 m/s.
GROUPS = 40


def deskew(points: Array, times: ArrayLike, motion: Array, period: float) -> Array:
    """Points as if all had been measured at the end of the turn.

    The sensor is taken to move at constant speed and turn rate (KISS-ICP, RA-L 2023, section
    III-A).

    Args:
        points: (n, 3) metres, each in the sensor's frame at its own time.
        times: (n,) seconds before the end of the turn, not positive.
        motion: 4x4 pose of the sensor at the end of the turn in its frame ``period`` earlier.
        period: seconds that ``motion`` took.

    Returns:
        (n, 3) metres in the sensor's frame at the end of the turn.
    """
    from scipy.spatial.transform import Rotation

    t = np.asarray(times, dtype=float)
    if len(points) == 0 or period <= 0.0:
        return points
    start = min(float(t.min()), -1e-6)
    share = (np.arange(GROUPS) + 0.5) / GROUPS * start / period  # 0 at the end, negative before
    turn = Rotation.from_matrix(motion[:3, :3]).as_rotvec()
    rotation = Rotation.from_rotvec(share[:, None] * turn).as_matrix()
    # Sensors list points in time order; then each group is one slice.
    order = None if bool((t[1:] >= t[:-1]).all()) else np.argsort(t, kind="stable")
    sorted_points, sorted_times = (points, t) if order is None else (points[order], t[order])
    edges = np.searchsorted(sorted_times, np.arange(GROUPS, -1, -1) / GROUPS * start)
    edges[0], edges[-1] = 0, len(t)
    out = np.empty_like(sorted_points)
    for k, (a, b) in enumerate(pairwise(edges.tolist())):
        group = GROUPS - 1 - k
        out[a:b] = sorted_points[a:b] @ rotation[group].T + share[group] * motion[:3, 3]
    if order is None:
        return out
    unsorted = np.empty_like(out)
    unsorted[order] = out
    return unsorted
