"""The S-Graph as it grows: scans and odometry in, a scene graph out at any time."""

from __future__ import annotations

import bisect
import time
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
from numpy.typing import ArrayLike

from situgraph.geometry.poses import Array, matrix_to_pose, pose_to_matrix, rotation2
from situgraph.scenegraph.graph import SceneGraph, Warning
from situgraph.slam.cloud import Cleaned, clean, moved
from situgraph.slam.config import SlamConfig
from situgraph.slam.deskew import deskew
from situgraph.slam.graph import FactorGraph
from situgraph.slam.keyframes import Keyframe, due, view
from situgraph.slam.mapping import Mapper, level_pose
from situgraph.slam.motion import OdometryTrack, interpolate, relative, size, tidy
from situgraph.slam.notices import Notices
from situgraph.slam.odometry import ScanOdometry, make
from situgraph.slam.pace import Pace
from situgraph.slam.planemap import PlaneMap
from situgraph.slam.rooms import Reason, RoomBook
from situgraph.slam.scene import scene_graph
from situgraph.slam.storeys import BETWEEN, Storeys
from situgraph.slam.surroundings import Surroundings
from situgraph.slam.trajectory import Trail, trajectory

PATIENCE = 20  # scans in a row; so many that come too early are no disorder
LATE = 0.03  # s; odometry may end so long before the scan it helps to undistort


