"""Splitting the labelled points of one category into single objects."""

from __future__ import annotations

import numpy as np

from situgraph.geometry.poses import Array


def thin(points: Array, voxel: float) -> Array:
    """One point, the mean, for each occupied voxel of side ``voxel`` (m), in voxel order."""
    return pooled(points, np.ones(len(points)), voxel)[0]


def pooled(points: Array, hits: Array, voxel: float) -> tuple[Array, Array]:
    """The weighted mean of the points (n, 3) in each voxel (m), and the sum of their hits (n,)."""
    if len(points) == 0:
        return points, hits
    cells = np.floor(points / voxel).astype(np.int64)
    cells -= cells.min(axis=0)
    spans = cells.max(axis=0) + 1
    keys = (cells[:, 0] * spans[1] + cells[:, 1]) * spans[2] + cells[:, 2]
    _, inverse = np.unique(keys, return_inverse=True)
    total: Array = np.bincount(inverse, hits).astype(float)
    sums = np.stack([np.bincount(inverse, points[:, k] * hits) for k in range(3)], axis=1)
    return sums / total[:, None], total


def clusters(points: Array, gap: float, smallest: int) -> list[Array]:
    """Groups of thinned points (n, 3) that are linked by steps of at most ``gap`` (m).

    Groups of fewer than ``smallest`` points are dropped; the largest comes first.
    """
    if len(points) < smallest:
        return []
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    pairs = cKDTree(points).query_pairs(gap, output_type="ndarray")
    links = coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(points),) * 2)
    count, label = connected_components(links, directed=False)
    groups = [points[label == k] for k in range(count)]
    return sorted((g for g in groups if len(g) >= smallest), key=len, reverse=True)
