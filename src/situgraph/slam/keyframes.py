"""Keyframes: which scans, and what each one shows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from situgraph.geometry.poses import Array
from situgraph.slam.cloud import thin
from situgraph.slam.config import KeyframeConfig, PlaneConfig
from situgraph.slam.ground import Floor, floor
from situgraph.slam.level import levelling, tilt
from situgraph.slam.motion import size
from situgraph.slam.sightings import Sighting, sightings
from situgraph.slam.surfaces import surfaces


@dataclass(frozen=True)
class View:
    """What one scan shows, in the level frame: base turned so that z is up.

    ``up`` (3,) and ``tilt_sigma`` (rad): up in base. ``level`` (3, 3) turns base to the level
    frame, ``points`` (n, 3) are level, ``cloud`` (m, 3) is kept in base.
    """

    up: Array
    tilt_sigma: float
    level: Array
    floor: Floor | None
    sightings: list[Sighting]
    cloud: NDArray[np.float32]
    points: Array


@dataclass
class Keyframe:
    """A scan that is kept: its number, stamp (s), first pose and what it shows."""

    number: int
    stamp: float
    odometry: Array
    view: View
    storey: int = 0


def due(motion: Array, config: KeyframeConfig) -> bool:
    """Whether a robot that moved by ``motion`` (4x4) since the last keyframe needs a new one."""
    length, angle = size(motion)
    return length >= config.distance or angle >= config.angle


def view(points: Array, attitude: Array, sensor: Array, planes: PlaneConfig, keep: float) -> View:
    """Walls, floor and tilt of a deskewed scan.

    Args:
        points: (n, 3) metres in base.
        attitude: (3, 3) rotation from base to a frame that is level but for a small error.
        sensor: (3,) origin of the LiDAR in base.
        planes: settings.
        keep: voxel (m) of the cloud that is kept.
    """
    rough = thin(points, planes.voxel) @ attitude.T
    origin = attitude @ sensor
    seen = surfaces(rough - origin, planes.reach)
    found = tilt(seen.sheets, planes.tilt_prior, planes.tilt_noise, planes.tilt_limit)
    fine = levelling(found.up)
    level = fine @ attitude
    turned = rough @ fine.T
    base = fine @ origin
    near = np.linalg.norm(turned[:, :2], axis=1) < planes.floor_range
    ground = floor(turned[near], planes.floor_lowest, planes.floor_highest, planes.floor_points)
    walls = seen.walls @ fine.T + base
    if ground is not None:
        above = walls[:, 2] - ground.height
        usable = (above > 0.1) & (above < planes.top)
    else:
        usable = np.ones(len(walls), dtype=bool)
    pieces = sightings(walls[usable], seen.angles[usable], planes)
    return View(
        up=level.T @ np.array([0.0, 0.0, 1.0]),
        tilt_sigma=float(np.hypot(found.sigma, planes.tilt_floor)),
        level=level,
        floor=ground,
        sightings=pieces,
        cloud=thin(points, keep).astype(np.float32),
        points=turned,
    )