class Slam:
    """LiDAR SLAM with walls, rooms and storeys (paper section III, S-graph generation).

    Poses are those of base; the map frame is the recorded odometry's at the start, or the first
    base levelled where there is none. Gravity is z.
    """

    def __init__(
        self,
        config: SlamConfig | None = None,
        base_T_lidar: ArrayLike | None = None,
        odometry: ScanOdometry | None = None,
    ) -> None:
        """Start empty.

        Args:
            config: settings.
            base_T_lidar: pose (7,) of the LiDAR in base; none: base is the LiDAR.
            odometry: registers scans; none: the one that the settings name.
        """
        self.config = config or SlamConfig()
        self._lidar = np.eye(4) if base_T_lidar is None else pose_to_matrix(base_T_lidar)
        self._track = OdometryTrack(self.config.odometry.memory, self.config.odometry.least_memory)
        self._odometry = odometry or make(self.config.odometry)
        self.graph = FactorGraph(self.config.graph)
        self.planes = PlaneMap(self.config.map.interval_gap)
        self.storeys = Storeys(self.config.storeys)
        self.rooms = RoomBook(self.config.rooms)
        self._mapper = Mapper(self.config, self.graph, self.planes, self.storeys)
        self._mapper.on_merge = self.rooms.rename_plane
        self._surroundings = Surroundings(self.config.rooms)
        self.keyframes: list[Keyframe] = []
        self._last: tuple[float, Array] | None = None  # stamp and odometry pose of the last scan
        self._step = (np.eye(4), 1.0)  # the last motion and the seconds it took
        self._doubt = 1.0  # how much worse than usual the motion since the last keyframe is known
        self._path: list[tuple[float, int, Array]] = []
        self._trail = Trail(self.config.keyframes.trail)
        self.changes = 0  # how often a room was found, lost, or given other walls
        self._notices = Notices()
        self._pace = Pace()
        self._refused = 0  # scans in a row whose stamps were too early
        self.seconds = {"odometry": 0.0, "planes": 0.0, "graph": 0.0, "rooms": 0.0}

    def feed_odometry(self, stamp: float, pose: ArrayLike) -> None:
        """The robot's own estimate (7,) of base at ``stamp`` (s), in a frame whose z is up."""
        matrix = pose_to_matrix(pose)
        last = self._track.last
        if not np.isfinite(matrix).all():
            self._notices.add("odometry-not-finite", f"odometry at {stamp:.3f} s is not finite")
        elif last is None:
            self._track.add(stamp, matrix)
        elif stamp <= last[0]:
            self._notices.add(
                "odometry-out-of-order", f"odometry at {stamp:.3f} s is not later than the last one"
            )
        else:
            c = self.config.odometry
            step, _ = size(relative(last[1], matrix))
            if step > c.largest_speed * (stamp - last[0]) + c.jump_slack:
                self._notices.add(
                    "odometry-jump",
                    f"odometry jumps by {step:.2f} m at {stamp:.3f} s; the step is left out",
                )
                self._track.restart()
            self._track.add(stamp, matrix)

    def feed_scan(
        self, stamp: float, points: ArrayLike, times: ArrayLike | None = None
    ) -> Keyframe | None:
        """One turn of the LiDAR; returns the keyframe if it became one.

        Args:
            stamp: the time the turn ended (s).
            points: (n, 3) metres in the lidar frame, as measured.
            times: (n,) seconds relative to ``stamp``, not positive; none: nothing is deskewed.
        """
        cleaned = self._accept(stamp, points)
        if cleaned is None:
            return None
        when = self._times_of(cleaned, stamp, times)
        with self._timed("odometry"):
            motion, seconds, recorded = self._expected_motion(stamp)
            scan = moved(cleaned.points, self._lidar)
            if when is not None and len(when):
                scan = deskew(scan, when, *self._turn(stamp, when, motion, seconds))
            guess, c = self._expected_pose(stamp, motion), self.config.odometry
            reach = c.reach if recorded else c.wide_reach
            step = self._odometry.register(scan, self._lidar[:3, 3], guess, reach)
        if not step.trusted:
            g = self.config.graph
            self._doubt = max(self._doubt, g.recorded_factor if recorded else g.lost_factor)
            self._notices.add(
                "scan-not-registered",
                f"the scan at {stamp:.3f} s fits the ones before in {step.fit:.0%} of its points; "
                "the expected motion was used",
            )
        pose = tidy(step.pose)
        if self._last is not None:
            self._step = (relative(self._last[1], pose), stamp - self._last[0])
        self._last = (stamp, pose)
        keyframe = self._keyframe(stamp, scan, pose)
        last = self.keyframes[-1]
        motion = relative(last.odometry, pose)
        self._path.append((stamp, last.number, motion))
        self._trail.add(last.number, motion[:3, 3])
        return keyframe

    @property
    def pose(self) -> Array:
        """Pose (7,) of base in the map at the last scan."""
        if not self._path:
            return matrix_to_pose(np.eye(4))
        _, number, motion = self._path[-1]
        return matrix_to_pose(self.graph.pose(number) @ motion)

    def trajectory(self) -> tuple[Array, Array]:
        """Stamps (n,) and poses (n, 7) of base in the map, one a scan."""
        return trajectory(self._path, self.keyframes, self.graph)

    def places(self) -> Array:
        """Positions (n, 3) of base in the map, thinned; quick enough to be asked for often."""
        return self._trail.places(self.graph.poses([k.number for k in self.keyframes]))

    def moment(self, stamp: float) -> tuple[int, Array] | None:
        """Where base was between two scans: a keyframe's number and the motion (4x4) from it.

        None when ``stamp`` does not lie between the first keyframe and the last scan, or no scan
        came near it.
        """
        i = bisect.bisect_left(self._path, stamp, key=lambda step: step[0])
        if i == len(self._path) or (i == 0 and self._path[0][0] > stamp):
            return None
        (before, _, _), (after, number, motion) = self._path[max(i - 1, 0)], self._path[i]
        if after - before > self.config.odometry.memory:
            return None
        if before == after:
            return number, motion
        base = [self.keyframes[n].odometry @ m for _, n, m in (self._path[i - 1], self._path[i])]
        between = interpolate(base[0], base[1], (stamp - before) / (after - before))
        return number, relative(self.keyframes[number].odometry, between)

    def refresh(self) -> None:
        """Let every plane and room follow the graph, also those far from the robot."""
        numbers = list(self.planes.planes)
        for number, plane in zip(numbers, self.graph.planes("p", numbers)):
            self.planes.place(number, plane, self._mapper.pose)
        self.rooms.follow(self.planes.planes)

    def scene_graph(self) -> SceneGraph:
        """The map as it is now."""
        return scene_graph(self)

    @property
    def reasons(self) -> tuple[Reason, ...]:
        """Why free space that was seen is no room."""
        return self.rooms.reasons

    @property
    def warnings(self) -> tuple[Warning, ...]:
        """What was odd in the input, one entry a code."""
        return self._notices.all()

    def _accept(self, stamp: float, points: ArrayLike) -> Cleaned | None:
        if self._last is not None and stamp <= self._last[0]:
            self._notices.add(
                "scan-out-of-order", f"the scan at {stamp:.3f} s is not later than the last one"
            )
            self._refused += 1
            if self._refused == PATIENCE:
                self._notices.add(
                    "clock-set-back",
                    f"stamps went back from {self._last[0]:.3f} s to {stamp:.3f} s and stayed "
                    "there; scans are left out until they are later again: cut the log there",
                )
            return None
        self._refused = 0
        if np.ndim(points) != 2 or np.shape(points)[1] != 3:
            self._notices.add(
                "scan-odd", f"the scan at {stamp:.3f} s is {np.shape(points)}, not (n, 3)"
            )
            return None
        cleaned = clean(points, self.config.odometry.near, self.config.odometry.far)
        if cleaned.broken:
            self._notices.add(
                "points-not-finite",
                f"{cleaned.broken} points of the scan at {stamp:.3f} s are NaN or infinite",
            )
        if len(cleaned.points) < self.config.odometry.least_points:
            self._notices.add(
                "scan-empty",
                f"the scan at {stamp:.3f} s has {len(cleaned.points)} usable points",
            )
            return None
        gap = self._pace.gap(stamp)
        if gap is not None:
            self._notices.add("scans-missing", f"no scan for {gap:.2f} s before {stamp:.3f} s")
        return cleaned

    def _times_of(self, cleaned: Cleaned, stamp: float, times: ArrayLike | None) -> Array | None:
        """When (s before the stamp) each usable point was measured; None where that is unknown."""
        if times is None:
            return None
        when = np.asarray(times, dtype=float)
        if when.shape != cleaned.kept.shape or not np.isfinite(when).all():
            self._notices.add(
                "times-odd", f"the times of the scan at {stamp:.3f} s do not fit; not deskewed"
            )
            return None
        out: Array = when[cleaned.kept]
        return out

    def _expected_motion(self, stamp: float) -> tuple[Array, float, bool]:
        """Motion (4x4) since the last scan, the seconds since, and whether it was recorded.

        What was not recorded goes on as before.
        """
        if self._last is None:
            return np.eye(4), 0.0, True
        seconds = stamp - self._last[0]
        recorded = self._track.between(self._last[0], stamp, self.config.odometry.slack)
        if recorded is not None:
            return recorded, seconds, True
        motion, period = self._step
        return interpolate(np.eye(4), motion, seconds / period), seconds, False

    def _turn(
        self, stamp: float, when: Array, motion: Array, seconds: float
    ) -> tuple[Array, float]:
        """Motion (4x4) while the LiDAR turned and the seconds it took.

        As recorded; else a share of the motion since the last scan, which may be long ago.
        """
        turn = -float(when.min())
        recorded = self._track.between(stamp - turn, stamp, LATE) if turn > 0.0 else None
        return (motion, seconds) if recorded is None else (recorded, turn)

    def _expected_pose(self, stamp: float, motion: Array) -> Array:
        if self._last is not None:
            out: Array = self._last[1] @ motion
            return out
        first = self._track.at(stamp, self.config.odometry.slack)
        return np.eye(4) if first is None else first

    def _keyframe(self, stamp: float, scan: Array, pose: Array) -> Keyframe | None:
        motion = relative(self.keyframes[-1].odometry, pose) if self.keyframes else None
        if motion is not None and not due(motion, self.config.keyframes):
            return None
        guess = pose if motion is None else self.graph.pose(self.keyframes[-1].number) @ motion
        with self._timed("planes"):
            unturn = np.eye(3)
            unturn[:2, :2] = rotation2(-float(level_pose(guess)[2]))
            attitude = unturn @ guess[:3, :3]
            seen = view(scan, attitude, self._lidar[:3, 3], -self.storeys.standing, self.config)
        floor = None if seen.floor is None else seen.floor.height
        storey = self.storeys.at(float(guess[2, 3]), floor)
        keyframe = Keyframe(len(self.keyframes), stamp, pose, seen, storey)
        self.keyframes.append(keyframe)
        with self._timed("graph"):
            self._mapper.add(keyframe, guess, motion, self._doubt)
        self._doubt = 1.0
        if storey != BETWEEN:
            with self._timed("rooms"):
                self._find_rooms(keyframe)
        return keyframe

    def _find_rooms(self, keyframe: Keyframe) -> None:
        self._surroundings.add(keyframe, self._mapper.pose(keyframe.number))
        place = self._mapper.pose(keyframe.number)[:2, 3]
        near = self._surroundings.near(keyframe.storey, place, self._mapper.pose)
        walls = [p for p in self.planes.on(keyframe.storey) if p.certain(self.config.map)]
        changed = self.rooms.update(keyframe.storey, place, near.outlines, near.places, walls)
        self.changes += changed

    @contextmanager
    def _timed(self, stage: str) -> Iterator[None]:
        start = time.perf_counter()
        try:
            yield
        finally:
            self.seconds[stage] += time.perf_counter() - start
