"""The tilt of a scan against gravity, from walls that are upright and floors that are level."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from situgraph.geometry.poses import Array


class Tilt(NamedTuple):
    """``up`` (3,): the direction of up in the frame of the scan; ``sigma`` (rad) of its two angles.

    ``sigma`` is that of the weaker angle: a lone corridor shows only the tilt about its own axis.
    """

    up: Array
    sigma: float


def tilt(sheets: Array, prior_sigma: float, normal_sigma: float, wall_tilt: float) -> Tilt:
    """Refine up = (0, 0, 1) from surface normals (n, 3) of a roughly level scan.

    Minimises the sum of (normal . up)^2 over walls and of |normal x up|^2 over floors, each
    normal with ``normal_sigma`` (rad), against a prior of ``prior_sigma`` (rad). Normals that
    disagree by more than ``wall_tilt`` (rad) with their kind are left out in later rounds, so a
    ramp does not pull.
    """
    up = np.array([0.0, 0.0, 1.0])
    information = np.eye(2) / prior_sigma**2
    for limit in (3.0 * wall_tilt, 1.5 * wall_tilt, wall_tilt):
        along = sheets @ up
        walls = sheets[np.abs(along) < np.sin(limit)]
        floors = sheets[along > np.cos(limit)]
        # up = (a, b, 1): a wall says n_x a + n_y b = -n_z, a floor says (a, b) = (n_x, n_y)/n_z.
        weight = 1.0 / normal_sigma**2
        information = (
            np.eye(2) / prior_sigma**2
            + weight * walls[:, :2].T @ walls[:, :2]
            + weight * len(floors) * np.eye(2)
        )
        right = -weight * walls[:, :2].T @ walls[:, 2]
        if len(floors):
            right = right + weight * (floors[:, :2] / floors[:, 2:]).sum(axis=0)
        a, b = np.linalg.solve(information, right)
        up = np.array([a, b, 1.0]) / np.sqrt(a * a + b * b + 1.0)
    weakest = float(np.linalg.eigvalsh(information)[0])
    return Tilt(up, 1.0 / np.sqrt(weakest))


def levelling(up: Array) -> Array:
    """The smallest rotation (3, 3) that turns the direction ``up`` (3,) to (0, 0, 1)."""
    x, y, z = (float(v) for v in up / np.linalg.norm(up))
    c = 1.0 / (1.0 + z)
    return np.array([[1 - x * x * c, -x * y * c, -x], [-x * y * c, 1 - y * y * c, -y], [x, y, z]])
