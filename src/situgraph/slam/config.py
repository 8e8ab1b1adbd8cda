"""Settings of the slam stage, part by part. Lengths in metres, angles in radians."""

from __future__ import annotations

from typing import Annotated, Any, Literal

import msgspec


def _meta(description: str, unit: str, source: str, **bounds: Any) -> msgspec.Meta:
    return msgspec.Meta(description=description, extra={"unit": unit, "source": source}, **bounds)


_TESTS = "drives of experiments/slam.py"
_VLP16 = "VLP-16 data sheet"


class OdometryConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Motion from scan to scan."""

    method: Annotated[
        Literal["small_gicp", "kiss-icp", "recorded"],
        _meta("How scans are registered", "", "FACTS: GICP drifts least"),
    ] = "small_gicp"
    near: Annotated[
        float, _meta("Nearer points are the robot itself", "m", "S-Graphs+ (0.5 m)", ge=0)
    ] = 0.5
    far: Annotated[float, _meta("Farther points are not used", "m", _VLP16 + ": 100 m", gt=0)] = (
        100.0
    )
    least_points: Annotated[
        int, _meta("A scan with fewer usable points is left out", "1", _TESTS, ge=20)
    ] = 100
    voxel: Annotated[
        float,
        _meta("Scans are thinned to this before they are registered", "m", "small_gicp", gt=0),
    ] = 0.25
    neighbours: Annotated[
        int, _meta("Neighbours of a point's covariance", "1", "small_gicp", ge=5)
    ] = 10
    reach: Annotated[
        float, _meta("Points farther apart are no partners", "m", "small_gicp", gt=0)
    ] = 1.0
    near_reach: Annotated[
        float, _meta("... in the second half of the iterations", "m", "docs/slam.md", gt=0)
    ] = 0.3
    wide_reach: Annotated[
        float,
        _meta("The same in a second try, after lost scans", "m", "2 s at walking speed", gt=0),
    ] = 3.0
    iterations: Annotated[int, _meta("Iterations of each half", "1", "docs/slam.md", ge=1)] = 10
    least_fit: Annotated[
        float, _meta("A scan of which fewer points find a partner is not trusted", "1", _TESTS)
    ] = 0.5
    largest_turn: Annotated[
        float, _meta("A larger correction of the guess's angle is not trusted", "rad", _TESTS)
    ] = 0.7
    submap_scans: Annotated[
        int, _meta("Key scans in the submap", "1", "docs/slam.md: drift by submap", ge=1)
    ] = 10
    submap_step: Annotated[
        float, _meta("A new key scan after this way", "m", "docs/slam.md: drift by submap", gt=0)
    ] = 0.5
    submap_turn: Annotated[float, _meta("A new key scan after this turn", "rad", _TESTS, gt=0)] = (
        0.6
    )
    kiss_range: Annotated[
        float, _meta("Range of KISS-ICP's map; its voxel is a hundredth", "m", "KISS-ICP", gt=0)
    ] = 100.0
    memory: Annotated[
        float, _meta("Recorded odometry is kept this long", "s", "bursts of 2 s may be lost", gt=0)
    ] = 10.0
    slack: Annotated[
        float, _meta("Recorded odometry this far from a scan still counts", "s", "5 Hz", ge=0)
    ] = 0.2
    largest_speed: Annotated[
        float, _meta("Recorded odometry that moves faster has jumped", "m/s", "twice a Spot", gt=0)
    ] = 3.5
    jump_slack: Annotated[
        float, _meta("A step of recorded odometry this small is never a jump", "m", _TESTS, ge=0)
    ] = 0.15


class KeyframeConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """When a scan becomes a keyframe."""

    distance: Annotated[
        float, _meta("A keyframe at least this often", "m", "S-Graphs+ (2.0 at most)", gt=0, le=2)
    ] = 1.0
    angle: Annotated[
        float, _meta("A keyframe at least this often", "rad", "S-Graphs+ (2.0 at most)", gt=0, le=2)
    ] = 1.0
    voxel: Annotated[float, _meta("Kept clouds are thinned to this", "m", "small_gicp", gt=0)] = 0.2


class PlaneConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Wall planes in a scan."""

    voxel: Annotated[
        float, _meta("Scans are thinned to one point a voxel", "m", "S-Graphs+ (0.1 m)", gt=0)
    ] = 0.1
    reach: Annotated[
        float, _meta("Neighbours that tell a surface's direction lie no farther", "m", _TESTS, gt=0)
    ] = 0.35
    directions: Annotated[
        int, _meta("Wall directions looked for in a scan", "1", "4 a wing, three wings", ge=1)
    ] = 12
    offset_bin: Annotated[float, _meta("Bin of the offset histogram", "m", "voxel", gt=0)] = 0.1
    thickness: Annotated[
        float,
        _meta("Points this close to the line belong to the wall", "m", _VLP16 + ": 3 cm", gt=0),
    ] = 0.06
    gap: Annotated[
        float, _meta("A longer gap cuts a wall into two pieces", "m", "half a door", gt=0)
    ] = 0.4
    least_points: Annotated[int, _meta("Fewest points of a wall piece", "1", _TESTS, ge=3)] = 10
    least_length: Annotated[
        float, _meta("Shortest wall piece", "m", "door jambs are shorter", gt=0)
    ] = 0.35
    least_height: Annotated[
        float, _meta("Least height that a wall piece shows", "m", "more than one ring", ge=0)
    ] = 0.12
    top: Annotated[
        float,
        _meta("Points above are not used: lintels would close doors", "m", "door: 2.0 m", gt=0),
    ] = 1.9
    range_sigma: Annotated[
        float, _meta("Noise of one point across the wall, at least", "m", _VLP16, gt=0)
    ] = 0.015
    angle_floor: Annotated[
        float, _meta("Error of a wall's angle that does not average out", "rad", _TESTS, gt=0)
    ] = 0.003
    offset_floor: Annotated[
        float, _meta("Error of a wall's offset that does not average out", "m", _TESTS, gt=0)
    ] = 0.006
    tilt_prior: Annotated[
        float, _meta("Expected error of a scan's tilt before its walls tell", "rad", _TESTS, gt=0)
    ] = 0.03
    tilt_noise: Annotated[float, _meta("Error of one surface normal", "rad", _TESTS, gt=0)] = 0.1
    tilt_limit: Annotated[
        float, _meta("Normals farther off are neither wall nor floor", "rad", "4 deg", gt=0)
    ] = 0.07
    tilt_floor: Annotated[
        float, _meta("Error of a scan's tilt that does not average out", "rad", _TESTS, gt=0)
    ] = 0.004
    floor_lowest: Annotated[
        float, _meta("The floor lies no lower under base", "m", "a sensor on a mast")
    ] = -2.5
    floor_highest: Annotated[
        float, _meta("The floor lies no higher than this over base", "m", "base on the floor")
    ] = 0.25
    floor_points: Annotated[int, _meta("Fewest points of a floor", "1", _TESTS, ge=1)] = 20
    floor_sigma: Annotated[
        float, _meta("Error of the floor's height that does not average out", "m", _TESTS, gt=0)
    ] = 0.02
    floor_tilt: Annotated[float, _meta("Error of the floor's direction", "rad", _TESTS, gt=0)] = (
        0.02
    )
    floor_range: Annotated[float, _meta("Floor is looked for this near", "m", "one room", gt=0)] = (
        10.0
    )


class MapConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Association of wall pieces to the planes of the map."""

    angle: Annotated[
        float, _meta("A piece and its plane differ less in direction", "rad", _TESTS, gt=0)
    ] = 0.12
    offset: Annotated[
        float, _meta("... and less across, after the keyframe is aligned", "m", _TESTS, gt=0)
    ] = 0.07
    search: Annotated[
        float, _meta("... and less across, before it is aligned", "m", "half a cupboard", gt=0)
    ] = 0.35
    gap: Annotated[
        float, _meta("... and lie no farther apart along the wall", "m", "one door", ge=0)
    ] = 1.2
    sigma_position: Annotated[
        float, _meta("Expected error of a keyframe before it is aligned", "m", _TESTS, gt=0)
    ] = 0.15
    sigma_yaw: Annotated[
        float, _meta("Expected error of a keyframe before it is aligned", "rad", _TESTS, gt=0)
    ] = 0.02
    new_length: Annotated[
        float, _meta("A shorter piece starts no plane", "m", "a wall stub between doors", gt=0)
    ] = 0.5
    merge_offset: Annotated[
        float, _meta("Planes closer than this that overlap are one", "m", _TESTS, gt=0)
    ] = 0.06
    merge_angle: Annotated[
        float, _meta("... when their directions differ less", "rad", "2 deg", gt=0)
    ] = 0.035
    interval_gap: Annotated[
        float,
        _meta("A plane seen on both sides of a shorter gap was seen in it", "m", _TESTS, ge=0),
    ] = 0.3
    certain_length: Annotated[
        float, _meta("A plane this long counts after one sighting, others after two", "m", _TESTS)
    ] = 1.5


class GraphConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Noise of the factors and how they are solved."""

    relinearize: Annotated[
        float, _meta("Variables that move less are not linearised anew", "1", "iSAM2", gt=0)
    ] = 0.01
    huber: Annotated[
        float, _meta("Kernel of motion factors, in sigmas", "1", "Huber 1981", gt=0)
    ] = 1.345
    start_tilt: Annotated[float, _meta("Tilt of the first keyframe", "rad", _TESTS, gt=0)] = 0.05
    motion_angle: Annotated[
        float, _meta("Error of a motion's angle, a keyframe", "rad", _TESTS, gt=0)
    ] = 0.005
    motion_position: Annotated[float, _meta("Error of a motion, a keyframe", "m", _TESTS, gt=0)] = (
        0.015
    )
    motion_share: Annotated[float, _meta("Error of a motion, a metre", "1", _TESTS, ge=0)] = 0.01
    lost_factor: Annotated[
        float, _meta("Errors are so much larger where scans were not registered", "1", _TESTS, ge=1)
    ] = 20.0


class SlamConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Settings of the slam stage."""

    odometry: OdometryConfig = msgspec.field(default_factory=OdometryConfig)
    keyframes: KeyframeConfig = msgspec.field(default_factory=KeyframeConfig)
    planes: PlaneConfig = msgspec.field(default_factory=PlaneConfig)
    map: MapConfig = msgspec.field(default_factory=MapConfig)
    graph: GraphConfig = msgspec.field(default_factory=GraphConfig)
