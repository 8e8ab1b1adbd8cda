"""How far a scan sees through at the height of walls, direction by direction.

Low furniture does not end free space: a direction is as free as its freest beam between the floor
and the lintels. What lies behind glass is cut off later by the wall planes.
"""

from __future__ import annotations

import numpy as np

from situgraph.geometry.poses import Array
from situgraph.slam.config import RoomConfig

BINS = 360
HOLE = 4  # directions without a beam that are bridged


def free_reach(points: Array, origin: Array, floor: float, config: RoomConfig) -> Array:
    """Free distance (BINS,) m around ``origin`` in the plan; 0 where nothing is known.

    Args:
        points: (n, 3) of a level scan.
        origin: (3,) of the LiDAR in that frame.
        floor: height of the floor there (m).
        config: the band of heights and the largest distance.
    """
    ray = points - origin
    distance = np.hypot(ray[:, 0], ray[:, 1])
    with np.errstate(divide="ignore", invalid="ignore"):
        slope = ray[:, 2] / distance
        leaves = (floor + config.band_top - origin[2]) / slope  # where the beam rises too high
    free = np.where((slope > 0) & (leaves < distance), leaves, distance)
    bins = ((np.arctan2(ray[:, 1], ray[:, 0]) / (2 * np.pi) + 1.0) * BINS).astype(int) % BINS
    reach = np.zeros(BINS)
    np.maximum.at(reach, bins, np.minimum(free, config.free_range))
    return _bridged(reach)


def outline(reach: Array, config: RoomConfig) -> Array:
    """The free area as a polygon (m, 2) around the origin, a margin smaller than ``reach``."""
    narrow = np.minimum(reach, np.minimum(np.roll(reach, 1), np.roll(reach, -1)))
    shown = np.maximum(narrow - config.free_margin, 0.0)
    angle = (np.arange(BINS) + 0.5) / BINS * 2 * np.pi
    out: Array = shown[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return out


def _bridged(reach: Array) -> Array:
    """Short runs of empty directions take the smaller of their two ends."""
    out = reach.copy()
    seen = np.flatnonzero(reach > 0)
    if len(seen) < 2:
        return out
    ahead = np.roll(seen, -1)
    for a, b in zip(seen, ahead):
        hole = (b - a) % BINS - 1
        if 0 < hole <= HOLE:
            out[(a + 1 + np.arange(hole)) % BINS] = min(reach[a], reach[b])
    return out
