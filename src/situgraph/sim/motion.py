"""From a route to a motion in time: walking pace, turns, looks around, the bob of the gait."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from situgraph.geometry.poses import Array, wrap_angle
from situgraph.sim.config import RobotConfig
from situgraph.sim.route import Leg

RATE = 200.0  # Hz, samples of a motion
_PAUSE = 1.0  # s, standing still at start and end
_SOFT = 0.08  # s, deviation of the filter that rounds accelerations
_STEP = 0.02  # m, samples of a path
_AHEAD = 0.15  # m, deviation of the filter over a path's direction
_SMALL = 0.05  # rad, a turn on the spot below this is left out
_SLOW = 0.6  # of the speed, on flights


@dataclass(frozen=True, eq=False)
class Motion:
    """Where base is at any time: ``states`` (n, 6) are x, y, z, roll, pitch, yaw at ``RATE``.

    Metres and radians in the building frame, yaw unwrapped; time runs from 0.
    """

    states: Array

    @property
    def duration(self) -> float:
        """Length in seconds."""
        return (len(self.states) - 1) / RATE

    def at(self, times: ArrayLike) -> Array:
        """States (m, 6) at times (m,), s; before and after, the robot stands."""
        at = np.clip(np.asarray(times, dtype=float) * RATE, 0.0, len(self.states) - 1.0)
        low = np.minimum(at.astype(int), len(self.states) - 2)
        part = (at - low)[:, None]
        return np.asarray(self.states[low] * (1 - part) + self.states[low + 1] * part)

    def matrices(self, times: ArrayLike) -> Array:
        """Base in the building (m, 4, 4) at times (m,)."""
        return state_matrices(self.at(times))


def state_matrices(states: Array) -> Array:
    """Homogeneous matrices (m, 4, 4) of states (m, 6): yaw, pitch, roll about own axes."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(states[:, 3:].T), np.sin(states[:, 3:].T)
    m = np.zeros((len(states), 4, 4))
    m[:, 0, :3] = np.stack([cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr], axis=1)
    m[:, 1, :3] = np.stack([sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr], axis=1)
    m[:, 2, :3] = np.stack([-sp, cp * sr, cp * cr], axis=1)
    m[:, :3, 3] = states[:, :3]
    m[:, 3, 3] = 1.0
    return m


def move(legs: Sequence[Leg], config: RobotConfig, rng: np.random.Generator) -> Motion:
    """The motion along ``legs``: turn to the way, walk it, look around; gait on top."""
    yaw = _heading(legs)
    at = np.array([*legs[0].path[0], yaw])
    pieces = [(np.array([0.0, _PAUSE]), np.stack([at, at]))]
    for leg in legs:
        path = _even(leg.path)
        if len(path) > 1:
            course = _course(path)
            turn = float(wrap_angle(course[0] - at[3]))
            if abs(turn) > _SMALL:
                pieces.append(_turn(at, turn, config))
            at = pieces[-1][1][-1]
            course = course - course[0] + at[3] + (0.0 if abs(turn) > _SMALL else turn)
            pieces.append(_walk(path, course, config))
            at = pieces[-1][1][-1]
        if leg.look:
            pieces.append(_turn(at, leg.look, config))
            at = pieces[-1][1][-1]
    pieces.append((np.array([0.0, _PAUSE]), np.stack([at, at])))
    return Motion(_with_gait(_sampled(pieces), config, rng))


def _heading(legs: Sequence[Leg]) -> float:
    for leg in legs:
        path = _even(leg.path)
        if len(path) > 1:
            return float(_course(path)[0])
    return 0.0


def _even(path: Array) -> Array:
    """The path (n, 3) at even steps; a single point when it goes nowhere."""
    step = np.linalg.norm(np.diff(path[:, :2], axis=0), axis=1)
    path = path[np.r_[True, step > 1e-6]]
    if len(path) < 2:
        return path[:1]
    s = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(path[:, :2], axis=0), axis=1))]
    even = np.linspace(0.0, s[-1], max(int(s[-1] / _STEP) + 1, 2))
    return np.stack([np.interp(even, s, path[:, k]) for k in range(3)], axis=1)


def _course(path: Array) -> Array:
    """The direction of the path (n,), unwrapped and smoothed, radians."""
    from scipy.ndimage import gaussian_filter1d

    ahead = np.diff(path[:, :2], axis=0)
    angle = np.unwrap(np.arctan2(ahead[:, 1], ahead[:, 0]))
    return np.asarray(gaussian_filter1d(np.r_[angle, angle[-1]], _AHEAD / _STEP, mode="nearest"))


