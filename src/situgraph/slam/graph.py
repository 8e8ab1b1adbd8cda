"""The factor graph of the S-Graph, solved as it grows by iSAM2.

Variables by kind: ``x`` keyframe poses (Pose3, base in the map), ``p`` wall planes and ``g`` the
ground of a storey (OrientedPlane3, n.x + d = 0), ``w`` walls and ``a`` axes of a wing (Pose3),
``r`` room centres (Point3). gtsam's plane factor takes Gaussian noise only, so sightings are gated
before they come here; motions are robust.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from situgraph.geometry.poses import Array
from situgraph.slam.config import GraphConfig

Key = tuple[str, int]  # kind and number


@dataclass(frozen=True)
class Sight:
    """A frame ``seer`` sees a plane as ``plane`` (4,) in its own axes; ``sigmas`` (2,) rad, m."""

    seer: Key
    plane: Array
    sigmas: tuple[float, float]


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
        self._waiting: list[tuple[Key, Sight | None] | None] = []  # who owns each waiting factor
        self._slots: dict[Key, list[tuple[int, Sight | None]]] = {}
        self._estimate: Any = None
        self._sigmas: dict[int, tuple[int, tuple[float, float]]] = {}
        self.seconds: list[float] = []

    # keyframes

    def start(self, number: int, pose: Array) -> None:
        """The first keyframe: its place and heading are the map's, its tilt is free."""
        c = self._config
        tilt, fixed = c.start_tilt, c.start_sigma
        self.add_pose(("x", number), pose)
        self.prior(("x", number), pose, np.array([tilt, tilt, fixed, fixed, fixed, fixed]))

    def motion(self, a: int, b: int, motion: Array, sigmas: Array) -> None:
        """Measured ``motion`` (4x4) from keyframe a to b; ``sigmas`` (6,) rad, m. Robust."""
        noise = self._gtsam.noiseModel
        kernel = noise.mEstimator.Huber.Create(self._config.huber)
        model = noise.Robust.Create(kernel, noise.Diagonal.Sigmas(np.asarray(sigmas, float)))
        self._add(
            self._gtsam.BetweenFactorPose3(
                self.key(("x", a)), self.key(("x", b)), self._pose3(motion), model
            )
        )

    def upright(self, number: int, up: Array, sigma: float) -> None:
        """Keyframe ``number`` measured the direction ``up`` (3,) in its own frame."""
        unit = self._gtsam.Unit3
        model = self._gtsam.noiseModel.Isotropic.Sigma(2, sigma)
        up_map = unit(np.array([0.0, 0.0, 1.0]))
        self._add(self._gtsam.AttitudeFactorPose3(self.key(("x", number)), up_map, model, unit(up)))

    # anything

    def add_pose(self, key: Key, pose: Array) -> None:
        """A frame, first guess ``pose`` (4x4)."""
        self._values.insert(self.key(key), self._pose3(pose))

    def add_plane(self, key: Key, plane: Array) -> None:
        """A plane, first guess ``plane`` (4,) n, d in the map."""
        self._values.insert(self.key(key), self._gtsam.OrientedPlane3(plane))

    def add_point(self, key: Key, point: Array) -> None:
        """A point, first guess ``point`` (3,) in the map."""
        self._values.insert(self.key(key), np.asarray(point, dtype=float))

    def prior(self, key: Key, pose: Array, sigmas: Array) -> None:
        """A frame is near ``pose`` (4x4); ``sigmas`` (6,) rad, m along its own axes."""
        model = self._gtsam.noiseModel.Diagonal.Sigmas(np.asarray(sigmas, float))
        self._add(self._gtsam.PriorFactorPose3(self.key(key), self._pose3(pose), model))

    def see(self, plane: Key, sight: Sight) -> None:
        """A frame sees a plane. Both angles of the normal get the same noise.

        gtsam measures them along axes that jump with the normal's direction, so they cannot be
        told apart.
        """
        turn, shift = sight.sigmas
        model = self._gtsam.noiseModel.Diagonal.Sigmas(np.array([turn, turn, shift]))
        factor = self._gtsam.OrientedPlane3Factor(
            sight.plane, model, self.key(sight.seer), self.key(plane)
        )
        self._add(factor, (plane, sight))

    def add_factor(self, factor: Any, owner: Key) -> None:
        """Any gtsam factor; it goes when ``owner`` is forgotten."""
        self._add(factor, (owner, None))

    def merge_planes(self, keep: int, drop: int) -> None:
        """Every sight of plane ``drop`` becomes one of plane ``keep``."""
        gone = self._slots.pop(("p", drop), [])
        self._removed += [slot for slot, _ in gone]
        for _, sight in gone:
            if sight is not None:
                self.see(("p", keep), sight)

    def forget(self, owner: Key) -> None:
        """Take away the factors of ``owner``; the variable goes with its last factor."""
        self._removed += [slot for slot, _ in self._slots.pop(owner, [])]

    # solving

    def update(self) -> float:
        """Take what waits into the graph and solve; returns the processor's seconds it took."""
        start = time.process_time()
        result = self._isam.update(self._factors, self._values, self._removed)
        slots = list(result.getNewFactorsIndices())
        for slot, owned in zip(slots, self._waiting):
            if owned is not None:
                owner, sight = owned
                self._slots.setdefault(owner, []).append((int(slot), sight))
        for _ in range(self._config.extra_steps):
            self._isam.update()
        self._estimate = None
        self._factors = self._gtsam.NonlinearFactorGraph()
        self._values = self._gtsam.Values()
        self._removed, self._waiting = [], []
        spent = time.process_time() - start
        self.seconds.append(spent)
        return spent

    def pose(self, number: int) -> Array:
        """Pose (4x4) of a keyframe."""
        out: Array = self._isam.calculateEstimatePose3(self.key(("x", number))).matrix()
        return out

    def poses(self, numbers: Sequence[int]) -> Array:
        """Poses (n, 4, 4) of keyframes."""
        values = self.values()
        return np.array(
            [values.atPose3(self.key(("x", n))).matrix() for n in numbers], dtype=float
        ).reshape(-1, 4, 4)

    def planes(self, kind: str, numbers: Iterable[int]) -> Array:
        """Planes (n, 4) in the map."""
        values = self.values()
        return np.array(
            [values.atOrientedPlane3(self.key((kind, n))).planeCoefficients() for n in numbers],
            dtype=float,
        ).reshape(-1, 4)

    def plane_sigma(self, number: int, sightings: int) -> tuple[float, float]:
        """Standard deviations of a wall's angle (rad) and of its offset at the origin (m).

        Those of the time when the wall had so many ``sightings``, asked for first: marginals of
        all walls after each keyframe would cost more than matching and coupling together.
        """
        known = self._sigmas.get(number)
        if known is None or known[0] != sightings:
            covariance = self._isam.marginalCovariance(self.key(("p", number)))
            spread = np.sqrt(np.maximum(np.diag(covariance), 0.0))
            known = sightings, (float(spread[:2].max()), float(spread[2]))
            self._sigmas[number] = known
        return known[1]

    def values(self) -> Any:
        """The present estimate of everything (``gtsam.Values``)."""
        if self._estimate is None:
            self._estimate = self._isam.calculateEstimate()
        return self._estimate

    def factors(self) -> Any:
        """All factors (``gtsam.NonlinearFactorGraph``); unused slots are null."""
        return self._isam.getFactorsUnsafe()

    def key(self, key: Key) -> int:
        """The gtsam key."""
        return int(self._gtsam.symbol(*key))

    def _add(self, factor: Any, owned: tuple[Key, Sight | None] | None = None) -> None:
        self._factors.push_back(factor)
        self._waiting.append(owned)

    def _pose3(self, pose: Array) -> Any:
        gtsam = self._gtsam
        return gtsam.Pose3(gtsam.Rot3(np.ascontiguousarray(pose[:3, :3])), pose[:3, 3])
