"""Point clouds as they come in and as the stages want them: finite, in range, evenly thinned."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from situgraph.geometry.poses import Array


class Cleaned(NamedTuple):
    """``points`` (n, 3) float64 that are usable and ``kept`` (m,) bool: which of the input's m are.

    ``broken`` counts points that were NaN or infinite.
    """

    points: Array
    kept: NDArray[np.bool_]
    broken: int


def clean(points: ArrayLike, near: float, far: float) -> Cleaned:
    """The finite points of a scan (m, 3) whose range lies in [``near``, ``far``] metres."""
    p = np.asarray(points, dtype=np.float64).reshape(-1, 3)
    squared = np.einsum("ij,ij->i", p, p)  # NaN and inf survive the square, no point is lost
    kept = (squared >= near * near) & (squared <= far * far)
    return Cleaned(p[kept], kept, int(np.count_nonzero(~np.isfinite(squared))))


def thin(points: Array, cell: float) -> Array:
    """One point a voxel of edge ``cell`` (m): the mean of those in it. (n, 3) in, (m, 3) out."""
    import small_gicp

    if len(points) == 0:
        return points
    thinned = np.asarray(small_gicp.voxelgrid_sampling(points, cell, num_threads=1).points())
    return np.ascontiguousarray(thinned[:, :3])


def moved(points: Array, pose: Array) -> Array:
    """``points`` (n, 3) taken by the 4x4 matrix ``pose``."""
    out: Array = points @ pose[:3, :3].T + pose[:3, 3]
    return out
