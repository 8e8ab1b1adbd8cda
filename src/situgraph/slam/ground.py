"""The floor under the robot, as one scan shows it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from situgraph.geometry.poses import Array


class Floor(NamedTuple):
    """``height`` (m) of the floor in the level frame of a scan (negative: below), its ``sigma``."""

    height: float
    sigma: float
    points: int


def floor(
    points: Array, lowest: float, highest: float, least: int, bin_size: float = 0.04
) -> Floor | None:
    """The lowest level that many points (n, 3) of a level scan share, None when there is none.

    Only heights within [``lowest``, ``highest``] (m, below the sensor) count. The level must hold
    ``least`` points and a third of the fullest level's: under a glass front or a stairwell there
    are stray points below the floor.
    """
    z = points[:, 2]
    z = z[(z > lowest) & (z < highest)]
    if len(z) < least:
        return None
    count, edges = np.histogram(z, bins=np.arange(lowest, highest + bin_size, bin_size))
    pair = count[:-1] + count[1:]  # a level may lie on the edge of a bin
    full = np.flatnonzero(pair >= max(least, pair.max() / 3.0))
    if len(full) == 0:
        return None
    k = int(full[0])
    while k + 1 < len(pair) and pair[k + 1] > pair[k]:
        k += 1
    fuller = k if count[k] >= count[k + 1] else k + 1
    height = edges[fuller] + bin_size / 2
    for width in (1.5 * bin_size, bin_size):
        near = z[np.abs(z - height) < width]
        height = float(near.mean())
    return Floor(height, float(near.std() / np.sqrt(len(near)) + 1e-3), len(near))
