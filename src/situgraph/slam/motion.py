"""What is known of the robot's motion before a scan is registered."""

from __future__ import annotations

import bisect
from collections import deque

import numpy as np

from situgraph.geometry.poses import Array


class OdometryTrack:
    """The last seconds of recorded odometry: poses of base in the odometry's own frame.

    Logs of keyframes have one pose every few seconds: the last few are kept whatever their age.
    """

    def __init__(self, memory: float, least: int) -> None:
        """Keep ``memory`` seconds and no fewer than ``least`` poses."""
        self._memory = memory
        self._least = least
        self._stamps: deque[float] = deque()
        self._poses: deque[Array] = deque()

    def add(self, stamp: float, pose: Array) -> None:
        """Append the 4x4 ``pose`` at ``stamp`` (s), which must be later than all before."""
        self._stamps.append(stamp)
        self._poses.append(pose)
        while len(self._stamps) > self._least and self._stamps[0] < stamp - self._memory:
            self._stamps.popleft()
            self._poses.popleft()

    def restart(self) -> None:
        """Forget everything: what follows is not tied to what came before."""
        self._stamps.clear()
        self._poses.clear()

    @property
    def last(self) -> tuple[float, Array] | None:
        """The newest stamp and pose."""
        return (self._stamps[-1], self._poses[-1]) if self._stamps else None

    def at(self, stamp: float, slack: float) -> Array | None:
        """The pose at ``stamp``, interpolated; None when nothing lies within ``slack`` seconds."""
        stamps = self._stamps
        if not stamps or stamp < stamps[0] - slack or stamp > stamps[-1] + slack:
            return None
        i = bisect.bisect_left(stamps, stamp)
        if i == 0:
            return self._poses[0]
        if i == len(stamps):
            return self._poses[-1]
        before, after = stamps[i - 1], stamps[i]
        return interpolate(self._poses[i - 1], self._poses[i], (stamp - before) / (after - before))

    def between(self, start: float, end: float, slack: float) -> Array | None:
        """Motion (4x4) of base from ``start`` to ``end``, None where it was not recorded."""
        a, b = self.at(start, slack), self.at(end, slack)
        return None if a is None or b is None else relative(a, b)


def relative(a: Array, b: Array) -> Array:
    """Pose ``b`` seen from pose ``a``; both 4x4 in one frame."""
    out: Array = inverse(a) @ b
    return out


def inverse(pose: Array) -> Array:
    """The inverse of a 4x4 rigid motion."""
    out = np.eye(4)
    out[:3, :3] = pose[:3, :3].T
    out[:3, 3] = -pose[:3, :3].T @ pose[:3, 3]
    return out


def interpolate(a: Array, b: Array, share: float) -> Array:
    """The pose ``share`` of the way from ``a`` to ``b`` (0..1; beyond 1 it extrapolates)."""
    from scipy.spatial.transform import Rotation

    turn = Rotation.from_matrix(a[:3, :3].T @ b[:3, :3]).as_rotvec()
    out = np.eye(4)
    out[:3, :3] = a[:3, :3] @ Rotation.from_rotvec(share * turn).as_matrix()
    out[:3, 3] = a[:3, 3] + share * (b[:3, 3] - a[:3, 3])
    return out


def tidy(pose: Array) -> Array:
    """A 4x4 pose with its rotation made orthogonal again after many products."""
    u, _, vt = np.linalg.svd(pose[:3, :3])
    out = np.array(pose, dtype=float)
    out[:3, :3] = u @ vt
    return out


def size(motion: Array) -> tuple[float, float]:
    """Length (m) and angle (rad) of a 4x4 motion."""
    cosine = (np.trace(motion[:3, :3]) - 1.0) / 2.0
    return float(np.linalg.norm(motion[:3, 3])), float(np.arccos(np.clip(cosine, -1.0, 1.0)))
