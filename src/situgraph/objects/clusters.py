"""Splitting the labelled points of one category into single objects."""

from __future__ import annotations

import numpy as np

from situgraph.geometry.poses import Array


def thin(points: Array, voxel: float) -> Array:
    """One point, the mean, for each occupied voxel of side ``voxel`` (m), in voxel order."""
    if len(points) == 0:
        return points
    _, inverse, counts = np.unique(
        np.floor(points / voxel).astype(np.int64), axis=0, return_inverse=True, return_counts=True
    )
    inverse = inverse.reshape(-1)
    sums = np.stack([np.bincount(inverse, points[:, k]) for k in range(3)], axis=1)
    means: Array = sums / counts[:, None]
    return means


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
