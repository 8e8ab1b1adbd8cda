"""Rigid motions: planar placements and TUM poses.

Angles are radians, lengths metres, frames right-handed with z up. A pose is the seven numbers
``x y z qx qy qz qw`` (the order of the TUM trajectory format).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import msgspec
import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def wrap_angle(angle: ArrayLike) -> Array:
    """Angles wrapped to [-pi, pi)."""
    wrapped: Array = (np.asarray(angle, dtype=float) + np.pi) % (2.0 * np.pi) - np.pi
    return wrapped


def rotation2(yaw: float) -> Array:
    """The 2x2 rotation by ``yaw``."""
    c, s = math.cos(yaw), math.sin(yaw)
    return np.array([[c, -s], [s, c]])


class Placement(msgspec.Struct, frozen=True):
    """A proper rigid motion that keeps z up: rotate by ``yaw`` about z, then add ``(x, y, z)``.

    In a match it takes map coordinates to building coordinates; it never mirrors.
    """

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    yaw: float = 0.0

    def points(self, points: ArrayLike) -> Array:
        """Moved points; (..., 2) or (..., 3) in, the same shape out."""
        p = np.array(points, dtype=float)
        p[..., :2] = p[..., :2] @ rotation2(self.yaw).T + (self.x, self.y)
        if p.shape[-1] == 3:
            p[..., 2] += self.z
        return p

    def vectors(self, vectors: ArrayLike) -> Array:
        """Turned directions; (..., 2) or (..., 3) in, the same shape out."""
        v = np.array(vectors, dtype=float)
        v[..., :2] = v[..., :2] @ rotation2(self.yaw).T
        return v

    def planes(self, normals: ArrayLike, offsets: ArrayLike) -> tuple[Array, Array]:
        """Moved planes ``n.x + d = 0``: normals (n, 2 or 3) and offsets (n,) in, the same out."""
        n = self.vectors(normals)
        shift = np.array([self.x, self.y, self.z])[: n.shape[-1]]
        return n, np.asarray(offsets, dtype=float) - n @ shift

    def compose(self, other: Placement) -> Placement:
        """The motion that applies ``other`` first and this one after."""
        x, y = rotation2(self.yaw) @ (other.x, other.y)
        yaw = float(wrap_angle(self.yaw + other.yaw))
        return Placement(self.x + float(x), self.y + float(y), self.z + other.z, yaw)

    def inverse(self) -> Placement:
        """The motion back."""
        x, y = rotation2(-self.yaw) @ (-self.x, -self.y)
        return Placement(float(x), float(y), -self.z, float(wrap_angle(-self.yaw)))

    def matrix(self) -> Array:
        """The 4x4 homogeneous matrix."""
        m = np.eye(4)
        m[:2, :2] = rotation2(self.yaw)
        m[:3, 3] = (self.x, self.y, self.z)
        return m


def best_placement(own: Sequence[Placement], center: Array, z: float) -> Placement:
    """The placement map -> building nearest to that of each room, by least squares.

    Fitted over the four points 2 m around each room's centre (n, 2) in the map; ``own`` are the
    rooms' placements.
    """
    around = np.array([(2.0, 0.0), (0.0, 2.0), (-2.0, 0.0), (0.0, -2.0)])
    online = (center[:, None, :] + around).reshape(-1, 2)
    building = np.concatenate([p.points(c + around) for p, c in zip(own, center)])
    p, q = online - online.mean(axis=0), building - building.mean(axis=0)
    yaw = math.atan2(float(np.sum(p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0])), float(np.sum(p * q)))
    turned = Placement(yaw=yaw).points(online.mean(axis=0))
    x, y = (building.mean(axis=0) - turned).tolist()
    return Placement(x, y, z, yaw)


def pose_to_matrix(pose: ArrayLike) -> Array:
    """4x4 matrices (..., 4, 4) of poses ``x y z qx qy qz qw`` (..., 7)."""
    p = np.asarray(pose, dtype=float)
    x, y, z, w = np.moveaxis(p[..., 3:] / np.linalg.norm(p[..., 3:], axis=-1, keepdims=True), -1, 0)
    m = np.zeros((*p.shape[:-1], 4, 4))
    m[..., 0, 0], m[..., 0, 1], m[..., 0, 2] = (
        1 - 2 * (y * y + z * z),
        2 * (x * y - z * w),
        2 * (x * z + y * w),
    )
    m[..., 1, 0], m[..., 1, 1], m[..., 1, 2] = (
        2 * (x * y + z * w),
        1 - 2 * (x * x + z * z),
        2 * (y * z - x * w),
    )
    m[..., 2, 0], m[..., 2, 1], m[..., 2, 2] = (
        2 * (x * z - y * w),
        2 * (y * z + x * w),
        1 - 2 * (x * x + y * y),
    )
    m[..., :3, 3] = p[..., :3]
    m[..., 3, 3] = 1.0
    return m


def matrix_to_pose(matrix: ArrayLike) -> Array:
    """Poses ``x y z qx qy qz qw`` (..., 7) of 4x4 matrices (..., 4, 4), with qw >= 0."""
    from scipy.spatial.transform import Rotation

    m = np.asarray(matrix, dtype=float)
    q = Rotation.from_matrix(m[..., :3, :3].reshape(-1, 3, 3)).as_quat()
    q = np.where(q[:, 3:] < 0, -q, q).reshape(*m.shape[:-2], 4)
    return np.concatenate([m[..., :3, 3], q], axis=-1)


def yaw_of(pose: ArrayLike) -> Array:
    """Yaw (...,) of poses (..., 7)."""
    x, y, z, w = np.moveaxis(np.asarray(pose, dtype=float)[..., 3:], -1, 0)
    yaw: Array = np.arctan2(2 * (x * y + z * w), 1 - 2 * (y * y + z * z))
    return yaw
