"""Motion from scan to scan: the protocol and three ways to do it.

An odometry keeps its own frame, in which its poses are smooth but drift; the factor graph uses
only motions between them.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from situgraph.errors import MissingExtraError
from situgraph.geometry.poses import Array
from situgraph.slam.input_config import OdometryConfig


class Step(NamedTuple):
    """``pose`` (4x4) of base in the odometry's frame; ``trusted`` says whether the scan fitted.

    ``fit`` is the share of the scan's points that found a partner (1 where nothing is compared).
    """

    pose: Array
    trusted: bool
    fit: float


class ScanOdometry(Protocol):
    """Registers scans one after the other."""

    def register(self, points: Array, sensor: Array, guess: Array, reach: float) -> Step:
        """The pose of a scan.

        Args:
            points: (n, 3) deskewed, in base.
            sensor: (3,) origin of the LiDAR in base.
            guess: the expected pose (4x4) in the odometry's frame.
            reach: how far (m) the guess may be off at most.
        """
        ...


def make(config: OdometryConfig) -> ScanOdometry:
    """The odometry that the settings name.

    Raises:
        MissingExtraError: kiss-icp is asked for and not installed.
    """
    from situgraph.slam.gicp import Gicp

    if config.method == "recorded":
        return Recorded()
    return Kiss(config) if config.method == "kiss-icp" else Gicp(config)


class Recorded:
    """Trusts the recorded odometry (or constant speed where there is none): no scan is compared."""

    def register(self, points: Array, sensor: Array, guess: Array, reach: float) -> Step:
        """The guess itself."""
        return Step(guess, True, 1.0)


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

    def register(self, points: Array, sensor: Array, guess: Array, reach: float) -> Step:
        """Align with KISS-ICP's own map; it predicts by itself, the guess only sets the start."""
        if self._start is None:
            self._start = guess
        self._icp.register_frame(np.ascontiguousarray(points), np.zeros(len(points)))
        return Step(self._start @ np.asarray(self._icp.last_pose), True, 1.0)
