"""Settings of the slam stage, part by part. Lengths in metres, angles in radians."""

from __future__ import annotations

from typing import Annotated

import msgspec

from situgraph.setting import setting
from situgraph.slam.input_config import (
    TESTS,
    VLP16,
    ImageConfig,
    KeyframeConfig,
    OdometryConfig,
)


class PlaneConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Wall planes in a scan."""

    voxel: Annotated[
        float, setting("Scans are thinned to one point a voxel", "m", "S-Graphs+ (0.1 m)", gt=0)
    ] = 0.1
    reach: Annotated[
        float,
        setting("Neighbours that tell a surface's direction lie no farther", "m", TESTS, gt=0),
    ] = 0.35
    directions: Annotated[
        int, setting("Wall directions looked for in a scan", "1", "4 a wing, three wings", ge=1)
    ] = 12
    offset_bin: Annotated[float, setting("Bin of the offset histogram", "m", "voxel", gt=0)] = 0.1
    thickness: Annotated[
        float,
        setting("Points this close to the line belong to the wall", "m", VLP16 + ": 3 cm", gt=0),
    ] = 0.06
    gap: Annotated[
        float, setting("A longer gap cuts a wall into two pieces", "m", "half a door", gt=0)
    ] = 0.4
    least_points: Annotated[int, setting("Fewest points of a wall piece", "1", TESTS, ge=3)] = 10
    least_length: Annotated[
        float, setting("Shortest wall piece", "m", "door jambs are shorter", gt=0)
    ] = 0.35
    least_height: Annotated[
        float, setting("Least height that a wall piece shows", "m", "more than one ring", ge=0)
    ] = 0.12
    bottom: Annotated[
        float, setting("Points below are floor and sills", "m", "skirting board", ge=0)
    ] = 0.12
    top: Annotated[
        float,
        setting("Points above are not used: lintels would close doors", "m", "door: 2.0 m", gt=0),
    ] = 1.9
    noise_pieces: Annotated[
        int, setting("Longest pieces of a scan that tell its noise", "1", TESTS, ge=1)
    ] = 5
    blur: Annotated[
        float,
        setting("A piece that scatters more than this many times is no wall", "1", TESTS, gt=1),
    ] = 1.8
    skew: Annotated[
        float, setting("Nor is one whose surfaces face another way", "rad", TESTS, gt=0)
    ] = 0.05
    angle_limit: Annotated[
        float, setting("Nor one whose angle is known no better", "rad", TESTS, gt=0)
    ] = 0.025
    range_sigma: Annotated[
        float, setting("Noise of one point across the wall, at least", "m", VLP16, gt=0)
    ] = 0.015
    angle_floor: Annotated[
        float, setting("Error of a wall's angle that does not average out", "rad", TESTS, gt=0)
    ] = 0.003
    offset_floor: Annotated[
        float, setting("Error of a wall's offset that does not average out", "m", TESTS, gt=0)
    ] = 0.006
    tilt_prior: Annotated[
        float, setting("Expected error of a scan's tilt before its walls tell", "rad", TESTS, gt=0)
    ] = 0.03
    tilt_noise: Annotated[float, setting("Error of one surface normal", "rad", TESTS, gt=0)] = 0.1
    tilt_limit: Annotated[
        float, setting("Normals farther off are neither wall nor floor", "rad", "4 deg", gt=0)
    ] = 0.07
    tilt_floor: Annotated[
        float, setting("Error of a scan's tilt that does not average out", "rad", TESTS, gt=0)
    ] = 0.004
    floor_lowest: Annotated[
        float, setting("The floor lies no lower under base", "m", "a sensor on a mast")
    ] = -2.5
    floor_highest: Annotated[
        float, setting("The floor lies no higher than this over base", "m", "base on the floor")
    ] = 0.25
    floor_points: Annotated[int, setting("Fewest points of a floor", "1", TESTS, ge=1)] = 20
    floor_sigma: Annotated[
        float, setting("Error of the floor's height that does not average out", "m", TESTS, gt=0)
    ] = 0.02
    floor_tilt: Annotated[float, setting("Error of the floor's direction", "rad", TESTS, gt=0)] = (
        0.02
    )
    floor_range: Annotated[
        float, setting("Floor is looked for this near", "m", "one room", gt=0)
    ] = 10.0


class MapConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Association of wall pieces to the planes of the map."""

    angle: Annotated[
        float, setting("A piece and its plane differ less in direction", "rad", TESTS, gt=0)
    ] = 0.12
    offset: Annotated[
        float, setting("... and less across, after the keyframe is aligned", "m", TESTS, gt=0)
    ] = 0.07
    search: Annotated[
        float, setting("... and less across, before it is aligned", "m", "half a cupboard", gt=0)
    ] = 0.35
    gap: Annotated[
        float, setting("... and lie no farther apart along the wall", "m", "one door", ge=0)
    ] = 1.2
    seen_again: Annotated[
        float,
        setting("A piece was seen before where it shares so much with its plane", "m", TESTS, gt=0),
    ] = 0.5
    extend: Annotated[
        float,
        setting("Another one lies this near the plane's line", "m", "3 sigma of both", gt=0),
    ] = 0.03
    sigma_position: Annotated[
        float, setting("Expected error of a keyframe before it is aligned", "m", TESTS, gt=0)
    ] = 0.15
    sigma_yaw: Annotated[
        float, setting("Expected error of a keyframe before it is aligned", "rad", TESTS, gt=0)
    ] = 0.02
    new_length: Annotated[
        float,
        setting(
            "A shorter wall, doors apart, starts no plane", "m", "a wall stub between doors", gt=0
        ),
    ] = 0.5
    merge_offset: Annotated[
        float, setting("Planes closer than this that overlap are one", "m", TESTS, gt=0)
    ] = 0.06
    merge_angle: Annotated[
        float, setting("... when their directions differ less", "rad", "2 deg", gt=0)
    ] = 0.035
    interval_gap: Annotated[
        float,
        setting("A plane seen on both sides of a shorter gap was seen in it", "m", TESTS, ge=0),
    ] = 0.3
    certain_length: Annotated[
        float, setting("A plane this long counts at once, shorter ones", "m", TESTS, gt=0)
    ] = 1.5
    certain_sightings: Annotated[int, setting("... after so many sightings", "1", TESTS, ge=1)] = 2
    wall_share: Annotated[
        float, setting("Furniture ends below this share of the visible height", "1", TESTS, ge=0)
    ] = 0.8


class RoomConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Rooms from free space and planes."""

    cell: Annotated[float, setting("Cell of the plan's raster", "m", "FACTS", gt=0)] = 0.1
    band_top: Annotated[
        float, setting("Beams above say nothing of the free space", "m", "door: 2.0 m", gt=0)
    ] = 1.9
    free_range: Annotated[
        float, setting("Free space counts up to this distance", "m", TESTS, gt=0)
    ] = 15.0
    free_margin: Annotated[
        float, setting("Free space ends this far before what was hit", "m", "half a cell", ge=0)
    ] = 0.05
    window: Annotated[
        float, setting("Rooms are looked for this far around the robot", "m", TESTS, gt=0)
    ] = 15.0
    door_width: Annotated[
        float, setting("A gap in a wall up to this is an opening", "m", "double doors", gt=0)
    ] = 2.4
    end_door_width: Annotated[
        float,
        setting("... a gap between a wall's end and the next wall", "m", "single doors", gt=0),
    ] = 1.3
    leaf_length: Annotated[float, setting("An open door leaf is no longer", "m", "doors", gt=0)] = (
        1.3
    )
    leaf_thickness: Annotated[
        float, setting("... and no thicker", "m", "doors, and noise", gt=0)
    ] = 0.12
    board: Annotated[
        float,
        setting(
            "... and a part of a longer line is a leaf if no thicker", "m", "door leaves", gt=0
        ),
    ] = 0.08
    collinear: Annotated[
        float, setting("Faces on one line differ less in offset", "m", TESTS, gt=0)
    ] = 0.08
    thickest_wall: Annotated[
        float, setting("The other face of a wall lies no farther behind", "m", "walls", gt=0)
    ] = 0.5
    corner: Annotated[float, setting("Walls whose ends are this near meet", "m", TESTS, gt=0)] = (
        0.25
    )
    least_support: Annotated[
        float, setting("A plane bounds a room with at least this much of it", "m", TESTS, gt=0)
    ] = 0.4
    jog: Annotated[
        float, setting("Parallel faces nearer than this are one side of a room", "m", TESTS, gt=0)
    ] = 0.25
    most_planes: Annotated[
        int, setting("Planes of a room at most, the longest first", "1", TESTS, ge=4, le=40)
    ] = 20
    open_slack: Annotated[
        float, setting("A region may end this far before a wall", "m", TESTS, gt=0)
    ] = 0.35
    free_share: Annotated[
        float, setting("A cell between walls belongs to the room if so much is free", "1", TESTS)
    ] = 0.5
    widest_window: Annotated[
        float, setting("... and up to this far when the robot's room goes on", "m", TESTS, gt=0)
    ] = 60.0
    half_height: Annotated[
        float, setting("Centres of rooms lie this high over the floor", "m", "half of 2.5 m", gt=0)
    ] = 1.25
    every: Annotated[
        float, setting("Of keyframes nearer to each other only the last counts", "m", TESTS, gt=0)
    ] = 0.5
    entered_margin: Annotated[
        float, setting("A room is entered this far inside its walls", "m", "half a robot", ge=0)
    ] = 0.25
    least_closed: Annotated[
        float, setting("Share of an entered room's outline that is wall or door", "1", TESTS)
    ] = 0.6
    least_closed_unentered: Annotated[
        float, setting("The same for a room that was only looked into", "1", TESTS)
    ] = 0.85
    least_area: Annotated[float, setting("Smallest room", "m2", "a toilet", gt=0)] = 0.9
    least_width: Annotated[float, setting("Narrowest room", "m", "a toilet", gt=0)] = 0.7


class StoreyConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Storeys from height changes."""

    slack: Annotated[
        float, setting("A robot this near a storey's floor is on it", "m", "two steps", gt=0)
    ] = 0.4
    least_height: Annotated[
        float, setting("Storeys are at least so far apart", "m", "headroom", gt=0)
    ] = 1.5
    level_keyframes: Annotated[
        int, setting("Keyframes at one height that make a landing a storey", "1", TESTS, ge=2)
    ] = 3
    level_range: Annotated[
        float, setting("... whose heights differ less", "m", "one step", gt=0)
    ] = 0.12
    standing: Annotated[
        float, setting("Base over the floor, before it was seen", "m", "Spot", gt=0)
    ] = 0.5
    standing_least: Annotated[int, setting("... and which it needs at least", "1", TESTS, ge=1)] = 3
    standing_share: Annotated[
        float,
        setting("... and the share of them that must agree", "1", "SE1/R8, Institute", ge=0, le=1),
    ] = 0.3
    standing_keyframes: Annotated[
        int, setting("Keyframes that tell base's height over the floor", "1", TESTS, ge=1)
    ] = 10
    standing_sigma: Annotated[
        float, setting("How well base keeps its height over a floor not seen", "m", "gait", gt=0)
    ] = 0.03
    standing_tilt: Annotated[
        float,
        setting("... and its direction, which gravity tells", "rad", "no information", gt=0),
    ] = 1.0
    standing_slack: Annotated[
        float,
        setting("A robot that is farther from its usual height climbs", "m", "one step", gt=0),
    ] = 0.15
    floor_slack: Annotated[
        float, setting("A floor seen farther from the storey's is another", "m", "one step", gt=0)
    ] = 0.15


class StructureConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Soft factors between planes: the two faces of a wall, the axes of a wing."""

    least_sightings: Annotated[
        int, setting("Keyframes that saw a plane before it is tied", "1", TESTS, ge=1)
    ] = 3
    least_length: Annotated[
        float, setting("Shorter planes are not tied to axes", "m", TESTS, gt=0)
    ] = 1.5
    axes_length: Annotated[
        float, setting("A plane this long may start the axes of another wing", "m", TESTS, gt=0)
    ] = 3.0
    same_axes: Annotated[
        float, setting("A wall this near in direction follows the axes", "rad", "1.5 deg", gt=0)
    ] = 0.026
    other_axes: Annotated[
        float, setting("... and one farther off has other axes", "rad", "5 deg", gt=0)
    ] = 0.087
    angle: Annotated[
        float,
        setting("Walls deviate from parallel by this", "rad", "0.5 deg, building practice", gt=0),
    ] = 0.009
    tilt: Annotated[
        float, setting("Walls deviate from upright by this", "rad", "building practice", gt=0)
    ] = 0.005
    overlap: Annotated[
        float, setting("Two faces of a wall lie side by side for this long", "m", TESTS, gt=0)
    ] = 0.5
    thinnest: Annotated[float, setting("Thinnest wall", "m", "layouts", gt=0)] = 0.04
    thickest: Annotated[float, setting("Thickest wall", "m", "building practice", gt=0)] = 0.5
    thickness_sigma: Annotated[
        float, setting("How well a wall keeps the thickness first seen", "m", TESTS, gt=0)
    ] = 0.05


class GraphConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Noise of the factors and how they are solved."""

    relinearize: Annotated[
        float, setting("Variables that move less are not linearised anew", "1", "iSAM2", gt=0)
    ] = 0.01
    huber: Annotated[
        float, setting("Kernel of motion factors, in sigmas", "1", "Huber 1981", gt=0)
    ] = 1.345
    extra_steps: Annotated[
        int, setting("Further Gauss-Newton steps an update", "1", TESTS, ge=0)
    ] = 1
    start_sigma: Annotated[
        float,
        setting("The first keyframe's place and heading are the map's", "m, rad", "gauge", gt=0),
    ] = 1e-3
    start_tilt: Annotated[float, setting("Tilt of the first keyframe", "rad", TESTS, gt=0)] = 0.05
    motion_angle: Annotated[
        float, setting("Error of a motion's angle, a keyframe", "rad", TESTS, gt=0)
    ] = 0.005
    motion_position: Annotated[
        float, setting("Error of a motion, a keyframe", "m", TESTS, gt=0)
    ] = 0.015
    motion_share: Annotated[float, setting("Error of a motion, a metre", "1", TESTS, ge=0)] = 0.01
    recorded_factor: Annotated[
        float, setting("Errors are so much larger where only odometry was there", "1", TESTS, ge=1)
    ] = 3.0
    lost_factor: Annotated[
        float, setting("Errors are so much larger where nothing was there", "1", TESTS, ge=1)
    ] = 20.0


class SlamConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Settings of the slam stage."""

    odometry: OdometryConfig = msgspec.field(default_factory=OdometryConfig)
    keyframes: KeyframeConfig = msgspec.field(default_factory=KeyframeConfig)
    images: ImageConfig = msgspec.field(default_factory=ImageConfig)
    planes: PlaneConfig = msgspec.field(default_factory=PlaneConfig)
    map: MapConfig = msgspec.field(default_factory=MapConfig)
    rooms: RoomConfig = msgspec.field(default_factory=RoomConfig)
    structure: StructureConfig = msgspec.field(default_factory=StructureConfig)
    storeys: StoreyConfig = msgspec.field(default_factory=StoreyConfig)
    graph: GraphConfig = msgspec.field(default_factory=GraphConfig)
