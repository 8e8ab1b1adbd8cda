"""How good a trajectory and a map are, against ground truth. Nothing here feeds an estimator."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from situgraph.geometry.poses import Array, pose_to_matrix

Index = NDArray[np.intp]


class Errors(NamedTuple):
    """Statistics of a set of errors, in the unit of the errors."""

    rmse: float
    mean: float
    median: float
    largest: float
    number: int


def statistics(errors: ArrayLike) -> Errors:
    """Root mean square, mean, median and maximum; NaN where there is nothing."""
    e = np.asarray(errors, dtype=float)
    if len(e) == 0:
        return Errors(np.nan, np.nan, np.nan, np.nan, 0)
    return Errors(
        float(np.sqrt(np.mean(e * e))),
        float(np.mean(e)),
        float(np.median(e)),
        float(np.max(e)),
        len(e),
    )


def associated(
    reference: ArrayLike, estimate: ArrayLike, largest_difference: float = 0.01
) -> tuple[Index, Index]:
    """Indices of poses that belong together: each stamp of the shorter list and its nearest (s)."""
    a, b = np.asarray(reference, dtype=float), np.asarray(estimate, dtype=float)
    if len(b) > len(a):
        j, i = associated(b, a, largest_difference)
        return i, j
    if len(b) == 0:
        return np.empty(0, np.intp), np.empty(0, np.intp)
    right = np.clip(np.searchsorted(a, b), 1, max(len(a) - 1, 1))
    left = right - 1
    right = np.minimum(right, len(a) - 1)
    nearest = np.where(np.abs(a[left] - b) <= np.abs(a[right] - b), left, right)
    good = np.abs(a[nearest] - b) <= largest_difference
    return nearest[good], np.flatnonzero(good)


def alignment(reference: ArrayLike, estimate: ArrayLike) -> Array:
    """The rigid motion (4x4) that brings points ``estimate`` (n, 3) nearest to ``reference``.

    Umeyama, PAMI 1991, without scale.
    """
    r, e = np.asarray(reference, dtype=float), np.asarray(estimate, dtype=float)
    middle_r, middle_e = r.mean(axis=0), e.mean(axis=0)
    u, _, vt = np.linalg.svd((r - middle_r).T @ (e - middle_e))
    sign = np.diag([1.0, 1.0, np.linalg.det(u) * np.linalg.det(vt)])
    out = np.eye(4)
    out[:3, :3] = u @ sign @ vt
    out[:3, 3] = middle_r - out[:3, :3] @ middle_e
    return out


def absolute_errors(reference: ArrayLike, estimate: ArrayLike, *, align: bool = True) -> Errors:
    """ATE: distances (m) between poses (n, 7) that belong together, after alignment in SE(3)."""
    r, e = np.asarray(reference, dtype=float), np.asarray(estimate, dtype=float)
    points = e[:, :3]
    if align:
        motion = alignment(r[:, :3], points)
        points = points @ motion[:3, :3].T + motion[:3, 3]
    return statistics(np.linalg.norm(points - r[:, :3], axis=1))


def relative_errors(
    reference: ArrayLike, estimate: ArrayLike, step: int = 1
) -> tuple[Errors, Errors]:
    """RPE over ``step`` poses: of the translation (m) and of the angle (rad); poses are (n, 7)."""
    r, e = pose_to_matrix(reference)[::step], pose_to_matrix(estimate)[::step]
    motion_r = np.linalg.inv(r[:-1]) @ r[1:]
    motion_e = np.linalg.inv(e[:-1]) @ e[1:]
    error = np.linalg.inv(motion_r) @ motion_e
    cosine = (np.trace(error[:, :3, :3], axis1=1, axis2=2) - 1.0) / 2.0
    turn = np.arccos(np.clip(cosine, -1.0, 1.0))
    return statistics(np.linalg.norm(error[:, :3, 3], axis=1)), statistics(turn)
