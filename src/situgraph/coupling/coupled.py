"""A-Graph and S-Graph in one factor graph (paper section III, 'Graph merging', made robust).

To the factors of the S-Graph come the pose of the building in the map and, for each matched wall,
the pose of a deviation frame, which stands where the plan puts it, under a Cauchy kernel: most
walls are where they were planned, and one that is not tells so without dragging the others along.
Each face of a wall has a frame of its own on that of the wall, under the same kernel, and lies in
it. Two faces that moved together are one witness, not two; one that moved alone leaves the other.
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
from situgraph.coupling.problem import Problem, anchor_of
from situgraph.coupling.residuals import scales
from situgraph.coupling.start import settled
from situgraph.coupling.walls import Wall, grouped
from situgraph.geometry.poses import Array, Placement

STEP = 1e-6  # m or rad, of differences


@dataclass(frozen=True)
class WallEstimate:
    """How a face stands against its plan.

    ``offset`` (m) is positive along the planned inward normal, ``tilt`` (rad) its turn in the plan;
    each with its standard deviation (docs/coupling.md says of what). ``place`` (3,) is where on the
    planned face, building frame.
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
        self,
        problem: Problem,
        values: Any,
        anchor: Array,
        config: CouplingConfig,
        start: float,
    ) -> None:
        """Read the solution ``values``; ``start`` is when the work began."""
        self._problem, self._values, self._config = problem, values, config
        evidence = problem.evidence
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
        return _estimates(self._problem, self._values, self._config)

    @cached_property
    def rms(self) -> float:
        """Of the offsets (m) of the matched faces that are where they were planned."""
        near = [w.offset for w in self.walls if abs(w.offset) <= self._config.told_offset]
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
    anchor = anchor_of(known)
    seen = {
        w.online: evidence.values.atOrientedPlane3(evidence.planes[w.online]).planeCoefficients()
        for w in known
    }
    placement = settled(grouped(known), seen, placement, config.reading_apart)
    problem = Problem(gtsam, evidence, known, placement, anchor, config)
    parameters = gtsam.LevenbergMarquardtParams()
    parameters.setMaxIterations(config.max_iterations)
    parameters.setRelativeErrorTol(1e-7)
    values = gtsam.LevenbergMarquardtOptimizer(
        problem.factors, problem.values, parameters
    ).optimize()
    return Coupled(problem, values, anchor, config, start)


def _estimates(problem: Problem, values: Any, config: CouplingConfig) -> tuple[WallEstimate, ...]:
    """Deviation of each face and its spread, from the joint marginal with the building."""
    if not problem.known:
        return ()
    gtsam = problem.gtsam
    seen = scales(problem, values, config)
    marginals = gtsam.Marginals(problem.weighed(seen), values)
    building = values.atPose3(problem.building)
    found = []
    for wall, key in problem.known:
        planned = np.linalg.inv(problem.anchor) @ wall.frame
        (offset, tilt), slope = deviation(building, values.atOrientedPlane3(key), planned)
        keys = gtsam.KeyVector()
        keys.append(problem.building)
        keys.append(key)
        joint = marginals.jointMarginalCovariance(keys)
        spread = slope @ _stacked(joint, problem.building, key) @ slope.T
        variance = seen.map**2 * np.maximum(np.diag(spread), 0.0)
        sigma = np.sqrt(variance + _beyond(wall, config))
        x, y, z = wall.frame[:3, 3].tolist()
        found.append(
            WallEstimate(
                wall.online,
                wall.prior,
                offset,
                float(sigma[0]),
                tilt,
                float(sigma[1]),
                (x, y, z),
            )
        )
    return tuple(found)


def _beyond(wall: Wall, config: CouplingConfig) -> Array:
    """Variances (2,) of offset and turn that no number of sightings makes smaller.

    The plan is rounded, and the fit of a line is off by about as much at one end as at the other.
    """
    offset = config.plan_digit**2 / 12.0 + config.fit_bias**2
    return np.array([offset, 12.0 * config.fit_bias**2 / wall.length**2])


def deviation(building: Any, plane: Any, planned: Array) -> tuple[tuple[float, float], Array]:
    """Offset (m) and turn in the plan (rad) of a face against its plan, and their derivative.

    Args:
        building: pose of the building in the map (gtsam).
        plane: the face in the map (gtsam).
        planned: (4, 4) frame on the planned face seen from ``building``, x along its normal.

    Returns:
        The offset at the frame's origin, positive along x; and the derivative (2, 9) by gtsam's
        tangents of ``building`` (6) and ``plane`` (3), by central differences.
    """
    slope = np.empty((2, 9))
    for k in range(9):
        ends = []
        for sign in (STEP, -STEP):
            change = np.zeros(9)
            change[k] = sign
            moved = building.retract(change[:6]), plane.retract(change[6:])
            ends.append(np.array(_offset_and_turn(*moved, planned)))
        slope[:, k] = (ends[0] - ends[1]) / (2.0 * STEP)
    return _offset_and_turn(building, plane, planned), slope


def _offset_and_turn(building: Any, plane: Any, planned: Array) -> tuple[float, float]:
    frame = building.matrix() @ planned
    n = plane.planeCoefficients()
    normal = frame[:3, :3].T @ n[:3]
    offset = -(float(n[:3] @ frame[:3, 3]) + float(n[3])) / float(normal[0])
    return offset, math.atan2(float(normal[1]), float(normal[0]))


def _stacked(joint: Any, a: int, b: int) -> Array:
    """The joint covariance of a and b, in this order."""
    return np.block([[joint.at(a, a), joint.at(a, b)], [joint.at(b, a), joint.at(b, b)]])


def _moved(plane: Array, motion: Array) -> Array:
    """A plane (4,) in another frame."""
    n = motion[:3, :3] @ plane[:3]
    return np.array([*n, plane[3] - n @ motion[:3, 3]])
