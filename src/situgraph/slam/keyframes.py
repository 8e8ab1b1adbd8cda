"""Keyframes: which scans, and what each one shows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from situgraph.geometry.poses import Array
from situgraph.slam.cloud import thin
from situgraph.slam.config import SlamConfig
from situgraph.slam.freespace import free_reach
from situgraph.slam.ground import Floor, floor
from situgraph.slam.input_config import KeyframeConfig
from situgraph.slam.level import levelling, tilt
from situgraph.slam.motion import size
from situgraph.slam.sightings import Sighting, sightings
from situgraph.slam.surfaces import surfaces


@dataclass(frozen=True)
class View:
    """What one scan shows, in the level frame: base turned so that z is up.

    ``up`` (3,) and ``tilt_sigma`` (rad): up in base. ``level`` (3, 3) turns base to the level
    frame. ``reach`` (BINS,) is the free distance by direction.
    """

    up: Array
    tilt_sigma: float
    level: Array
    floor: Floor | None
    sightings: list[Sighting]
    reach: Array


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


def view(
    points: Array, attitude: Array, sensor: Array, expected_floor: float, config: SlamConfig
) -> View:
    """Walls, floor and tilt of a deskewed scan.

    Args:
        points: (n, 3) metres in base.
        attitude: (3, 3) rotation from base to a frame that is level but for a small error.
        sensor: (3,) origin of the LiDAR in base.
        expected_floor: height (m) of the floor in the level frame, where the scan shows none.
        config: settings.
    """
    planes = config.planes
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
    height = expected_floor if ground is None else ground.height
    walls = seen.walls @ fine.T + base
    above = walls[:, 2] - height
    usable = (above > planes.bottom) & (above < planes.top)
    walls[:, 2] = above
    pieces = sightings(walls[usable], seen.angles[usable], planes)
    steepest = _steepest(turned, base)
    pieces = [
        s._replace(visible=min(float(base[2]) - height + steepest * s.distance(base), planes.top))
        for s in pieces
    ]
    return View(
        up=level.T @ np.array([0.0, 0.0, 1.0]),
        tilt_sigma=float(np.hypot(found.sigma, planes.tilt_floor)),
        level=level,
        floor=ground,
        sightings=pieces,
        reach=free_reach(points @ level.T, base, height, config.rooms),
    )


def _steepest(points: Array, sensor: Array) -> float:
    """Slope of the highest beams (1: 45 deg), a few stray points left out."""
    ray = points - sensor
    return float(np.percentile(ray[:, 2] / np.hypot(ray[:, 0], ray[:, 1]), 99.5))
