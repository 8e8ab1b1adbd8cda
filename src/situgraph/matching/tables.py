"""The flat tables the kernels work on: the online rooms, the plan, the limits.

A room's planes stand one after the other; ``first[r]`` to ``first[r + 1]`` are the rows of room
``r``. Named tuples of arrays, because that is what compiled code takes as it is.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

FIT, MOVED, MISSING = 0, 1, 2  # states of an online plane


class Limits(NamedTuple):
    """The constants of ``docs/matching.md`` that the search needs; metres, radians, logarithms."""

    fit: float
    moved: float
    angle: float
    sine: float
    fit_peak: float  # log ratio of a plane that fits without residual
    moved_base: float  # log ratio of a moved plane in its direction
    missing: float
    missing_shared: float
    room_true: float
    room_false: float
    plane_weight: float  # 1 / (2 sigma^2)
    angle_weight: float
    same_distance: float
    same_yaw: float
    smallest_step: float
    peak_step: float
    max_boxes: int


class Seen(NamedTuple):
    """The online rooms that count; lengths from the mean of their centres."""

    center: Floats  # (N, 2)
    first: Ints  # (N + 1,)
    angle: Floats  # (P,) direction of the normal
    distance: Floats  # (P,) signed distance of the room's centre
    plane: Ints  # (P,) which distinct plane
    planes: int  # how many distinct planes
    strict: Flags  # (N,) every plane must fit
    flat: Flags  # (N,) all planes are parallel
    storey: Ints  # (N,)
    shape: Floats  # (N,) how many of its planes a similar shape would explain
    crossed_first: Ints  # (N + 1,) pairs of a room's planes that are not parallel
    crossed: Ints  # (C, 2)
    probe_first: Ints  # (N + 1,) corners by which a room is looked up
    probe: Ints  # (K, 2) rows of two planes, the second counter-clockwise of the first
    probe_arm: Floats  # (K, 2) where they meet
    probe_reach: Floats  # (K,) how far the prior corner may lie off


class Plan(NamedTuple):
    """The prior rooms that count, and how they are found."""

    first: Ints  # (M + 1,)
    row: Floats  # (Q, 4) normal x, y, offset, direction of the normal
    storey: Ints  # (M,)
    near_start: Ints  # (B + 1,) buckets of corners: one lookup reaches 1.5 m
    near_room: NDArray[np.int32]
    near_tag: NDArray[np.int32]
    far_start: Ints  # the same in larger cells: one lookup reaches 6 m
    far_room: NDArray[np.int32]
    far_tag: NDArray[np.int32]
    large: Ints  # rooms with too many corners, tried everywhere
    bin_first: Ints  # (S + 1,) each storey's bins of lines of one direction
    bin_angle: Floats  # (B,)
    bin_spread: Floats  # (B,) largest difference of a line's direction from its bin's
    line_first: Ints  # (B + 1,) each bin's lines, by offset
    line_offset: Floats  # (Q,)
    line_room: Ints  # (Q,)


class Task(NamedTuple):
    """What one pass of the search is after."""

    least: int  # rooms to be explained
    storeys: Ints  # (U,) the prior storey of each online storey, -1 for none


class Case(NamedTuple):
    """Addresses (``pointers``) of all a kernel may need: tables, and room to work in."""

    seen: Any  # Seen
    plan: Any  # Plan
    limits: Any  # Limits
    content: Any  # Content
    task: Any  # Task
    finder: Any  # Finder
    bench: Any  # Bench
    options: Any  # Options
    tally: Any  # Tally
    spans: Any  # Spans
    one: Any  # View
    two: Any  # View
