"""The S-Graph as it grows: scans and odometry in, a scene graph out at any time."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from situgraph.geometry.poses import Array, matrix_to_pose, pose_to_matrix, rotation2
from situgraph.scenegraph.graph import SceneGraph, Warning
from situgraph.slam import odometry
from situgraph.slam.cloud import Cleaned, clean, moved
from situgraph.slam.config import SlamConfig
from situgraph.slam.deskew import deskew
from situgraph.slam.graph import FactorGraph
from situgraph.slam.keyframes import Keyframe, due, view
from situgraph.slam.mapping import Mapper, level_pose
from situgraph.slam.motion import OdometryTrack, interpolate, relative, tidy
from situgraph.slam.notices import Notices
from situgraph.slam.planemap import PlaneMap
from situgraph.slam.scene import scene_graph


class Slam:
    """LiDAR SLAM with walls, rooms and storeys (paper section III, S-graph generation).

    Poses are those of base; the map frame is the recorded odometry's at the start, or the first
    base levelled where there is none. Gravity is z.
    """

    def __init__(
        self, config: SlamConfig | None = None, base_T_lidar: ArrayLike | None = None
    ) -> None:
        """Start empty.

        Args:
            config: settings.
            base_T_lidar: pose (7,) of the LiDAR in base; none: base is the LiDAR.
        """
        self.config = config or SlamConfig()
        self._lidar = np.eye(4) if base_T_lidar is None else pose_to_matrix(base_T_lidar)
        self._track = OdometryTrack(self.config.odometry.memory)
        self._odometry = odometry.make(self.config.odometry)
        self.graph = FactorGraph(self.config.graph)
        self.map = PlaneMap(self.config.map.interval_gap)
        self._mapper = Mapper(self.config, self.graph, self.map)
        self.keyframes: list[Keyframe] = []
        self._last: tuple[float, Array] | None = None  # stamp and odometry pose of the last scan
        self._step = (np.eye(4), 1.0)  # the last motion and the seconds it took
        self._trusted = True
        self._path: list[tuple[float, int, Array]] = []
        self._notices = Notices()

    def feed_odometry(self, stamp: float, pose: ArrayLike) -> None:
        """The robot's own estimate (7,) of base at ``stamp`` (s), in a frame whose z is up."""
        last = self._track.last
        if last is not None and stamp <= last[0]:
            self._notices.add(
                "odometry-out-of-order", f"odometry at {stamp:.3f} s is not later than the last one"
            )
            return
        matrix = pose_to_matrix(pose)
        if not np.isfinite(matrix).all():
            self._notices.add("odometry-not-finite", f"odometry at {stamp:.3f} s is not finite")
            return
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
        motion, seconds = self._expected_motion(stamp)
        scan = moved(cleaned.points, self._lidar)
        if times is not None:
            scan = deskew(scan, np.asarray(times)[cleaned.kept], motion, seconds)
        step = self._odometry.register(scan, self._expected_pose(stamp, motion))
        if not step.trusted:
            self._trusted = False
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
        self._path.append((stamp, last.number, relative(last.odometry, pose)))
        return keyframe

    def trajectory(self) -> tuple[Array, Array]:
        """Stamps (n,) and poses (n, 7) of base in the map, one a scan."""
        poses = self.graph.poses([k.number for k in self.keyframes])
        stamps = np.array([stamp for stamp, _, _ in self._path])
        matrices = np.array([poses[k] @ m for _, k, m in self._path]).reshape(-1, 4, 4)
        return stamps, matrix_to_pose(matrices) if len(matrices) else np.empty((0, 7))

    def scene_graph(self) -> SceneGraph:
        """The map as it is now."""
        return scene_graph(self.keyframes, self.graph, self.map, self.warnings)

    @property
    def warnings(self) -> tuple[Warning, ...]:
        """What was odd in the input, one entry a code."""
        return self._notices.all()

    def _accept(self, stamp: float, points: ArrayLike) -> Cleaned | None:
        if self._last is not None and stamp <= self._last[0]:
            self._notices.add(
                "scan-out-of-order", f"the scan at {stamp:.3f} s is not later than the last one"
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
        return cleaned

    def _expected_motion(self, stamp: float) -> tuple[Array, float]:
        """Motion (4x4) since the last scan and the seconds since: recorded, else as before."""
        if self._last is None:
            return np.eye(4), 0.0
        seconds = stamp - self._last[0]
        recorded = self._track.between(self._last[0], stamp, self.config.odometry.slack)
        if recorded is not None:
            return recorded, seconds
        motion, period = self._step
        return interpolate(np.eye(4), motion, seconds / period), seconds

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
        unturn = np.eye(3)
        unturn[:2, :2] = rotation2(-float(level_pose(guess)[2]))
        c = self.config
        seen = view(scan, unturn @ guess[:3, :3], self._lidar[:3, 3], c.planes, c.keyframes.voxel)
        keyframe = Keyframe(len(self.keyframes), stamp, pose, seen)
        self.keyframes.append(keyframe)
        self._mapper.add(keyframe, guess, motion, self._trusted)
        self._trusted = True
        return keyframe
