"""The factor graph of the S-Graph, solved as it grows by iSAM2.

Variables: keyframe poses (Pose3, base in the map), wall planes and one ground plane a storey
(OrientedPlane3, n.x + d = 0), rooms (Point3) and walls (Pose3). gtsam's plane factor takes Gaussian
noise only, so planes are gated before they come here; odometry is robust.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from situgraph.geometry.poses import Array
from situgraph.slam.config import GraphConfig


class FactorGraph:
    """Factors wait until ``update``; estimates are those of the last update."""

    def __init__(self, config: GraphConfig) -> None:
        """An empty graph."""
        import gtsam

        self._gtsam = gtsam
        self._config = config
        parameters = gtsam.ISAM2Params()
        parameters.setRelinearizeThreshold(config.relinearize)
        parameters.relinearizeSkip = 1
        parameters.findUnusedFactorSlots = True
        self._isam = gtsam.ISAM2(parameters)
        self._factors = gtsam.NonlinearFactorGraph()
        self._values = gtsam.Values()
        self._removed: list[int] = []
        self._estimate: Any = None
        self.seconds: list[float] = []

    # -- keys ------------------------------------------------------------------------------------

    def key(self, kind: str, number: int) -> int:
        """The key: kind ``x`` keyframe, ``p`` plane, ``g`` ground, ``r`` room, ``w`` wall."""
        return int(self._gtsam.symbol(kind, number))

    # -- keyframes -------------------------------------------------------------------------------

    def start(self, number: int, pose: Array) -> None:
        """The first keyframe: its place and heading are the map's, its tilt is free."""
        c = self._config
        sigmas = np.array([c.start_tilt, c.start_tilt, 1e-4, 1e-3, 1e-3, 1e-3])
        self._add_pose(number, pose)
        noise = self._gtsam.noiseModel.Diagonal.Sigmas(sigmas)
        self._add(self._gtsam.PriorFactorPose3(self.key("x", number), self._pose3(pose), noise))

    def follow(self, number: int, pose: Array) -> None:
        """A further keyframe, first guess ``pose`` (4x4); ``motion`` factors tie it."""
        self._add_pose(number, pose)

    def motion(self, a: int, b: int, motion: Array, sigmas: Array) -> None:
        """Measured ``motion`` (4x4) from keyframe a to b; ``sigmas`` (6,) rad then m. Robust."""
        noise = self._gtsam.noiseModel
        kernel = noise.mEstimator.Huber.Create(self._config.huber)
        model = noise.Robust.Create(kernel, noise.Diagonal.Sigmas(np.asarray(sigmas, float)))
        self._add(
            self._gtsam.BetweenFactorPose3(
                self.key("x", a), self.key("x", b), self._pose3(motion), model
            )
        )

    def upright(self, number: int, up: Array, sigma: float) -> None:
        """Keyframe ``number`` measured the direction ``up`` (3,) in its own frame."""
        unit = self._gtsam.Unit3
        model = self._gtsam.noiseModel.Isotropic.Sigma(2, sigma)
        self._add(
            self._gtsam.AttitudeFactorPose3(
                self.key("x", number), unit(np.array([0.0, 0.0, 1.0])), model, unit(up)
            )
        )

    # -- planes ----------------------------------------------------------------------------------

    def add_plane(self, kind: str, number: int, plane: Array) -> None:
        """A plane (4,) n, d in the map: wall (``p``) or ground (``g``)."""
        self._values.insert(self.key(kind, number), self._gtsam.OrientedPlane3(plane))

    def see(self, keyframe: int, kind: str, number: int, plane: Array, sigmas: Array) -> None:
        """The keyframe saw the plane as ``plane`` (4,) in its own frame.

        ``sigmas`` (2,): of the normal's angles (rad, both alike: the axes gtsam measures them in
        jump with the direction) and of the offset (m).
        """
        turn, shift = (float(s) for s in sigmas)
        model = self._gtsam.noiseModel.Diagonal.Sigmas(np.array([turn, turn, shift]))
        self._add(
            self._gtsam.OrientedPlane3Factor(
                plane, model, self.key("x", keyframe), self.key(kind, number)
            )
        )

    # -- solving ---------------------------------------------------------------------------------

    def update(self) -> float:
        """Take what waits into the graph and solve; returns the seconds it took."""
        start = time.perf_counter()
        self._isam.update(self._factors, self._values, self._removed)
        self._isam.update()
        self._estimate = None
        self._factors = self._gtsam.NonlinearFactorGraph()
        self._values = self._gtsam.Values()
        self._removed = []
        spent = time.perf_counter() - start
        self.seconds.append(spent)
        return spent

    def pose(self, number: int) -> Array:
        """Pose (4x4) of a keyframe."""
        out: Array = self._isam.calculateEstimatePose3(self.key("x", number)).matrix()
        return out

    def planes(self, kind: str, numbers: Iterable[int]) -> Array:
        """Planes (n, 4) in the map."""
        values = self._all()
        return np.array(
            [values.atOrientedPlane3(self.key(kind, n)).planeCoefficients() for n in numbers]
        ).reshape(-1, 4)

    def poses(self, numbers: Sequence[int]) -> Array:
        """Poses (n, 4, 4) of keyframes."""
        values = self._all()
        return np.array([values.atPose3(self.key("x", n)).matrix() for n in numbers]).reshape(
            -1, 4, 4
        )

    def _all(self) -> Any:
        if self._estimate is None:
            self._estimate = self._isam.calculateEstimate()
        return self._estimate

    def _add_pose(self, number: int, pose: Array) -> None:
        self._values.insert(self.key("x", number), self._pose3(pose))

    def _add(self, factor: Any) -> None:
        self._factors.push_back(factor)

    def _pose3(self, pose: Array) -> Any:
        gtsam = self._gtsam
        return gtsam.Pose3(gtsam.Rot3(np.ascontiguousarray(pose[:3, :3])), pose[:3, 3])