def _turn(at: Array, angle: float, config: RobotConfig) -> tuple[Array, Array]:
    """Times and states x, y, z, yaw of a turn on the spot: speed up, go on, slow down."""
    rate, gain, whole = config.turn_rate, config.turn_acceleration, abs(angle)
    ramp = min(rate / gain, np.sqrt(whole / gain))
    top = ramp * gain
    total = 2 * ramp + max(whole - top * ramp, 0.0) / top
    t = np.linspace(0.0, total, max(int(total * RATE), 2))
    up = 0.5 * gain * np.minimum(t, ramp) ** 2
    level = top * np.clip(t - ramp, 0.0, total - 2 * ramp)
    late = np.clip(t - (total - ramp), 0.0, ramp)
    turned = up + level + top * late - 0.5 * gain * late**2
    states = np.repeat(at[None], len(t), axis=0)
    states[:, 3] += np.sign(angle) * turned * whole / turned[-1]
    return t, states


def _walk(path: Array, course: Array, config: RobotConfig) -> tuple[Array, Array]:
    """Times and states x, y, z, yaw along the path, as fast as turns and accelerations allow."""
    step = np.linalg.norm(np.diff(path, axis=0), axis=1)
    bend = np.abs(np.gradient(course)) / max(float(step.mean()), 1e-9)
    climbing = np.abs(np.gradient(path[:, 2])) > 1e-4
    limit = np.minimum(config.speed, config.turn_rate / np.maximum(bend, 1e-6))
    limit = np.where(climbing, np.minimum(limit, _SLOW * config.speed), limit)
    limit[0] = limit[-1] = 0.0
    speed = limit.copy()
    for i in range(1, len(speed)):
        speed[i] = min(speed[i], np.sqrt(speed[i - 1] ** 2 + 2 * config.acceleration * step[i - 1]))
    for i in range(len(speed) - 2, -1, -1):
        speed[i] = min(speed[i], np.sqrt(speed[i + 1] ** 2 + 2 * config.acceleration * step[i]))
    mean = np.maximum((speed[:-1] + speed[1:]) / 2, 0.02)
    t = np.r_[0.0, np.cumsum(step / mean)]
    return t, np.column_stack([path, course])


def _sampled(pieces: Sequence[tuple[Array, Array]]) -> Array:
    """The pieces one after the other as states (n, 4) at ``RATE``, accelerations rounded."""
    from scipy.ndimage import gaussian_filter1d

    times, states, end = [], [], 0.0
    for t, s in pieces:
        times.append(t + end)
        states.append(s)
        end += float(t[-1])
    t, s = np.concatenate(times), np.concatenate(states)
    even = np.arange(int(end * RATE) + 1) / RATE
    sampled = np.stack([np.interp(even, t, s[:, k]) for k in range(4)], axis=1)
    return np.asarray(gaussian_filter1d(sampled, _SOFT * RATE, axis=0, mode="nearest"))


def _with_gait(states: Array, config: RobotConfig, rng: np.random.Generator) -> Array:
    """States (n, 6) of base over the floor states (n, 4): standing height, slope, bob and sway."""
    from scipy.ndimage import gaussian_filter1d

    velocity = np.gradient(states, axis=0) * RATE
    ground = np.linalg.norm(velocity[:, :2], axis=1)
    effort = np.clip(ground / config.speed + 0.5 * np.abs(velocity[:, 3]) / config.turn_rate, 0, 1)
    effort = gaussian_filter1d(effort, 0.2 * RATE, mode="nearest")
    phase = 2 * np.pi * config.gait * np.arange(len(states)) / RATE + rng.uniform(0, 2 * np.pi)
    slow = gaussian_filter1d(rng.normal(size=(3, len(states))), 0.3 * RATE, axis=1, mode="wrap")
    slow /= slow.std(axis=1, keepdims=True) + 1e-12
    slope = np.arctan2(velocity[:, 2], np.maximum(ground, 0.05))
    slope = gaussian_filter1d(np.where(ground > 0.05, slope, 0.0), 0.25 * RATE, mode="nearest")
    full = np.empty((len(states), 6))
    full[:, :2] = states[:, :2]
    # Each stride has two steps: the body rises twice and sways once.
    swing = effort * (np.sin(phase) + 0.4 * slow[0])
    full[:, 2] = states[:, 2] + config.body_height + config.bob * swing
    full[:, 3] = config.sway * effort * (np.sin(phase / 2) + 0.4 * slow[1])
    full[:, 4] = config.sway * effort * (np.cos(phase) + 0.4 * slow[2]) - slope
    full[:, 5] = states[:, 3]
    return full
