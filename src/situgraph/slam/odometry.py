"""Motion from scan to scan: the protocol and three ways to do it.

An odometry keeps its own frame, in which its poses are smooth but drift; the factor graph uses
only motions between them.
"""

from __future__ import annotations

from typing import Any, NamedTuple, Protocol

import numpy as np

from situgraph.errors import MissingExtraError
from situgraph.geometry.poses import Array
from situgraph.slam.cloud import moved
from situgraph.slam.config import OdometryConfig
from situgraph.slam.motion import inverse, size, tidy


class Step(NamedTuple):
    """``pose`` (4x4) of base in the odometry's frame; ``trusted`` says whether the scan fitted.

    ``fit`` is the share of the scan's points that found a partner (1 where nothing is compared).
    """

    pose: Array
    trusted: bool
    fit: float


class ScanOdometry(Protocol):
    """Registers scans one after the other."""

    def register(self, points: Array, guess: Array) -> Step:
        """The pose of the scan ``points`` (n, 3, deskewed, base frame).

        ``guess`` is the expected pose (4x4) in the odometry's frame.
        """
        ...


def make(config: OdometryConfig) -> ScanOdometry:
    """The odometry that the settings name.

    Raises:
        MissingExtraError: kiss-icp is asked for and not installed.
    """
    if config.method == "recorded":
        return Recorded()
    return Kiss(config) if config.method == "kiss-icp" else Gicp(config)


class Recorded:
    """Trusts the recorded odometry (or constant speed where there is none): no scan is compared."""

    def register(self, points: Array, guess: Array) -> Step:
        """The guess itself."""
        return Step(guess, True, 1.0)


class Gicp:
    """Generalised ICP (Segal et al., RSS 2009) of each scan against the last few key scans."""

    def __init__(self, config: OdometryConfig) -> None:
        """Start without a submap."""
        self._config = config
        self._scans: list[tuple[Array, Array]] = []  # pose and thinned points of key scans
        self._target: tuple[Any, Any] | None = None
        self._anchor = np.eye(4)

    def register(self, points: Array, guess: Array) -> Step:
        """Align with the submap; where that fails the guess stands and a new submap begins."""
        import small_gicp

        c = self._config
        cloud, _ = small_gicp.preprocess_points(points, c.voxel, c.neighbours, 1)
        if self._target is None:
            self._extend(guess, cloud, fresh=True)
            return Step(guess, True, 1.0)
        step = self._closing_in(cloud, guess, c.reach)
        if not step.trusted:
            step = self._closing_in(cloud, guess, c.wide_reach)
        if not step.trusted:
            self._extend(guess, cloud, fresh=True)
            return Step(guess, False, step.fit)
        length, angle = size(inverse(self._anchor) @ step.pose)
        if length > c.submap_step or angle > c.submap_turn:
            self._extend(step.pose, cloud, fresh=False)
        return step

    def _closing_in(self, cloud: Any, guess: Array, reach: float) -> Step:
        """Align with partners up to ``reach`` apart, then with near ones only."""
        rough, fit = self._align(cloud, guess, reach)
        pose, _ = self._align(cloud, rough, self._config.near_reach)
        length, angle = size(inverse(guess) @ pose)
        trusted = (
            fit >= self._config.least_fit
            and bool(np.isfinite(pose).all())
            and length < reach
            and angle < self._config.largest_turn
        )
        return Step(pose, trusted, fit)

    def _align(self, cloud: Any, guess: Array, reach: float) -> tuple[Array, float]:
        import small_gicp

        assert self._target is not None
        target, tree = self._target
        result = small_gicp.align(
            target,
            cloud,
            tree,
            inverse(self._anchor) @ guess,
            registration_type="GICP",
            max_correspondence_distance=reach,
            num_threads=1,
            max_iterations=self._config.iterations,
        )
        pose = tidy(self._anchor @ result.T_target_source)
        return pose, result.num_inliers / max(cloud.size(), 1)

    def _extend(self, pose: Array, cloud: Any, *, fresh: bool) -> None:
        """Add the scan to the submap and drop the oldest; ``fresh`` starts over."""
        import small_gicp

        c = self._config
        points = np.asarray(cloud.points())[:, :3].copy()
        self._scans = (
            [(pose, points)] if fresh else [*self._scans, (pose, points)][-c.submap_scans :]
        )
        self._anchor = pose
        back = inverse(pose)
        merged = np.concatenate([moved(p, back @ q) for q, p in self._scans])
        self._target = small_gicp.preprocess_points(merged, c.voxel, c.neighbours, 1)


class Kiss:
    """KISS-ICP (Vizzo et al., RA-L 2023) from its own package, the extra ``kiss-icp``."""

    def __init__(self, config: OdometryConfig) -> None:
        """Start with an empty map.

        Raises:
            MissingExtraError: the package is not installed.
        """
        try:
            from kiss_icp.config import KISSConfig
            from kiss_icp.kiss_icp import KissICP
        except ImportError as error:
            raise MissingExtraError(
                "slam.odometry.method=kiss-icp needs the package kiss-icp; "
                "install situgraph[kiss-icp]"
            ) from error
        settings = KISSConfig()
        settings.data.max_range = config.kiss_range
        settings.data.deskew = False
        settings.mapping.voxel_size = config.kiss_range / 100.0
        self._icp = KissICP(settings)
        self._start: Array | None = None

    def register(self, points: Array, guess: Array) -> Step:
        """Align with KISS-ICP's own map; it predicts by itself, the guess only sets the start."""
        if self._start is None:
            self._start = guess
        self._icp.register_frame(np.ascontiguousarray(points), np.zeros(len(points)))
        return Step(self._start @ np.asarray(self._icp.last_pose), True, 1.0)
