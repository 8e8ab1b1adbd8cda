"""Settings of how scans and images come in: odometry, keyframes, images."""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec

from situgraph.setting import setting

TESTS = "drives of experiments/slam.py"
VLP16 = "VLP-16 data sheet"


class OdometryConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Motion from scan to scan."""

    method: Annotated[
        Literal["small_gicp", "kiss-icp", "recorded"],
        setting("How scans are registered", "", "FACTS: GICP drifts least"),
    ] = "small_gicp"
    near: Annotated[
        float, setting("Nearer points are the robot itself", "m", "S-Graphs+ (0.5 m)", ge=0)
    ] = 0.5
    far: Annotated[float, setting("Farther points are not used", "m", VLP16 + ": 100 m", gt=0)] = (
        100.0
    )
    least_points: Annotated[
        int, setting("A scan with fewer usable points is left out", "1", TESTS, ge=20)
    ] = 100
    voxel: Annotated[
        float,
        setting("Scans are thinned to this before they are registered", "m", "small_gicp", gt=0),
    ] = 0.25
    neighbours: Annotated[
        int, setting("Neighbours of a point's covariance", "1", "small_gicp", ge=5)
    ] = 10
    reach: Annotated[
        float, setting("Points farther apart are no partners", "m", "small_gicp", gt=0)
    ] = 0.5
    near_reach: Annotated[
        float, setting("... in the second half of the iterations", "m", "docs/slam.md", gt=0)
    ] = 0.2
    wide_reach: Annotated[
        float,
        setting(
            "The same in a second try where no odometry was recorded",
            "m",
            "2 s at walking speed",
            gt=0,
        ),
    ] = 3.0
    iterations: Annotated[int, setting("Iterations of each half", "1", "docs/slam.md", ge=1)] = 10
    least_fit: Annotated[
        float, setting("A scan of which fewer points find a partner is not trusted", "1", TESTS)
    ] = 0.5
    largest_turn: Annotated[
        float, setting("A larger correction of the guess's angle is not trusted", "rad", TESTS)
    ] = 0.7
    submap_scans: Annotated[
        int, setting("Key scans in the submap", "1", "docs/slam.md: drift by submap", ge=1)
    ] = 10
    submap_step: Annotated[
        float, setting("A new key scan after this way", "m", "docs/slam.md: drift by submap", gt=0)
    ] = 0.5
    submap_turn: Annotated[float, setting("A new key scan after this turn", "rad", TESTS, gt=0)] = (
        0.6
    )
    kiss_range: Annotated[
        float, setting("Range of KISS-ICP's map; its voxel is a hundredth", "m", "KISS-ICP", gt=0)
    ] = 100.0
    memory: Annotated[
        float,
        setting("Recorded odometry is kept this long", "s", "bursts of 2 s may be lost", gt=0),
    ] = 10.0
    least_memory: Annotated[
        int, setting("... and no fewer than the last poses", "1", "logs of keyframes", ge=2)
    ] = 20
    slack: Annotated[
        float, setting("Recorded odometry this far from a scan still counts", "s", "5 Hz", ge=0)
    ] = 0.2
    largest_speed: Annotated[
        float,
        setting("Recorded odometry that moves faster has jumped", "m/s", "twice a Spot", gt=0),
    ] = 3.5
    jump_slack: Annotated[
        float, setting("A step of recorded odometry this small is never a jump", "m", TESTS, ge=0)
    ] = 0.15


class KeyframeConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """When a scan becomes a keyframe."""

    distance: Annotated[
        float, setting("A keyframe at least this often", "m", "S-Graphs+ (2.0 at most)", gt=0, le=2)
    ] = 1.0
    angle: Annotated[
        float,
        setting("A keyframe at least this often", "rad", "S-Graphs+ (2.0 at most)", gt=0, le=2),
    ] = 1.0
    trail: Annotated[
        float, setting("The way is kept in steps of this for doorways", "m", "a wall's depth", gt=0)
    ] = 0.1


class ImageConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Which images are tied to keyframes and looked at."""

    period: Annotated[
        float, setting("Images that follow the last one sooner are left out", "s", "2 Hz", ge=0)
    ] = 0.4
    waiting: Annotated[
        int, setting("Images that wait for the next scan at most", "1", "2 s of them", ge=1)
    ] = 8
    dark: Annotated[
        float,
        setting("A darker image shows nothing (mean grey of 255)", "1", "a black image", ge=0),
    ] = 4.0
