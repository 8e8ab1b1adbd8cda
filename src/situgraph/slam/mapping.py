"""A keyframe enters the map: aligned, tied by factors, its walls associated, duplicates merged."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from situgraph.geometry.poses import Array, rotation2
from situgraph.slam.association import Association, associate
from situgraph.slam.config import SlamConfig
from situgraph.slam.graph import FactorGraph
from situgraph.slam.keyframes import Keyframe, View
from situgraph.slam.motion import size
from situgraph.slam.planemap import PlaneMap
from situgraph.slam.sightings import Sighting


class Seen(NamedTuple):
    """A plane that a keyframe saw: its number and the ends (2, 3) of the piece, in base."""

    plane: int
    ends: Array


class Mapper:
    """Grows the plane map and the factor graph, keyframe by keyframe."""

    def __init__(self, config: SlamConfig, graph: FactorGraph, planes: PlaneMap) -> None:
        """Work on ``graph`` and ``planes``."""
        self._config = config
        self._graph = graph
        self._planes = planes
        self._grounds: set[int] = set()

    def add(self, keyframe: Keyframe, guess: Array, motion: Array | None, trusted: bool) -> None:
        """Take in a keyframe.

        ``guess`` is its expected pose (4x4) in the map, ``motion`` the measured one since the
        keyframe before (None for the first), ``trusted`` whether scans were registered between.
        """
        view = keyframe.view
        level = level_pose(guess)
        known = self._planes.on(keyframe.storey)
        paired = associate(view.sightings, level, known, self._config.map)
        pose = base_pose(level + paired.correction, float(guess[2, 3]), view)
        self._tie(keyframe, pose, motion, trusted)
        self._see_floor(keyframe, pose)
        seen = self._see_walls(keyframe, pose, paired)
        self._graph.update()
        self._follow(keyframe, seen)

    def _tie(self, keyframe: Keyframe, pose: Array, motion: Array | None, trusted: bool) -> None:
        number, g = keyframe.number, self._config.graph
        if motion is None:
            self._graph.start(number, pose)
        else:
            length, _ = size(motion)
            shift = g.motion_position + g.motion_share * length
            sigmas = np.array([g.motion_angle] * 3 + [shift] * 3)
            self._graph.follow(number, pose)
            self._graph.motion(
                number - 1, number, motion, sigmas if trusted else sigmas * g.lost_factor
            )
        self._graph.upright(number, keyframe.view.up, keyframe.view.tilt_sigma)

    def _see_floor(self, keyframe: Keyframe, pose: Array) -> None:
        view, storey = keyframe.view, keyframe.storey
        if view.floor is None:
            return
        if storey not in self._grounds:
            self._grounds.add(storey)
            height = float(pose[2, 3]) + view.floor.height
            self._graph.add_plane("g", storey, np.array([0.0, 0.0, 1.0, -height]))
        c = self._config.planes
        measured = np.array([*view.up, -view.floor.height])
        self._graph.see(
            keyframe.number, "g", storey, measured, np.array([c.floor_tilt, c.floor_sigma])
        )

    def _see_walls(self, keyframe: Keyframe, pose: Array, paired: Association) -> list[Seen]:
        seen: list[Seen] = []
        view = keyframe.view
        for piece, number in zip(view.sightings, paired.plane):
            normal = view.level.T @ np.array([*piece.normal, 0.0])
            if number is None:
                if piece.length < self._config.map.new_length:
                    continue
                number = self._start_plane(keyframe.storey, pose, normal, piece)
            sigmas = np.sqrt(np.diag(piece.covariance))
            measured = np.array([*normal, piece.offset])
            self._graph.see(keyframe.number, "p", number, measured, sigmas)
            ends = np.column_stack([piece.ends, np.zeros(2)]) @ view.level
            seen.append(Seen(number, ends))
        return seen

    def _start_plane(self, storey: int, pose: Array, normal: Array, piece: Sighting) -> int:
        n = pose[:3, :3] @ normal
        plane = self._planes.new(storey, np.array([*n, piece.offset - n @ pose[:3, 3]]))
        self._graph.add_plane("p", plane.number, plane.plane)
        return plane.number

    def _follow(self, keyframe: Keyframe, seen: list[Seen]) -> None:
        """The map takes over what the graph found."""
        pose = self._graph.pose(keyframe.number)
        for number, ends in seen:
            self._planes.widen(number, keyframe.number, ends, pose)
        touched = sorted({s.plane for s in seen})
        for number, plane in zip(touched, self._graph.planes("p", touched)):
            self._planes.place(number, plane, self._graph.pose)


def level_pose(pose: Array) -> Array:
    """x, y, yaw (3,) of a 4x4 pose."""
    return np.array([pose[0, 3], pose[1, 3], math.atan2(pose[1, 0], pose[0, 0])])


def base_pose(level: Array, height: float, view: View) -> Array:
    """Pose (4x4) of base whose level frame stands at ``level`` (3,) x, y, yaw."""
    turn = np.eye(3)
    turn[:2, :2] = rotation2(float(level[2]))
    pose = np.eye(4)
    pose[:3, :3] = turn @ view.level
    pose[:3, 3] = level[0], level[1], height
    return pose
