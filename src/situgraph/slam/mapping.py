"""A keyframe enters the map: aligned, tied by factors, its walls associated, duplicates merged."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from situgraph.geometry.poses import Array, rotation2
from situgraph.slam.association import Association, associate, one_wall
from situgraph.slam.config import SlamConfig
from situgraph.slam.graph import FactorGraph, Sight
from situgraph.slam.keyframes import Keyframe, View
from situgraph.slam.motion import size
from situgraph.slam.planemap import MapPlane, PlaneMap
from situgraph.slam.sightings import Sighting
from situgraph.slam.storeys import BETWEEN, Storeys
from situgraph.slam.structure import Structure


class Seen(NamedTuple):
    """A plane that a keyframe saw: number, ends (2, 3) of the piece in base, heights (m)."""

    plane: int
    ends: Array
    heights: tuple[float, float]


class Mapper:
    """Grows the plane map and the factor graph, keyframe by keyframe."""

    def __init__(
        self, config: SlamConfig, graph: FactorGraph, planes: PlaneMap, storeys: Storeys
    ) -> None:
        """Work on ``graph``, ``planes`` and ``storeys``."""
        self._config = config
        self._graph = graph
        self._planes = planes
        self._storeys = storeys
        self._structure = Structure(config.structure, graph)
        self._grounds: dict[int, int] = {}  # the variable of each storey's ground
        self._next_ground = 0
        self._standing = 0.0  # base over the floor when the grounds were laid
        self._poses: dict[int, Array] = {}
        self.on_merge: Callable[[int, int], None] = lambda keep, drop: None

    def add(self, keyframe: Keyframe, guess: Array, motion: Array | None, doubt: float) -> None:
        """Take in a keyframe.

        ``guess`` is its expected pose (4x4) in the map, ``motion`` the measured one since the
        keyframe before (None for the first), ``doubt`` how many times worse than usual it is known.
        """
        view, storey = keyframe.view, keyframe.storey
        known = self._planes.on(storey)
        paired = associate(view.sightings, level_pose(guess), known, self._config.map)
        pose = base_pose(level_pose(guess) + paired.correction, float(guess[2, 3]), view)
        self._tie(keyframe, pose, motion, doubt)
        seen: list[Seen] = []
        if storey != BETWEEN:
            self._see_floor(keyframe, pose)
            seen = self._see_walls(keyframe, pose, paired)
        self._graph.update()
        self._follow(keyframe, seen)

    def _tie(self, keyframe: Keyframe, pose: Array, motion: Array | None, doubt: float) -> None:
        number, g = keyframe.number, self._config.graph
        if motion is None:
            self._graph.start(number, pose)
        else:
            length, _ = size(motion)
            shift = g.motion_position + g.motion_share * length
            sigmas = np.array([g.motion_angle] * 3 + [shift] * 3)
            self._graph.add_pose(("x", number), pose)
            self._graph.motion(number - 1, number, motion, sigmas * doubt)
        self._graph.upright(number, keyframe.view.up, keyframe.view.tilt_sigma)

    def _see_floor(self, keyframe: Keyframe, pose: Array) -> None:
        view, c = keyframe.view, self._config.planes
        if not self._storeys.settled:
            return
        self._relay()
        storey = self._storeys.storeys[keyframe.storey]
        height = np.inf if view.floor is None else float(pose[2, 3]) + view.floor.height
        if view.floor is None or abs(height - storey.elevation) > self._config.storeys.floor_slack:
            self._stand(keyframe, pose)
            return
        if storey.number not in self._grounds:
            self._grounds[storey.number], self._next_ground = (
                self._next_ground,
                self._next_ground + 1,
            )
            ground = ("g", self._grounds[storey.number])
            self._graph.add_plane(ground, np.array([0.0, 0.0, 1.0, -height]))
        measured = np.array([*view.up, -view.floor.height])
        self._graph.see(
            ("g", self._grounds[storey.number]),
            Sight(("x", keyframe.number), measured, (c.floor_tilt, c.floor_sigma)),
        )

    def _relay(self) -> None:
        """Start the grounds anew when what was taken for the floor proves to lie above it."""
        sunk = self._storeys.standing - self._standing
        if abs(sunk) < self._config.storeys.floor_slack:
            return
        for storey, number in self._grounds.items():
            self._graph.forget(("g", number))
            self._storeys.storeys[storey].elevation -= sunk
        self._grounds.clear()
        self._standing = self._storeys.standing

    def _stand(self, keyframe: Keyframe, pose: Array) -> None:
        """Where no floor is seen, base is as high over it as usual, unless it is climbing."""
        c, standing = self._config.storeys, self._storeys.standing
        foot = float(pose[2, 3]) - standing
        climbing = abs(foot - self._storeys.storeys[keyframe.storey].elevation) > c.standing_slack
        if climbing or keyframe.storey not in self._grounds:
            return
        measured = np.array([*keyframe.view.up, standing])
        sight = Sight(("x", keyframe.number), measured, (c.standing_tilt, c.standing_sigma))
        self._graph.see(("g", self._grounds[keyframe.storey]), sight)

    def _see_walls(self, keyframe: Keyframe, pose: Array, paired: Association) -> list[Seen]:
        seen: list[Seen] = []
        view = keyframe.view
        numbers = self._with_new_planes(keyframe, pose, paired)
        for piece, number in zip(view.sightings, numbers):
            if number is None:
                continue
            normal = view.level.T @ np.array([*piece.normal, 0.0])
            turn, shift = (float(s) for s in np.sqrt(np.diag(piece.covariance)))
            measured = np.array([*normal, piece.offset])
            self._graph.see(("p", number), Sight(("x", keyframe.number), measured, (turn, shift)))
            ends = np.column_stack([piece.ends, np.zeros(2)]) @ view.level
            seen.append(Seen(number, ends, (piece.high, piece.visible)))
        return seen

    def _with_new_planes(
        self, keyframe: Keyframe, pose: Array, paired: Association
    ) -> list[int | None]:
        """The plane of each piece; walls that are new and long enough, doors apart, start one."""
        view, numbers = keyframe.view, list(paired.plane)
        new = [i for i, number in enumerate(numbers) if number is None]
        pieces = [view.sightings[i] for i in new]
        for wall in one_wall(pieces, self._config.map):
            if sum(pieces[k].length for k in wall) < self._config.map.new_length:
                continue
            normal = view.level.T @ np.array([*pieces[wall[0]].normal, 0.0])
            number = self._start_plane(keyframe.storey, pose, normal, pieces[wall[0]])
            for k in wall:
                numbers[new[k]] = number
        return numbers

    def _start_plane(self, storey: int, pose: Array, normal: Array, piece: Sighting) -> int:
        n = pose[:3, :3] @ normal
        plane = self._planes.new(storey, np.array([*n, piece.offset - n @ pose[:3, 3]]))
        self._graph.add_plane(("p", plane.number), plane.plane)
        return plane.number

    def _follow(self, keyframe: Keyframe, seen: list[Seen]) -> None:
        """The map takes over what the graph found; what proved to be one plane is merged."""
        self._poses = {}
        for number, ends, heights in seen:
            self._planes.widen(number, keyframe.number, ends, heights, self.pose(keyframe.number))
        touched = sorted({s.plane for s in seen})
        for number, plane in zip(touched, self._graph.planes("p", touched)):
            self._planes.place(number, plane, self.pose)
        if keyframe.storey in self._grounds:
            ground = self._graph.planes("g", [self._grounds[keyframe.storey]])[0]
            self._storeys.storeys[keyframe.storey].elevation = -float(ground[3] / ground[2])
        self._merge_doubles(keyframe.storey, touched)
        known = self._planes.on(keyframe.storey)
        self._structure.tie([p for p in known if p.number in set(touched)], known)

    def _merge_doubles(self, storey: int, touched: list[int]) -> None:
        for number in touched:
            plane = self._planes.planes.get(number)
            if plane is None:
                continue
            for other in self._planes.on(storey):
                if other.number != number and _same(plane, other, self._config):
                    keep, drop = sorted((number, other.number))
                    self._structure.forget(drop)
                    self._graph.merge_planes(keep, drop)
                    self._planes.merge(keep, drop, self.pose)
                    self.on_merge(keep, drop)
                    break

    def pose(self, number: int) -> Array:
        """Pose (4x4) of a keyframe after the last update."""
        if number not in self._poses:
            self._poses[number] = self._graph.poses([number])[0]
        return self._poses[number]


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


def _same(plane: MapPlane, other: MapPlane, config: SlamConfig) -> bool:
    """Whether two planes of the map are one: same direction, same place, never seen apart."""
    c = config.map
    if plane.seen_by & other.seen_by or float(plane.normal @ other.normal) < math.cos(
        c.merge_angle
    ):
        return False
    ends = other.ends()
    low, high = sorted((ends @ plane.tangent).tolist())
    if plane.distance_along(low, high) > 0.0:
        return False
    low = max(low, plane.intervals[0][0])
    high = min(high, plane.intervals[-1][1])
    middle = plane.point((low + high) / 2)
    return abs(float(other.normal @ middle) + other.offset) < c.merge_offset
