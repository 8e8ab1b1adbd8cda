"""Poses and points of the map carried into the building, bending as the keyframes were bent."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import msgspec
import numpy as np
from numpy.typing import ArrayLike

from situgraph.geometry.poses import Array, matrix_to_pose, pose_to_matrix
from situgraph.scenegraph.graph import Ellipsoid, Keyframe


class Carrier:
    """Map to building, near each keyframe by that keyframe's own motion.

    Without keyframes everything moves by ``building_T_map``.
    """

    def __init__(
        self,
        keyframes: Sequence[Keyframe],
        frames: Mapping[str, Array],
        building_T_map: Array,
    ) -> None:
        """``keyframes`` as in the map, ``frames`` their poses (4, 4) in the building."""
        self._known = tuple(k for k in keyframes if k.id in frames)
        self._rigid = building_T_map
        before = pose_to_matrix([k.pose for k in self._known]) if self._known else np.eye(4)[None]
        self._place = before[:, :3, 3]
        self._after = (
            np.stack([frames[k.id] for k in self._known]) if self._known else building_T_map[None]
        )
        self._motion = self._after @ np.linalg.inv(before)

    def points(self, points: Array) -> Array:
        """Points (n, 2 or 3) of the map in the building, each moved as its nearest keyframe."""
        given = np.asarray(points, dtype=float)
        level = float(self._place[:, 2].mean())
        full = (
            given if given.shape[1] == 3 else np.column_stack([given, np.full(len(given), level)])
        )
        away = np.linalg.norm(full[:, None, :2] - self._place[None, :, :2], axis=2)
        motion = self._motion[away.argmin(axis=1)]
        moved = np.einsum("nij,nj->ni", motion[:, :3, :3], full) + motion[:, :3, 3]
        out: Array = moved[:, : given.shape[1]]
        return out

    def ellipsoid(self, ellipsoid: Ellipsoid) -> Ellipsoid:
        """An ellipsoid turned into the building."""
        pose = np.eye(4)
        pose[:3, :3] = self._rigid[:3, :3] @ pose_to_matrix((0, 0, 0, *ellipsoid.rotation))[:3, :3]
        qx, qy, qz, qw = matrix_to_pose(pose)[3:].tolist()
        return Ellipsoid(ellipsoid.axes, (qx, qy, qz, qw))

    def keyframes(self) -> tuple[Keyframe, ...]:
        """The keyframes in the building."""
        if not self._known:
            return ()
        return tuple(
            msgspec.structs.replace(k, pose=tuple(row))
            for k, row in zip(self._known, matrix_to_pose(self._after).tolist())
        )

    def latest(self, pose: Array) -> Array:
        """A pose (7,) of the map after the last keyframe, in the building."""
        motion = self._motion[-1] if self._known else self._rigid
        return matrix_to_pose(motion @ pose_to_matrix(pose))

    def trajectory(self, stamps: ArrayLike, poses: ArrayLike) -> Array:
        """Poses (n, 7) of the map in the building.

        Between two keyframes the motions of both are blended by time, so that nothing jumps.

        Args:
            stamps: times (n,) of the poses, s.
            poses: (n, 7) in the map.
        """
        when = np.asarray(stamps, dtype=float)
        matrices = pose_to_matrix(poses)
        if not self._known:
            return matrix_to_pose(self._rigid @ matrices)
        marks = np.array([k.stamp for k in self._known])
        low = np.clip(np.searchsorted(marks, when, side="right") - 1, 0, len(marks) - 1)
        high = np.minimum(low + 1, len(marks) - 1)
        span = np.maximum(marks[high] - marks[low], 1e-9)
        share = np.clip((when - marks[low]) / span, 0.0, 1.0)
        share = np.where(high > low, share, 0.0)
        return _blended(self._motion[low] @ matrices, self._motion[high] @ matrices, share)


def _blended(a: Array, b: Array, share: Array) -> Array:
    """Poses (n, 7) a share of the way from ``a`` to ``b`` (n, 4, 4), which are close."""
    from scipy.spatial.transform import Rotation

    first = Rotation.from_matrix(a[:, :3, :3])
    turn = (first.inv() * Rotation.from_matrix(b[:, :3, :3])).as_rotvec()
    turned = first * Rotation.from_rotvec(turn * share[:, None])
    out = np.empty_like(a)
    out[:] = np.eye(4)
    out[:, :3, :3] = turned.as_matrix()
    out[:, :3, 3] = a[:, :3, 3] + share[:, None] * (b[:, :3, 3] - a[:, :3, 3])
    return matrix_to_pose(out)
