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
    ] = 0.5
    near_reach: Annotated[
        float, _meta("... in the second half of the iterations", "m", "docs/slam.md", gt=0)
    ] = 0.2
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
    bottom: Annotated[
        float, _meta("Points below are floor and sills", "m", "skirting board", ge=0)
    ] = 0.12
    top: Annotated[
        float,
        _meta("Points above are not used: lintels would close doors", "m", "door: 2.0 m", gt=0),
    ] = 1.9
    noise_pieces: Annotated[
        int, _meta("Longest pieces of a scan that tell its noise", "1", _TESTS, ge=1)
    ] = 5
    blur: Annotated[
        float,
        _meta("A piece that scatters more than this many times is no wall", "1", _TESTS, gt=1),
    ] = 1.8
    skew: Annotated[
        float, _meta("Nor is one whose surfaces face another way", "rad", _TESTS, gt=0)
    ] = 0.05
    angle_limit: Annotated[
        float, _meta("Nor one whose angle is known no better", "rad", _TESTS, gt=0)
    ] = 0.025
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
        float, _meta("A plane this long counts at once, shorter ones", "m", _TESTS, gt=0)
    ] = 1.5
    certain_sightings: Annotated[int, _meta("... after so many sightings", "1", _TESTS, ge=1)] = 2
    wall_share: Annotated[
        float, _meta("Furniture ends below this share of the visible height", "1", _TESTS, ge=0)
    ] = 0.8


class RoomConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Rooms from free space and planes."""

    cell: Annotated[float, _meta("Cell of the plan's raster", "m", "FACTS", gt=0)] = 0.1
    band_top: Annotated[
        float, _meta("Beams above say nothing of the free space", "m", "door: 2.0 m", gt=0)
    ] = 1.9
    free_range: Annotated[
        float, _meta("Free space counts up to this distance", "m", _TESTS, gt=0)
    ] = 15.0
    free_margin: Annotated[
        float, _meta("Free space ends this far before what was hit", "m", "half a cell", ge=0)
    ] = 0.05
    window: Annotated[
        float, _meta("Rooms are looked for this far around the robot", "m", _TESTS, gt=0)
    ] = 15.0
    door_width: Annotated[
        float, _meta("A gap in a wall up to this is a doorway", "m", "double doors", gt=0)
    ] = 1.8
    end_door_width: Annotated[
        float, _meta("... a gap between a wall's end and the next wall", "m", "single doors", gt=0)
    ] = 1.3
    leaf_length: Annotated[float, _meta("An open door leaf is no longer", "m", "doors", gt=0)] = 1.3
    leaf_thickness: Annotated[float, _meta("... and no thicker", "m", "doors, and noise", gt=0)] = (
        0.12
    )
    collinear: Annotated[
        float, _meta("Faces on one line differ less in offset", "m", _TESTS, gt=0)
    ] = 0.08
    thickest_wall: Annotated[
        float, _meta("The other face of a wall lies no farther behind", "m", "walls", gt=0)
    ] = 0.5
    corner: Annotated[float, _meta("Walls whose ends are this near meet", "m", _TESTS, gt=0)] = 0.25
    least_support: Annotated[
        float, _meta("A plane bounds a room with at least this much of it", "m", _TESTS, gt=0)
    ] = 0.4
    jog: Annotated[
        float, _meta("Parallel faces nearer than this are one side of a room", "m", _TESTS, gt=0)
    ] = 0.25
    most_planes: Annotated[
        int, _meta("Planes of a room at most, the longest first", "1", _TESTS, ge=4, le=40)
    ] = 20
    open_slack: Annotated[
        float, _meta("A region may end this far before a wall", "m", _TESTS, gt=0)
    ] = 0.35
    free_share: Annotated[
        float, _meta("A cell between walls belongs to the room if so much is free", "1", _TESTS)
    ] = 0.5
    widest_window: Annotated[
        float, _meta("... and up to this far when the robot's room goes on", "m", _TESTS, gt=0)
    ] = 60.0
    half_height: Annotated[
        float, _meta("Centres of rooms lie this high over the floor", "m", "half of 2.5 m", gt=0)
    ] = 1.25
    every: Annotated[
        float, _meta("Of keyframes nearer to each other only the last counts", "m", _TESTS, gt=0)
    ] = 0.5
    entered_margin: Annotated[
        float, _meta("A room is entered this far inside its walls", "m", "half a robot", ge=0)
    ] = 0.25
    least_closed: Annotated[
        float, _meta("Share of an entered room's outline that is wall or door", "1", _TESTS)
    ] = 0.6
    least_closed_unentered: Annotated[
        float, _meta("The same for a room that was only looked into", "1", _TESTS)
    ] = 0.85
    least_area: Annotated[float, _meta("Smallest room", "m2", "a toilet", gt=0)] = 0.9
    least_width: Annotated[float, _meta("Narrowest room", "m", "a toilet", gt=0)] = 0.7


class StoreyConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Storeys from height changes."""

    slack: Annotated[
        float, _meta("A robot this near a storey's floor is on it", "m", "two steps", gt=0)
    ] = 0.4
    least_height: Annotated[
        float, _meta("Storeys are at least so far apart", "m", "headroom", gt=0)
    ] = 1.5
    level_keyframes: Annotated[
        int, _meta("Keyframes at one height that make a landing a storey", "1", _TESTS, ge=2)
    ] = 3
    level_range: Annotated[float, _meta("... whose heights differ less", "m", "one step", gt=0)] = (
        0.12
    )
    standing: Annotated[
        float, _meta("Base over the floor, before it was seen", "m", "Spot", gt=0)
    ] = 0.5
    standing_keyframes: Annotated[
        int, _meta("Keyframes that tell base's height over the floor", "1", _TESTS, ge=1)
    ] = 10
    floor_slack: Annotated[
        float, _meta("A floor seen farther from the storey's is another", "m", "one step", gt=0)
    ] = 0.15


class StructureConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Soft factors between planes: the two faces of a wall, the axes of a wing."""

    least_sightings: Annotated[
        int, _meta("Keyframes that saw a plane before it is tied", "1", _TESTS, ge=1)
    ] = 3
    least_length: Annotated[
        float, _meta("Shorter planes are not tied to axes", "m", _TESTS, gt=0)
    ] = 1.5
    axes_length: Annotated[
        float, _meta("A plane this long may start the axes of another wing", "m", _TESTS, gt=0)
    ] = 3.0
    same_axes: Annotated[
        float, _meta("A wall this near in direction follows the axes", "rad", "1.5 deg", gt=0)
    ] = 0.026
    other_axes: Annotated[
        float, _meta("... and one farther off has other axes", "rad", "5 deg", gt=0)
    ] = 0.087
    angle: Annotated[
        float,
        _meta("Walls deviate from parallel by this", "rad", "0.5 deg, building practice", gt=0),
    ] = 0.009
    tilt: Annotated[
        float, _meta("Walls deviate from upright by this", "rad", "building practice", gt=0)
    ] = 0.005
    overlap: Annotated[
        float, _meta("Two faces of a wall lie side by side for this long", "m", _TESTS, gt=0)
    ] = 0.5
    thinnest: Annotated[float, _meta("Thinnest wall", "m", "layouts", gt=0)] = 0.04
    thickest: Annotated[float, _meta("Thickest wall", "m", "building practice", gt=0)] = 0.5
    thickness_sigma: Annotated[
        float, _meta("How well a wall keeps the thickness first seen", "m", _TESTS, gt=0)
    ] = 0.05


class GraphConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Noise of the factors and how they are solved."""

    relinearize: Annotated[
        float, _meta("Variables that move less are not linearised anew", "1", "iSAM2", gt=0)
    ] = 0.01
    huber: Annotated[
        float, _meta("Kernel of motion factors, in sigmas", "1", "Huber 1981", gt=0)
    ] = 1.345
    extra_steps: Annotated[
        int, _meta("Further Gauss-Newton steps an update", "1", _TESTS, ge=0)
    ] = 1
    start_sigma: Annotated[
        float,
        _meta("The first keyframe's place and heading are the map's", "m, rad", "gauge", gt=0),
    ] = 1e-3
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
    rooms: RoomConfig = msgspec.field(default_factory=RoomConfig)
    structure: StructureConfig = msgspec.field(default_factory=StructureConfig)
    storeys: StoreyConfig = msgspec.field(default_factory=StoreyConfig)
    graph: GraphConfig = msgspec.field(default_factory=GraphConfig)
