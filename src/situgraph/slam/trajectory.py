"""Poses of all scans, carried by their keyframes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from situgraph.geometry.poses import Array, matrix_to_pose
from situgraph.slam.graph import FactorGraph
from situgraph.slam.keyframes import Keyframe
from situgraph.slam.motion import interpolate, relative

Path = Sequence[tuple[float, int, Array]]


def trajectory(
    path: Path, keyframes: Sequence[Keyframe], graph: FactorGraph
) -> tuple[Array, Array]:
    """Stamps (n,) and poses (n, 7) of base in the map.

    ``path`` holds stamp, keyframe before and motion (4x4) since that keyframe of each scan. Between
    two keyframes the odometry is followed from both ends and the two are blended by time, so that
    what the graph corrected at the second one is spread over the way to it.
    """
    if not path:
        return np.empty(0), np.empty((0, 7))
    poses = graph.poses([k.number for k in keyframes])
    out = np.empty((len(path), 4, 4))
    for i, (stamp, number, motion) in enumerate(path):
        out[i] = poses[number] @ motion
        if number + 1 < len(keyframes):
            before, after = keyframes[number], keyframes[number + 1]
            since = relative(after.odometry, before.odometry @ motion)
            share = (stamp - before.stamp) / (after.stamp - before.stamp)
            out[i] = interpolate(out[i], poses[number + 1] @ since, share)
    return np.array([stamp for stamp, _, _ in path]), matrix_to_pose(out)


class Trail:
    """The way in steps of some decimetres, relative to keyframes so that it follows them."""

    def __init__(self, step: float) -> None:
        """``step`` (m): what is nearer to the last place adds nothing."""
        self._step = step
        self._numbers: list[int] = []
        self._places: list[Array] = []

    def add(self, keyframe: int, place: Array) -> None:
        """Base was at ``place`` (3,) in a keyframe's frame."""
        same = bool(self._numbers) and self._numbers[-1] == keyframe
        if same and float(np.linalg.norm(place - self._places[-1])) < self._step:
            return
        self._numbers.append(keyframe)
        self._places.append(place)

    def places(self, poses: Array) -> Array:
        """All places (n, 3) in the map, given the poses (m, 4, 4) of the keyframes."""
        if not self._numbers:
            return np.empty((0, 3))
        seen = poses[self._numbers]
        out: Array = np.einsum("nij,nj->ni", seen[:, :3, :3], self._places) + seen[:, :3, 3]
        return out
