"""Vertical planes of one scan: Hough over direction, then offset, then trimmed least squares.

The votes are surface directions, not point pairs: first the few directions walls have, then, for
each, the offsets at which points lie. Each straight piece without a gap is fitted on its own.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from situgraph.geometry.poses import Array, wrap_angle
from situgraph.slam.config import PlaneConfig

ANGLE_BINS = 360
WIDTHS = (2.0, 1.5, *[1.0] * 8)  # of the band around a line whose points it is refitted to
KERNEL = 0.5  # of the band's; residuals this large count a quarter
VOTE_WIDTH = np.radians(10.0)  # how far a point's own direction may lie from its wall's


class Sighting(NamedTuple):
    """A straight piece of wall in one scan. Level frame of the scan, origin at the sensor.

    ``angle`` of the unit normal towards the sensor and ``offset`` > 0 (m):
    x cos(angle) + y sin(angle) + offset = 0. ``ends`` (2, 2) in the plan, ``covariance`` (2, 2) of
    (angle, offset), ``low`` and ``high`` (m) over the floor, ``points`` and their ``rms`` (m).
    ``visible`` is the height over the floor up to which the scan could have shown the piece.
    """

    angle: float
    offset: float
    ends: Array
    covariance: Array
    low: float
    high: float
    points: int
    rms: float
    visible: float = 0.0

    @property
    def normal(self) -> Array:
        """Unit normal (2,) in the plan."""
        return np.array([np.cos(self.angle), np.sin(self.angle)])

    @property
    def tangent(self) -> Array:
        """Unit direction (2,) along the wall."""
        return np.array([-np.sin(self.angle), np.cos(self.angle)])

    def distance(self, point: Array) -> float:
        """Metres in the plan from ``point`` to the middle of the piece."""
        return float(np.linalg.norm(self.ends.mean(axis=0) - point[:2]))

    @property
    def length(self) -> float:
        """Metres from end to end."""
        return float(np.linalg.norm(self.ends[1] - self.ends[0]))


def sightings(points: Array, angles: Array, config: PlaneConfig) -> list[Sighting]:
    """Wall pieces among ``points`` (n, 3) that face the ``angles`` (n,), longest first.

    x, y are those of the level frame, z is the height over the floor.
    """
    found: list[Sighting] = []
    left = np.ones(len(points), dtype=bool)
    for angle in _directions(angles, config):
        facing = left & (np.abs(wrap_angle(angles - angle)) < VOTE_WIDTH)
        for group in _offsets(points, facing, angle, config):
            for piece in _pieces(points, group, angle, config):
                sighting, members = _fit(points, angles, piece, angle, config)
                if sighting is not None:
                    found.append(sighting)
                    left[members] = False
    return _sharp(sorted(found, key=lambda s: -s.length), config)


def _sharp(pieces: list[Sighting], config: PlaneConfig) -> list[Sighting]:
    """Without lines through steps (a wall and the frame before it): they scatter more than walls.

    How much walls scatter is taken from the longest pieces of the same scan.
    """
    if not pieces:
        return []
    noise = float(np.median([s.rms for s in pieces[: config.noise_pieces]]))
    limit = max(config.blur * noise, config.range_sigma)
    return [s for s in pieces if s.rms <= limit and s.covariance[0, 0] <= config.angle_limit**2]


def _directions(angles: Array, config: PlaneConfig) -> Iterator[float]:
    """Peaks of the histogram of angles, strongest first, each one's votes removed after it."""
    angles = angles.copy()
    for _ in range(config.directions):
        if len(angles) < config.least_points:
            return
        bins = (angles / (2 * np.pi) * ANGLE_BINS).astype(int) % ANGLE_BINS
        votes = np.bincount(bins, minlength=ANGLE_BINS).astype(float)
        smooth = sum(np.roll(votes, k) * (3 - abs(k)) for k in range(-2, 3))
        peak = (int(np.argmax(smooth)) + 0.5) / ANGLE_BINS * 2 * np.pi
        for width in (np.radians(4.0), np.radians(3.0)):
            near = np.abs(wrap_angle(angles - peak)) < width
            if not near.any():
                return
            peak += float(np.mean(wrap_angle(angles[near] - peak)))
        if near.sum() < config.least_points:
            return
        yield float(wrap_angle(peak))
        angles = angles[np.abs(wrap_angle(angles - peak)) >= VOTE_WIDTH / 2]


def _offsets(
    points: Array, facing: NDArray[np.bool_], angle: float, config: PlaneConfig
) -> Iterator[NDArray[np.intp]]:
    """Groups of the ``facing`` points that share an offset, strongest first."""
    index = np.flatnonzero(facing)
    offset = -points[index, :2] @ (np.cos(angle), np.sin(angle))
    index, offset = index[offset > 0.0], offset[offset > 0.0]
    while len(index) >= config.least_points:
        bins = (offset / config.offset_bin).astype(int)
        votes = np.bincount(bins, minlength=3)
        pair = votes[:-1] + votes[1:]
        k = int(np.argmax(pair))
        if pair[k] < config.least_points:
            return
        middle = (k + 1) * config.offset_bin
        near = np.abs(offset - middle) < 1.5 * config.offset_bin
        middle = float(np.median(offset[near]))
        near = np.abs(offset - middle) < 1.5 * config.offset_bin
        yield index[near]
        index, offset = index[~near], offset[~near]


