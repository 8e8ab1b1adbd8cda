"""The factors of both graphs together, and where the estimate starts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from situgraph.coupling.config import CouplingConfig
from situgraph.coupling.evidence import Evidence
from situgraph.coupling.residuals import Scales
from situgraph.coupling.walls import Wall, grouped
from situgraph.geometry.poses import Array, Placement

FREE = 1e3  # m or rad: no information


class Problem:
    """The factors of both graphs, and where the estimate starts.

    Attributes:
        evidence: the factors of the S-Graph.
        between: the factors that hold each wall and face in its place.
        factors: all of them.
        values: the start.
    """

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
        self.evidence, self.between = evidence, list[Any]()
        self.known = [(wall, evidence.planes[wall.online]) for wall in walls]
        self._count, self._slots = 0, list[int]()
        self.anchor = anchor
        self.factors = gtsam.NonlinearFactorGraph(evidence.factors)
        self.values = gtsam.Values(evidence.values)
        self.building = gtsam.symbol("B", 0)
        first = np.linalg.inv(placement.matrix()) @ anchor
        self.values.insert(self.building, gtsam.Pose3(first))
        level = np.array(
            [config.level_sigma, config.level_sigma, FREE, FREE, FREE, config.height_sigma]
        )
        self.factors.push_back(
            gtsam.PriorFactorPose3(self.building, gtsam.Pose3(first), noise.Diagonal.Sigmas(level))
        )
        self._robust = self._built(Scales(1.0, config.built_offset, config.built_angle))
        self._on = noise.Isotropic.Sigma(3, config.wall_sigma)
        self._first, self._from_anchor = first, _inverse(anchor)
        for number, wall in enumerate(grouped(walls)):
            if len(wall) == 1:
                self._face(self.building, self._from_anchor, evidence, wall[0])
                continue
            key, planned = gtsam.symbol("W", number), _midst(wall)
            place, x = self._from_anchor @ planned, planned[:3, 0]
            shifts = [self._shift(evidence, f) * float(f.frame[:3, 0] @ x) for f in wall]
            moved = _along_x(float(np.median(shifts)))
            self._frame(key, first @ place @ moved, self.building, place)
            for face in wall:
                self._face(key, _inverse(planned), evidence, face)

    def weighed(self, scales: Scales) -> Any:
        """The factors with the plan weighed against the map as ``scales`` say.

        Those of the map keep what they state: standard deviations by these factors are in units of
        ``scales.map``.
        """
        gtsam = self.gtsam
        factors, model = gtsam.NonlinearFactorGraph(self.factors), self._built(scales)
        for slot, factor in zip(self._slots, self.between):
            a, b = factor.keys()
            factors.replace(slot, gtsam.BetweenFactorPose3(a, b, factor.measured(), model))
        return factors

    def _built(self, scales: Scales) -> Any:
        """The noise of how walls are built, in units of the map's."""
        noise = self.gtsam.noiseModel
        sigmas = np.array([scales.angle] * 3 + [scales.offset] * 3) / scales.map
        kernel = noise.mEstimator.Cauchy.Create(scales.map)
        return noise.Robust.Create(kernel, noise.Diagonal.Sigmas(sigmas))

    def _shift(self, evidence: Evidence, face: Wall) -> float:
        """How far (m) a face lies from its plan by the first guess, along its normal."""
        here = self._first @ self._from_anchor @ face.frame
        seen = self.values.atOrientedPlane3(evidence.planes[face.online]).planeCoefficients()
        return -float(seen[:3] @ here[:3, 3] + seen[3])

    def _face(self, parent: int, parent_T_building: Array, evidence: Evidence, face: Wall) -> None:
        """A face on ``parent``."""
        gtsam = self.gtsam
        key = gtsam.symbol("D", self._count)
        self._count += 1
        guess = self._first @ self._from_anchor @ face.frame
        self._frame(
            key,
            guess @ _along_x(self._shift(evidence, face)),
            parent,
            parent_T_building @ face.frame,
        )
        seen = np.array([1.0, 0.0, 0.0, 0.0])
        plane = evidence.planes[face.online]
        self.factors.push_back(gtsam.OrientedPlane3Factor(seen, self._on, key, plane))

    def _frame(self, key: int, guess: Array, parent: int, planned: Array) -> None:
        """A deviation frame: where it was planned, seen from its parent."""
        gtsam = self.gtsam
        self.values.insert(key, gtsam.Pose3(guess))
        between = gtsam.BetweenFactorPose3(parent, key, gtsam.Pose3(planned), self._robust)
        self._slots.append(self.factors.size())
        self.between.append(between)
        self.factors.push_back(between)


def anchor_of(walls: Sequence[Wall]) -> Array:
    """A frame (4, 4) amid the matched faces, so that the building turns about what was seen."""
    frame = np.eye(4)
    if walls:
        frame[:3, 3] = np.mean([w.frame[:3, 3] for w in walls], axis=0)
    return frame


def _midst(wall: Sequence[Wall]) -> Array:
    """The frame (4, 4) of a wall: turned as its first face's, amid all of them."""
    frame = wall[0].frame.copy()
    frame[:3, 3] = np.mean([face.frame[:3, 3] for face in wall], axis=0)
    return frame


def _along_x(shift: float) -> Array:
    frame = np.eye(4)
    frame[0, 3] = shift
    return frame


def _inverse(frame: Array) -> Array:
    return np.asarray(np.linalg.inv(frame), dtype=float)
