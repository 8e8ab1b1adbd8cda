"""Leg odometry: what a walking robot believes of its own motion.

Increments of the true motion, expressed in the body, are added up with errors: the step length is
wrong by a constant factor, feet slip along and across, the heading drifts with distance and with
turns, height drifts with distance. Roll and pitch come from gravity and do not drift.
"""

from __future__ import annotations

import numpy as np

from situgraph.geometry.poses import Array, Placement, matrix_to_pose
from situgraph.sim.config import OdometryConfig
from situgraph.sim.motion import Motion, state_matrices


def drifting(
    motion: Motion, frame: Placement, config: OdometryConfig, rng: np.random.Generator
) -> tuple[Array, Array]:
    """Times (n,) from the motion's beginning (s) and poses (n, 7) of base in the odometry frame.

    ``frame`` is the building in the odometry frame; the first pose has no error.
    """
    count = int(motion.duration * config.rate) + 1
    times = np.arange(count) / config.rate
    true = motion.at(times)
    step = np.diff(true, axis=0)
    cos, sin = np.cos(true[:-1, 5]), np.sin(true[:-1, 5])
    ahead, left = cos * step[:, 0] + sin * step[:, 1], -sin * step[:, 0] + cos * step[:, 1]
    walked = np.sqrt(np.hypot(step[:, 0], step[:, 1]))
    turned = np.sqrt(np.abs(step[:, 5]))
    noise = rng.normal(size=(5, count - 1))
    scale = 1.0 + config.scale * rng.normal()
    ahead = scale * ahead + config.slip * walked * noise[0]
    left = scale * left + config.slip * walked * noise[1]
    turn = step[:, 5] + config.turn_slip * turned * noise[2] + config.walk_slip * walked * noise[3]
    start = frame.points(true[:1, :3])[0]
    yaw = true[0, 5] + frame.yaw + np.r_[0.0, np.cumsum(turn)]
    dx = np.cos(yaw[:-1]) * ahead - np.sin(yaw[:-1]) * left
    dy = np.sin(yaw[:-1]) * ahead + np.cos(yaw[:-1]) * left
    believed = true.copy()
    believed[:, 0] = start[0] + np.r_[0.0, np.cumsum(dx)]
    believed[:, 1] = start[1] + np.r_[0.0, np.cumsum(dy)]
    believed[:, 2] += frame.z + np.r_[0.0, np.cumsum(config.climb * walked * noise[4])]
    believed[1:, 3:5] += config.tilt * rng.normal(size=(count - 1, 2))
    believed[:, 5] = yaw
    return times, matrix_to_pose(state_matrices(believed))
