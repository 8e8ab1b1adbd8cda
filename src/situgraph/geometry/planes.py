"""Planes ``n.x + d = 0`` whose unit normal points into the room they bound."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from situgraph.geometry.poses import Array


def signed_distance(points: ArrayLike, normals: ArrayLike, offsets: ArrayLike) -> Array:
    """Distances (points, planes) in metres, positive on the side the normals point to."""
    p = np.asarray(points, dtype=float)
    distances: Array = p @ np.asarray(normals, dtype=float).T + np.asarray(offsets, dtype=float)
    return distances


def orient_towards(normals: ArrayLike, offsets: ArrayLike, point: ArrayLike) -> tuple[Array, Array]:
    """The same planes (n, k), (n,) with each normal turned to the side of ``point`` (k,)."""
    n, d = np.asarray(normals, dtype=float), np.asarray(offsets, dtype=float)
    sign = np.where(n @ np.asarray(point, dtype=float) + d < 0.0, -1.0, 1.0)
    return n * sign[:, None], d * sign


def plan_view(normals: ArrayLike, offsets: ArrayLike) -> tuple[Array, Array]:
    """Vertical planes (n, 3), (n,) as lines in the plan (n, 2), (n,): tilt removed, unit again.

    The offset is rescaled with the normal, so the line is the plane's cut with z = 0.
    """
    n, d = np.asarray(normals, dtype=float), np.asarray(offsets, dtype=float)
    length = np.linalg.norm(n[:, :2], axis=1)
    return n[:, :2] / length[:, None], d / length


def from_footprint(footprint: ArrayLike) -> tuple[Array, Array]:
    """Inward normals (n, 2) and offsets (n,) of the edges of a counter-clockwise polygon (n, 2)."""
    p = np.asarray(footprint, dtype=float)
    edge = np.roll(p, -1, axis=0) - p
    edge /= np.linalg.norm(edge, axis=1, keepdims=True)
    normal = np.stack([-edge[:, 1], edge[:, 0]], axis=1)
    return normal, -np.einsum("ij,ij->i", normal, p)