def _pieces(
    points: Array, group: NDArray[np.intp], angle: float, config: PlaneConfig
) -> Iterator[NDArray[np.intp]]:
    """The group cut where nothing lies on the line for more than a gap; far points lie wider."""
    xy = points[group, :2]
    for piece in _runs(xy, np.array([-np.sin(angle), np.cos(angle)]), config):
        if len(piece) >= config.least_points:
            yield group[piece]


def _runs(xy: Array, tangent: Array, config: PlaneConfig) -> list[NDArray[np.intp]]:
    """Indices of the points (n, 2) of each run without a gap along ``tangent``, in its order."""
    along = xy @ tangent
    order = np.argsort(along, kind="stable")
    step = np.diff(along[order])
    reach = np.linalg.norm(xy[order], axis=1)
    gap = config.gap + 0.02 * np.minimum(reach[:-1], reach[1:])
    return np.split(order, np.flatnonzero(step > gap) + 1)


def _fit(
    points: Array, angles: Array, piece: NDArray[np.intp], angle: float, config: PlaneConfig
) -> tuple[Sighting | None, NDArray[np.intp]]:
    """A line through the piece, refitted to the points near it; None when it is no wall.

    Of what is near the line the longest run counts: past the end of a wall the leaf of an open
    door may cross its line.
    """
    xy = points[piece, :2]
    weights = np.ones(len(piece))
    near = np.ones(len(piece), dtype=bool)
    for width in WIDTHS:
        normal, offset = _line(xy[near], weights[near])
        facing = float(np.arctan2(normal[1], normal[0]))
        if np.abs(wrap_angle(facing - angle)) > VOTE_WIDTH:
            return None, piece[near]
        residual = xy @ normal + offset
        near = np.abs(residual) < width * config.thickness
        near[near] = _longest_run(xy[near], normal, config)
        if near.sum() < config.least_points:
            return None, piece[near]
        weights = (1.0 + (residual / (KERNEL * config.thickness)) ** 2) ** -2
    members = piece[near]
    if abs(float(np.median(wrap_angle(angles[members] - facing)))) > config.skew:
        return None, members  # its surfaces face another way: a line through a step
    tangent = np.array([-normal[1], normal[0]])
    along = points[members, :2] @ tangent
    rms = float(np.sqrt(np.mean((points[members, :2] @ normal + offset) ** 2)))
    low, high = float(along.min()), float(along.max())
    heights = points[members, 2]
    if high - low < config.least_length or np.ptp(heights) < config.least_height:
        return None, members
    foot = -offset * normal
    return (
        Sighting(
            facing,
            offset,
            np.array([foot + low * tangent, foot + high * tangent]),
            _covariance(along, rms, config),
            float(heights.min()),
            float(heights.max()),
            len(members),
            rms,
        ),
        members,
    )


def _line(xy: Array, weights: Array) -> tuple[Array, float]:
    """Normal (2,) towards the sensor and offset of the line that fits points (n, 2) best."""
    centre = np.average(xy, axis=0, weights=weights)
    x, y = (xy - centre).T
    across, down, mixed = weights @ (x * x), weights @ (y * y), weights @ (x * y)
    along = 0.5 * math.atan2(2.0 * mixed, across - down)
    normal = np.array([-math.sin(along), math.cos(along)])
    normal = -normal if normal @ centre > 0 else normal
    return normal, -float(normal @ centre)


def _longest_run(xy: Array, normal: Array, config: PlaneConfig) -> NDArray[np.bool_]:
    """Which points (n, 2) are of the run with the most of them along a line."""
    out = np.zeros(len(xy), dtype=bool)
    out[max(_runs(xy, np.array([-normal[1], normal[0]]), config), key=len)] = True
    return out


def _covariance(along: Array, rms: float, config: PlaneConfig) -> Array:
    """Covariance of (angle, offset): of the line fit, plus what does not average out.

    A turn by t about the middle of the piece changes the offset at the sensor by t x middle.
    """
    noise = max(rms, config.range_sigma)
    middle = float(along.mean())
    spread = float(((along - middle) ** 2).sum())
    turn = noise**2 / max(spread, 1e-6) + config.angle_floor**2
    shift = noise**2 / len(along) + config.offset_floor**2
    # x(s) = -offset n + s t; turning the normal by +e moves the line at s by -s e.
    return np.array([[turn, -turn * middle], [-turn * middle, shift + turn * middle**2]])
