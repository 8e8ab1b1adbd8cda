"""What buildings have in common, as soft factors: walls have two faces, wings have axes.

A wall is a frame between its two faces: they are parallel and a thickness apart. The axes of a
wing are a frame too: each of its walls is parallel or perpendicular to them. Both are written with
the plane factor that keyframes use, seen from such a frame; what they do not determine (where along
the wall, how high) is held by a wide prior.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from situgraph.geometry.poses import Array, rotation2, wrap_angle
from situgraph.slam.config import StructureConfig
from situgraph.slam.graph import FactorGraph, Sight
from situgraph.slam.planemap import MapPlane

FREE = 1e3  # m or rad: no information


class Structure:
    """Ties planes of the map to each other, each pair and each axis once."""

    def __init__(self, config: StructureConfig, graph: FactorGraph) -> None:
        """Nothing is tied yet."""
        self._config = config
        self._graph = graph
        self._axes: list[float] = []  # heading of each wing's axes
        self._on_axes: set[int] = set()
        self.walls: dict[tuple[int, int], int] = {}
        self._walled: set[int] = set()
        self._next = 0  # a number is never used twice: the graph may not have let go of it yet

    def tie(self, touched: Sequence[MapPlane], planes: Sequence[MapPlane]) -> None:
        """Add the factors that planes just seen now allow."""
        for plane in touched:
            if plane.sightings < self._config.least_sightings:
                continue
            if plane.number not in self._on_axes and plane.length >= self._config.least_length:
                self._tie_to_axes(plane)
            if plane.number not in self._walled:
                self._tie_to_back(plane, planes)

    def forget(self, plane: int) -> None:
        """A plane was merged into another one: it can be tied no more."""
        self._on_axes.discard(plane)
        self._walled.discard(plane)
        for pair in [p for p in self.walls if plane in p]:
            self._walled -= set(pair)
            self._graph.forget(("w", self.walls.pop(pair)))

    def _tie_to_axes(self, plane: MapPlane) -> None:
        c = self._config
        heading = math.atan2(plane.normal[1], plane.normal[0])
        quarter = math.pi / 2
        offs = [float(wrap_angle((heading - a) * 4)) / 4 for a in self._axes]
        number = min(range(len(offs)), key=lambda i: abs(offs[i]), default=None)
        if number is None or abs(offs[number]) > c.other_axes:
            if plane.length < c.axes_length:
                return
            number = len(self._axes)
            self._axes.append(heading)
            pose = _frame(heading, np.zeros(3))
            self._graph.add_pose(("a", number), pose)
            sigmas = np.array([c.tilt, c.tilt, FREE, 0.01, 0.01, 0.01])
            self._graph.prior(("a", number), pose, sigmas)
        elif abs(offs[number]) > c.same_axes:
            return
        turns = round((heading - self._axes[number]) / quarter)
        direction = [math.cos(turns * quarter), math.sin(turns * quarter), 0.0]
        sight = Sight(("a", number), np.array([*direction, 0.0]), (c.angle, FREE))
        self._graph.see(("p", plane.number), sight)
        self._on_axes.add(plane.number)

    def _tie_to_back(self, plane: MapPlane, planes: Sequence[MapPlane]) -> None:
        c = self._config
        for other in planes:
            if other.sightings < c.least_sightings or other.number in self._walled:
                continue
            thickness = _thickness(plane, other, c)
            if thickness is None:
                continue
            number, self._next = self._next, self._next + 1
            low, high = plane.intervals[0][0], plane.intervals[-1][1]
            middle = plane.point((low + high) / 2) - thickness / 2 * plane.normal
            heading = math.atan2(plane.normal[1], plane.normal[0])
            pose = _frame(heading, np.array([*middle, 0.0]))
            self._graph.add_pose(("w", number), pose)
            self._hold(number, pose)
            for face, sign in ((plane, 1.0), (other, -1.0)):
                seen = np.array([sign, 0.0, 0.0, -thickness / 2])
                self._graph.see(
                    ("p", face.number), Sight(("w", number), seen, (c.angle, c.thickness_sigma))
                )
            self.walls[(plane.number, other.number)] = number
            self._walled |= {plane.number, other.number}
            return

    def _hold(self, number: int, pose: Array) -> None:
        sigmas = np.array([0.1, FREE, FREE, FREE, 1.0, 1.0])
        self._graph.prior(("w", number), pose, sigmas)


def _frame(heading: float, place: Array) -> Array:
    pose = np.eye(4)
    pose[:2, :2] = rotation2(heading)
    pose[:3, 3] = place
    return pose


def _thickness(plane: MapPlane, other: MapPlane, config: StructureConfig) -> float | None:
    """Metres from one face to the other, None when they are not the two faces of a wall."""
    if float(plane.normal @ other.normal) > -math.cos(config.same_axes):
        return None
    ends = other.ends()
    behind = -(ends @ plane.normal + plane.offset)
    along = ends @ plane.tangent
    low = max(float(along.min()), plane.intervals[0][0])
    high = min(float(along.max()), plane.intervals[-1][1])
    thickness = float(behind.mean())
    if high - low < config.overlap or not config.thinnest < thickness < config.thickest:
        return None
    return thickness
