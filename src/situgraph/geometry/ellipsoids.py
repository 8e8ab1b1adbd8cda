"""Ellipsoids ``(x - c)' A^-1 (x - c) <= 1`` with a symmetric positive shape matrix ``A`` (m^2)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from situgraph.geometry.poses import Array

UNIFORM = np.sqrt(3.0)  # semi-axis of a uniform segment over its standard deviation


def shape_matrix(axes: ArrayLike, rotation: ArrayLike) -> Array:
    """Shape matrix (3, 3) of semi-axes (3,) in metres turned by a quaternion ``qx qy qz qw``."""
    from scipy.spatial.transform import Rotation

    turn = Rotation.from_quat(np.asarray(rotation, dtype=float)).as_matrix()
    shape: Array = turn @ np.diag(np.asarray(axes, dtype=float) ** 2) @ turn.T
    return shape


def axes_and_rotation(shape: ArrayLike) -> tuple[Array, Array]:
    """Semi-axes (3,), longest first, and right-handed quaternion of a shape matrix (3, 3)."""
    from scipy.spatial.transform import Rotation

    values, vectors = np.linalg.eigh(np.asarray(shape, dtype=float))
    order = np.argsort(values)[::-1]
    turn = vectors[:, order]
    turn[:, 2] *= np.sign(np.linalg.det(turn))
    q = Rotation.from_matrix(turn).as_quat()
    return np.sqrt(np.maximum(values[order], 0.0)), np.where(q[3] < 0, -q, q)


def fit(points: ArrayLike, floor: float = 0.05, trim: float = 0.02) -> tuple[Array, Array]:
    """Centre (3,) and shape (3, 3) of the ellipsoid of a cluster of points (n, 3).

    The covariance ellipsoid: semi-axes are sqrt(3) standard deviations, so a face that is covered
    evenly reaches its rim; never thinner than ``floor`` (m). The share ``trim`` of the points
    that is farthest by Mahalanobis distance is left out of a second fit: a minimum-volume
    ellipsoid would follow single stray points.

    Raises:
        ValueError: no points.
    """
    p = np.asarray(points, dtype=float)
    if len(p) == 0:
        raise ValueError("an ellipsoid needs at least one point")
    center, shape = _moments(p, floor)
    keep = len(p) - int(np.ceil(trim * len(p)))
    if keep >= 8:
        d = p - center
        distance = np.einsum("ij,ij->i", d, np.linalg.solve(shape, d.T).T)
        center, shape = _moments(p[np.argsort(distance, kind="stable")[:keep]], floor)
    return center, shape


def _moments(points: Array, floor: float) -> tuple[Array, Array]:
    center = points.mean(axis=0)
    d = points - center
    values, vectors = np.linalg.eigh(UNIFORM**2 * (d.T @ d) / len(points))
    shape = vectors @ np.diag(np.maximum(values, floor**2)) @ vectors.T
    return center, shape


def separation(offset: ArrayLike, first: ArrayLike, second: ArrayLike) -> float:
    """How far apart two ellipsoids are: <= 1 exactly when they share a point.

    The maximum over s in [0, 1] of ``s (1 - s) d' ((1 - s) A + s B)^-1 d`` for centres ``d`` apart
    and shapes ``A``, ``B`` (3, 3): a concave function (the separation test of Gilitschenski and
    Hanebeck, 2012), found by ternary search on the generalised eigenvalues.
    """
    from scipy.linalg import eigh

    d = np.asarray(offset, dtype=float)
    values, vectors = eigh(np.asarray(second, dtype=float), np.asarray(first, dtype=float))
    w = (vectors.T @ d) ** 2

    def k(s: float) -> float:
        return float(s * (1.0 - s) * np.sum(w / (1.0 - s + s * values)))

    low, high = 0.0, 1.0
    for _ in range(60):
        third = (high - low) / 3.0
        if k(low + third) < k(high - third):
            low += third
        else:
            high -= third
    return k((low + high) / 2.0)


def overlap(offset: ArrayLike, first: ArrayLike, second: ArrayLike) -> bool:
    """Whether two ellipsoids with centres ``offset`` (3,) apart and shapes (3, 3) share a point."""
    return separation(offset, first, second) <= 1.0
