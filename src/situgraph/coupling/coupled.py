"""A-Graph and S-Graph in one factor graph (paper section III, 'Graph merging', made robust).

To the factors of the S-Graph come the pose of the building in the map and, for each matched face,
the pose of a deviation frame. The face as seen lies on its deviation frame; the deviation frame
stands where the plan puts it, under a Cauchy kernel: most walls are where they were planned, and
one that is not tells so without dragging the others along.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from situgraph.coupling.config import CouplingConfig
from situgraph.coupling.evidence import Evidence
from situgraph.coupling.walls import Wall
from situgraph.geometry.poses import Array, Placement

FREE = 1e3  # m or rad: no information


@dataclass(frozen=True)
class WallEstimate:
    """How a face stands against its plan.

    ``offset`` (m) is positive along the planned inward normal, ``tilt`` (rad) its turn in the plan;
    each with its standard deviation. ``place`` (3,) is where on the planned face, building frame.
    """

    online: str
    prior: str
    offset: float
    offset_sigma: float
    tilt: float
    tilt_sigma: float
    place: tuple[float, float, float]


class Coupled:
    """The map in the building; standard deviations are worked out when they are asked for.

    Attributes:
        building_T_map: (4, 4).
        frames: each keyframe's pose (4, 4) in the building.
        planes: each online plane (4,) n, d there.
        seconds: what the optimisation took.
    """

    def __init__(
        self, problem: _Problem, values: Any, evidence: Evidence, anchor: Array, start: float
    ) -> None:
        """Read the solution ``values``; ``start`` is when the work began."""
        self._problem = problem
        self._values = values
        building = values.atPose3(problem.building).matrix()  # the anchor in the map
        self.building_T_map: Array = anchor @ np.linalg.inv(building)
        move = self.building_T_map
        self.frames = {k: move @ values.atPose3(v).matrix() for k, v in evidence.keyframes.items()}
        self.planes = {
            k: _moved(values.atOrientedPlane3(v).planeCoefficients(), move)
            for k, v in evidence.planes.items()
        }
        self.seconds = time.perf_counter() - start

    @property
    def placement(self) -> Placement:
        """Map to building, without the (small) tilt."""
        m = self.building_T_map
        x, y, z = m[:3, 3].tolist()
        return Placement(x, y, z, math.atan2(m[1, 0], m[0, 0]))

    @cached_property
    def walls(self) -> tuple[WallEstimate, ...]:
        """The matched faces."""
        return _estimates(self._problem, self._values)

    @cached_property
    def rms(self) -> float:
        """Of the offsets (m) of the matched faces that are where they were planned."""
        near = [w.offset for w in self.walls if abs(w.offset) <= self._problem.told]
        return math.sqrt(sum(d * d for d in near) / len(near)) if near else 0.0


def couple(
    evidence: Evidence, walls: Sequence[Wall], placement: Placement, config: CouplingConfig
) -> Coupled:
    """Solve both graphs together.

    Args:
        evidence: what the robot knows.
        walls: the matched faces; those whose plane is not in ``evidence`` are left out.
        placement: the match's first guess, map to building.
        config: scales of the kernels.
    """
    import gtsam

    start = time.perf_counter()
    known = [w for w in walls if w.online in evidence.planes]
    anchor = _anchor(known)
    problem = _Problem(gtsam, evidence, known, placement, anchor, config)
    parameters = gtsam.LevenbergMarquardtParams()
    parameters.setMaxIterations(config.max_iterations)
    parameters.setRelativeErrorTol(1e-7)
    values = gtsam.LevenbergMarquardtOptimizer(
        problem.factors, problem.values, parameters
    ).optimize()
    return Coupled(problem, values, evidence, anchor, start)


class _Problem:
    """The factors of both graphs, and where the estimate starts."""

    def __init__(
        self,
        gtsam: Any,
        evidence: Evidence,
        walls: Sequence[Wall],
        placement: Placement,
        anchor: Array,
        config: CouplingConfig,
    ) -> None:
        noise = gtsam.noiseModel
        self.gtsam = gtsam
        self.walls = walls
        self.told = config.told_offset
        self.factors = gtsam.NonlinearFactorGraph(evidence.factors)
        self.values = gtsam.Values(evidence.values)
        self.building = gtsam.symbol("B", 0)
        self.deviations = [gtsam.symbol("D", i) for i in range(len(walls))]
        self.planned = [np.linalg.inv(anchor) @ w.frame for w in walls]  # seen from the anchor
        first = np.linalg.inv(placement.matrix()) @ anchor
        self.values.insert(self.building, gtsam.Pose3(first))
        level = np.array(
            [config.level_sigma, config.level_sigma, FREE, FREE, FREE, config.height_sigma]
        )
        self.factors.push_back(
            gtsam.PriorFactorPose3(self.building, gtsam.Pose3(first), noise.Diagonal.Sigmas(level))
        )
        kernel = noise.mEstimator.Cauchy.Create(1.0)
        built = np.array([config.built_angle] * 3 + [config.built_offset] * 3)
        robust = noise.Robust.Create(kernel, noise.Diagonal.Sigmas(built))
        on = noise.Isotropic.Sigma(3, config.wall_sigma)
        face = np.array([1.0, 0.0, 0.0, 0.0])
        for key, wall, planned in zip(self.deviations, walls, self.planned):
            plane = evidence.planes[wall.online]
            here = first @ planned
            seen = self.values.atOrientedPlane3(plane).planeCoefficients()
            away = float(seen[:3] @ here[:3, 3] + seen[3])
            self.values.insert(key, gtsam.Pose3(here @ _shift(-away)))
            self.factors.push_back(gtsam.OrientedPlane3Factor(face, on, key, plane))
            self.factors.push_back(
                gtsam.BetweenFactorPose3(self.building, key, gtsam.Pose3(planned), robust)
            )


def _estimates(problem: _Problem, values: Any) -> tuple[WallEstimate, ...]:
    """Deviation of each face and its spread, from the joint marginal with the building."""
    if not problem.walls:
        return ()
    marginals = problem.gtsam.Marginals(problem.factors, values)
    building = values.atPose3(problem.building)
    found = []
    for key, wall, planned in zip(problem.deviations, problem.walls, problem.planned):
        motion, slope = deviation(building, values.atPose3(key), planned)
        keys = problem.gtsam.KeyVector()
        keys.append(problem.building)
        keys.append(key)
        joint = marginals.jointMarginalCovariance(keys)
        spread = slope @ _stacked(joint, problem.building, key) @ slope.T
        sigma = np.sqrt(np.maximum(np.diag(spread), 0.0))
        x, y, z = wall.frame[:3, 3].tolist()
        turn = math.atan2(motion[1, 0], motion[0, 0])
        found.append(
            WallEstimate(
                wall.online,
                wall.prior,
                float(motion[0, 3]),
                float(sigma[3]),
                turn,
                float(sigma[2]),
                (x, y, z),
            )
        )
    return tuple(found)


def deviation(building: Any, frame: Any, planned: Array) -> tuple[Array, Array]:
    """The motion (4, 4) from the planned to the real place of a face, and its derivative.

    ``building`` and ``frame`` are gtsam poses in the map, ``planned`` (4, 4) the face's place seen
    from ``building``. The derivative (6, 12) is by gtsam's tangents of both, rotation first. The
    motion is ``between(building planned, frame)``: a change of ``building`` reaches it through the
    adjoint of the frame's inverse, one of ``frame`` directly.
    """
    seen = building.between(frame)
    motion = np.linalg.inv(planned) @ seen.matrix()
    return motion, np.hstack([-seen.inverse().AdjointMap(), np.eye(6)])


def _stacked(joint: Any, a: int, b: int) -> Array:
    """The joint covariance (12, 12) of a and b, in this order."""
    return np.block([[joint.at(a, a), joint.at(a, b)], [joint.at(b, a), joint.at(b, b)]])


def _anchor(walls: Sequence[Wall]) -> Array:
    """A frame (4, 4) amid the matched faces, so that the building turns about what was seen."""
    frame = np.eye(4)
    if walls:
        frame[:3, 3] = np.mean([w.frame[:3, 3] for w in walls], axis=0)
    return frame


def _shift(x: float) -> Array:
    frame = np.eye(4)
    frame[0, 3] = x
    return frame


def _moved(plane: Array, motion: Array) -> Array:
    """A plane (4,) in another frame."""
    n = motion[:3, :3] @ plane[:3]
    return np.array([*n, plane[3] - n @ motion[:3, 3]])
