"""Settings of the simulator: the world, the sensors, the robot. SI units and radians."""

from __future__ import annotations

from typing import Annotated

import msgspec

from situgraph.setting import setting

_VLP16 = "Velodyne VLP-16 user manual"
_D435 = "Intel RealSense D400 series data sheet"
_SPOT = "Boston Dynamics Spot, as used with a VLP-16 and a D435"
_CHOICE = "docs/sim.md"


class WorldConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The building that is driven through: what the plan leaves open, and how it deviates."""

    texture_seed: Annotated[
        Annotated[int, msgspec.Meta(ge=0)] | None,
        setting("Paints, textures, lights; none: the simulation's seed", "", _CHOICE),
    ] = None
    storey_height: Annotated[
        float, setting("Room height where the plan has none", "m", _CHOICE, ge=2, le=20)
    ] = 2.8
    outer_wall: Annotated[
        float, setting("Thickness of walls with nothing behind", "m", _CHOICE, ge=0.05, le=1)
    ] = 0.3
    door_angle_low: Annotated[
        float, setting("Smallest angle of an open door leaf", "rad", _CHOICE, ge=0.8, le=3)
    ] = 1.45
    door_angle_high: Annotated[
        float, setting("Largest angle of an open door leaf", "rad", _CHOICE, ge=0.8, le=3)
    ] = 1.9
    closed_doors: Annotated[
        float, setting("Share of doors between rooms that stay shut", "1", _CHOICE, ge=0, le=1)
    ] = 0.0
    pictures: Annotated[
        float,
        setting("Pictures and boards a room, in no plan, on its walls", "1", _CHOICE, ge=0, le=20),
    ] = 1.0
    moved_walls: Annotated[
        int, setting("Walls built elsewhere than planned", "1", "issue 4", ge=0, le=1000)
    ] = 0
    moved_by: Annotated[
        float, setting("Distance such a wall is moved, either way", "m", "FACTS.md", ge=0, le=1)
    ] = 0.3
    missing_doors: Annotated[
        int, setting("Doors planned and not built", "1", "issue 4", ge=0, le=1000)
    ] = 0
    extra_furniture: Annotated[
        int, setting("Pieces of furniture that no plan has", "1", "issue 4", ge=0, le=10_000)
    ] = 0


class LidarConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A spinning LiDAR of 16 beams; the pattern itself (``lidar.py``) is the VLP-16's."""

    rate: Annotated[float, setting("Turns a second", "Hz", _VLP16, ge=5, le=20)] = 10.0
    range_noise: Annotated[
        float,
        setting("Standard deviation of a range", "m", f"{_VLP16}: typically 3 cm", ge=0, le=1),
    ] = 0.015
    range_step: Annotated[float, setting("Ranges are multiples of this", "m", _VLP16, ge=0.001)] = (
        0.002
    )
    range_low: Annotated[float, setting("Nothing nearer is measured", "m", _VLP16, ge=0)] = 0.5
    range_high: Annotated[float, setting("Nothing farther is measured", "m", _VLP16, gt=0)] = 100.0
    dropout: Annotated[
        float, setting("Share of returns lost by chance", "1", _CHOICE, ge=0, le=1)
    ] = 0.01
    grazing: Annotated[
        float, setting("Cosine of incidence at which half the returns are lost", "1", _CHOICE, ge=0)
    ] = 0.03
    glass_pass: Annotated[
        float, setting("Share of beams that go through a pane", "1", _CHOICE, ge=0, le=1)
    ] = 0.8
    glass_return: Annotated[
        float,
        setting("Share of beams that a pane sends back; the rest is lost", "1", _CHOICE, ge=0),
    ] = 0.08
    motion: Annotated[
        bool, setting("Each beam starts where the robot is when it fires", "", "issue 4")
    ] = True
    position: Annotated[
        tuple[float, float, float], setting("Sensor in base: x, y, z", "m", _SPOT)
    ] = (0.0, 0.0, 0.33)


class CameraConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """An RGB-D camera; its frame is x right, y down, z forward."""

    rate: Annotated[float, setting("Images a second", "Hz", "issue 4", gt=0, le=60)] = 2.0
    width: Annotated[int, setting("Image width", "px", _D435, ge=16, le=4096)] = 640
    height: Annotated[int, setting("Image height", "px", _D435, ge=16, le=4096)] = 480
    focal: Annotated[float, setting("Focal length at 640 px width", "px", "FACTS.md", gt=0)] = 386.0
    baseline: Annotated[float, setting("Distance of the stereo pair", "m", _D435, gt=0)] = 0.05
    disparity_noise: Annotated[
        float, setting("Standard deviation of a disparity", "px", "FACTS.md", ge=0)
    ] = 0.08
    disparity_step: Annotated[
        float, setting("Disparities are multiples of this", "px", _D435, gt=0, le=1)
    ] = 0.03125
    depth_low: Annotated[float, setting("Nothing nearer has depth", "m", _D435, ge=0)] = 0.28
    depth_high: Annotated[float, setting("Nothing farther has depth", "m", _D435, gt=0)] = 10.0
    glass_depth: Annotated[
        float, setting("Share of pixels with depth on a pane", "1", _CHOICE, ge=0, le=1)
    ] = 0.1
    edge_loss: Annotated[
        float, setting("Share of pixels at a depth step that lose it", "1", _CHOICE, ge=0, le=1)
    ] = 0.7
    dropout: Annotated[
        float, setting("Share of depth lost by chance", "1", _CHOICE, ge=0, le=1)
    ] = 0.005
    rgb_noise: Annotated[
        float, setting("Standard deviation of a colour value of 255", "1", _CHOICE, ge=0, le=255)
    ] = 2.5
    position: Annotated[
        tuple[float, float, float], setting("Sensor in base: x, y, z", "m", _SPOT)
    ] = (0.38, 0.0, 0.22)
    pitch: Annotated[
        float, setting("How far the camera looks up", "rad", _CHOICE, ge=-1.5, le=1.5)
    ] = 0.1
    fallback_width: Annotated[
        int, setting("Image width without GL; the height in proportion", "px", _CHOICE, ge=16)
    ] = 320


class RobotConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """How the robot moves: a walking robot of Spot's size at a walking pace."""

    radius: Annotated[
        float, setting("Space the robot keeps clear of obstacles", "m", _SPOT, gt=0, le=2)
    ] = 0.3
    tight_radius: Annotated[
        float, setting("Space it accepts in narrow doors", "m", _SPOT, gt=0, le=2)
    ] = 0.24
    body_height: Annotated[
        float, setting("Base above the floor when standing", "m", _SPOT, gt=0, le=5)
    ] = 0.52
    speed: Annotated[float, setting("Walking speed", "m/s", "issue 4", gt=0, le=5)] = 0.9
    acceleration: Annotated[float, setting("Along the path", "m/s2", _CHOICE, gt=0, le=10)] = 0.6
    turn_rate: Annotated[float, setting("Largest turn rate", "rad/s", _SPOT, gt=0, le=5)] = 0.8
    turn_acceleration: Annotated[float, setting("Of the heading", "rad/s2", _CHOICE, gt=0)] = 1.2
    look_radius: Annotated[
        float, setting("A look around covers walls this near", "m", f"{_CHOICE}: depth noise", gt=0)
    ] = 4.5
    look_turn: Annotated[
        float, setting("Angle turned at a look around; 0: none", "rad", "issue 4", ge=0, le=20)
    ] = 6.2832
    gait: Annotated[float, setting("Steps a second", "Hz", _SPOT, gt=0, le=10)] = 2.2
    bob: Annotated[float, setting("Height amplitude of the steps", "m", _CHOICE, ge=0, le=0.2)] = (
        0.008
    )
    sway: Annotated[
        float, setting("Roll and pitch amplitude of the steps", "rad", _CHOICE, ge=0, le=0.3)
    ] = 0.012


class OdometryConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Leg odometry: what it adds up goes wrong with distance and turns (``odometry.py``)."""

    rate: Annotated[float, setting("Messages a second", "Hz", _SPOT, gt=0, le=1000)] = 50.0
    scale: Annotated[float, setting("Error of the step length, a run", "1", _CHOICE, ge=0)] = 0.008
    slip: Annotated[
        float, setting("Position noise a root metre walked", "m/sqrt(m)", _CHOICE, ge=0)
    ] = 0.01
    turn_slip: Annotated[
        float, setting("Heading noise a root radian turned", "rad/sqrt(rad)", _CHOICE, ge=0)
    ] = 0.008
    walk_slip: Annotated[
        float, setting("Heading noise a root metre walked", "rad/sqrt(m)", _CHOICE, ge=0)
    ] = 0.004
    climb: Annotated[
        float, setting("Height noise a root metre walked", "m/sqrt(m)", _CHOICE, ge=0)
    ] = 0.003
    tilt: Annotated[float, setting("Roll and pitch noise", "rad", _CHOICE, ge=0, le=1)] = 0.002


class SimConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Settings of the sim stage."""

    world: WorldConfig = msgspec.field(default_factory=WorldConfig)
    lidar: LidarConfig = msgspec.field(default_factory=LidarConfig)
    camera: CameraConfig = msgspec.field(default_factory=CameraConfig)
    robot: RobotConfig = msgspec.field(default_factory=RobotConfig)
    odometry: OdometryConfig = msgspec.field(default_factory=OdometryConfig)
    start: Annotated[float, setting("Stamp of the first message", "s", _CHOICE, ge=0)] = 1000.0
    map_shift: Annotated[
        float,
        setting(
            "The map's origin lies at most this far from the robot's start", "m", _CHOICE, ge=0
        ),
    ] = 5.0
