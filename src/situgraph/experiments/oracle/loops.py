"""The brute force's inner loops, compiled: the same plain steps, a hundred times as fast.

They try everything there is to try, one after the other; what they are called with and what comes
out are numpy arrays.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple, TypeVar

import numba
import numpy as np
from numba.extending import register_jitable

from situgraph.experiments.oracle.definition import Terms
from situgraph.experiments.oracle.problem import Flags, Numbers, Stack
from situgraph.geometry.poses import Array

F = TypeVar("F", bound=Callable[..., Any])
Real = TypeVar("Real", float, Array)


def compiled(function: F) -> F:
    """Compile when first called, and keep the result where a folder can be written."""
    try:
        made: F = numba.njit(cache=True)(function)
    except RuntimeError:  # numba has no place for it
        made = numba.njit(function)
    return made


def usable_in_loops(function: F) -> F:
    """Leave the function as it is, and compile it with those that call it."""
    made: F = register_jitable(function)
    return made


@usable_in_loops
def wrapped(angle: float) -> float:
    """The angle between -pi and pi."""
    return (angle + math.pi) % (2 * math.pi) - math.pi


@compiled
def explains(fitting: Flags, crossed: Flags) -> bool:
    """Section 2's conditions on an assignment, given which planes of the room fit.

    ``crossed`` tells which planes are not parallel.
    """
    rows = len(fitting)
    if rows == 2 or not crossed.any():
        return bool(fitting.all())
    for i in range(rows):
        for k in range(i):
            if fitting[i] and fitting[k] and crossed[i, k]:
                return True
    return False


@compiled
def best_assignment(
    possible: Flags, fits: Flags, terms: Array, crossed: Flags, missing: float, choice: Numbers
) -> float:
    """The largest score of an injective assignment that explains, at most one row left out.

    All of them are tried, in the order of the columns. ``terms`` are the scores of the pairs,
    ``missing`` that of a row left out; the best goes into ``choice`` (-1: left out).
    """
    rows, columns = possible.shape
    at = np.full(rows, -1)
    used = np.zeros(columns + 1, dtype=np.bool_)
    fitting = np.zeros(rows, dtype=np.bool_)
    sums = np.zeros(rows + 1)
    best, row = -np.inf, 0
    while row >= 0:
        if at[row] >= 0:
            used[at[row]] = False
        j = at[row] + 1
        # The column after the last stands for a row left out.
        while j <= columns and (used[j] or (j < columns and not possible[row, j])):
            j += 1
        if j > columns:
            at[row] = -1
            row -= 1
            continue
        at[row], used[j] = j, True
        fitting[row] = j < columns and fits[row, j]
        sums[row + 1] = sums[row] + (terms[row, j] if j < columns else missing)
        if row < rows - 1:
            row += 1
        elif sums[rows] > best and explains(fitting, crossed):
            best = float(sums[rows])
            for i in range(rows):
                choice[i] = at[i] if at[i] < columns else -1
    return best


@usable_in_loops
def fit_term(terms: Terms, offset: Real, angle: Real) -> Real:
    """Log ratio of a plane that fits; numbers or arrays."""
    return terms.fit - offset**2 / terms.offset_spread - angle**2 / terms.angle_spread


@usable_in_loops
def moved_term(terms: Terms, angle: Real) -> Real:
    """Log ratio of a moved plane; numbers or arrays."""
    return terms.moved - angle**2 / terms.angle_spread


class Limits(NamedTuple):
    """What two planes may differ by: radians, metres."""

    angle: float
    moved: float
    fit: float


@compiled
def explain_pairs(
    mine: Stack,
    theirs: Stack,
    allowed: Flags,
    crossed: Flags,
    limits: Limits,
    terms: Terms,
    few: float,
    pairs: Numbers,
    yaw: float,
    centers: Array,
    scores: Array,
    choices: Numbers,
    residuals: Array,
) -> None:
    """The best assignment of each of ``pairs`` (k, 2) of rooms, whose centres go to ``centers``.

    ``scores`` (k,), ``choices`` (k, planes) and ``residuals`` (k, planes, 2: angle, offset) are
    filled in. The score of what is not explained is minus infinity, that of a pair of more than
    ``few`` assignments NaN.
    """
    for n in range(len(pairs)):
        r, a = pairs[n]
        top, left = mine.first[r], theirs.first[a]
        rows, columns = mine.first[r + 1] - top, theirs.first[a + 1] - left
        angle, offset = np.empty((rows, columns)), np.empty((rows, columns))
        score = np.empty((rows, columns))
        possible, fits = angle < 0, angle < 0
        bare, ways = 0, 1.0
        for i in range(rows):
            options = 0
            for j in range(columns):
                p, q = top + i, left + j
                angle[i, j] = wrapped(mine.angles[p] + yaw - theirs.angles[q])
                reach = theirs.normals[q, 0] * centers[r, 0] + theirs.normals[q, 1] * centers[r, 1]
                offset[i, j] = mine.distances[p] - (reach + theirs.offsets[q])
                possible[i, j] = (
                    abs(angle[i, j]) <= limits.angle
                    and abs(offset[i, j]) <= limits.moved
                    and allowed[p, q]
                )
                fits[i, j] = possible[i, j] and abs(offset[i, j]) <= limits.fit
                if fits[i, j]:
                    score[i, j] = fit_term(terms, offset[i, j], angle[i, j])
                else:
                    score[i, j] = moved_term(terms, angle[i, j])
                options += possible[i, j]
            bare += options == 0
            ways *= options + 1
        scores[n] = -np.inf if bare > 1 else np.nan
        if bare <= 1 and ways <= few:
            block = crossed[top : top + rows, top : top + rows]
            scores[n] = best_assignment(possible, fits, score, block, terms.missing, choices[n])
        if scores[n] > -np.inf:
            for i in range(rows):
                j = choices[n, i]
                if j >= 0:
                    residuals[n, i] = angle[i, j], offset[i, j]


class Crowd(NamedTuple):
    """Some room pairs (k, 2), and those plane pairs of each that have the same direction.

    Room pair ``n`` has the plane pairs ``first[n]:first[n + 1]``; their residual at a place ``x``
    is ``gaps - normals.x``. ``planes`` (L, 2) count from the first plane of their rooms.
    """

    rooms: Numbers
    first: Numbers
    planes: Numbers
    normals: Array
    gaps: Array


@compiled
def vertices(crowd: Crowd, limits: Limits, low: Array, high: Array, least: int) -> Array:
    """All points (k, 2) where two tolerance lines cross, in the boxes of ``least`` online rooms.

    The lines of a plane pair are those where it ceases to fit, and to be moved. Room pair ``n`` has
    the box from ``low[n]`` to ``high[n]``.
    """
    steps = (-limits.moved, -limits.fit, limits.fit, limits.moved)
    found, count = np.empty((64, 2)), 0
    lines = 4 * len(crowd.gaps)
    for one in range(lines):
        n = crowd.normals[one // 4]
        u = crowd.gaps[one // 4] + steps[one % 4]
        for two in range(one + 1, lines):
            m = crowd.normals[two // 4]
            cross = n[0] * m[1] - n[1] * m[0]
            if abs(cross) <= 1e-6:
                continue
            v = crowd.gaps[two // 4] + steps[two % 4]
            x = (u * m[1] - v * n[1]) / cross
            y = (v * n[0] - u * m[0]) / cross
            depth, last = 0, -1
            for k in range(len(low)):
                room = crowd.rooms[k, 0]
                if (
                    room != last
                    and low[k, 0] - 1e-6 <= x <= high[k, 0] + 1e-6
                    and low[k, 1] - 1e-6 <= y <= high[k, 1] + 1e-6
                ):
                    depth, last = depth + 1, room
            if depth >= least:
                if count == len(found):
                    found = np.concatenate((found, np.empty_like(found)))
                found[count] = x, y
                count += 1
    return found[:count]


@compiled
def what_holds(
    crowd: Crowd,
    limits: Limits,
    crossed: Flags,
    mine: Stack,
    theirs: Stack,
    points: Array,
) -> tuple[Flags, Flags, Numbers]:
    """What of a crowd holds at ``points`` (k, 2).

    Returns: (k, pairs) which room pairs are explained; (k, pairs + 2 L) for each room pair whether
    it is explained, then, if so, which of its plane pairs are near and which fit; (k,) how many
    plane pairs of explained rooms fit.
    """
    size = len(crowd.rooms)
    good = np.zeros((len(points), size), dtype=np.bool_)
    states = np.zeros((len(points), size + 2 * len(crowd.gaps)), dtype=np.bool_)
    fitting = np.zeros(len(points), dtype=np.int64)
    for n in range(size):
        r, a = crowd.rooms[n]
        start, end = crowd.first[n], crowd.first[n + 1]
        block = crossed[mine.first[r] : mine.first[r + 1], mine.first[r] : mine.first[r + 1]]
        nothing = np.zeros((len(block), theirs.first[a + 1] - theirs.first[a]))
        near, fits = nothing > 0, nothing > 0
        choice = np.zeros(len(block), dtype=np.int64)
        column = n + 2 * start
        for k in range(len(points)):
            for p in range(start, end):
                i, j = crowd.planes[p]
                n_x, n_y = crowd.normals[p]
                offset = abs(crowd.gaps[p] - (points[k, 0] * n_x + points[k, 1] * n_y))
                near[i, j], fits[i, j] = offset <= limits.moved, offset <= limits.fit
            if best_assignment(near, fits, nothing, block, 0.0, choice) == -np.inf:
                continue
            good[k, n] = states[k, column] = True
            for p in range(start, end):
                i, j = crowd.planes[p]
                states[k, column + 1 + p - start] = near[i, j]
                states[k, column + 1 + p - start + end - start] = fits[i, j]
                fitting[k] += fits[i, j]
    return good, states, fitting


@compiled
def least_squares(
    arms: Array,
    normals: Array,
    offsets: Array,
    angles: Array,
    weights: Array,
    sigmas: tuple[float, float],
    yaw: float,
    point: Array,
) -> tuple[float, Array]:
    """The yaw and point at which weighted planes fit best (Gauss-Newton; nearly linear).

    ``sigmas`` of offsets and of angles. Planes pull by their angles with the first of ``weights``
    (k, 2), and by their offsets with the second.
    """
    offset_sigma, angle_sigma = sigmas
    size = len(angles)
    residuals, slopes = np.zeros(2 * size), np.zeros((2 * size, 3))
    x, y = point
    for _ in range(6):
        cosine, sine = math.cos(yaw), math.sin(yaw)
        for k in range(size):
            arm_x = cosine * arms[k, 0] - sine * arms[k, 1]
            arm_y = sine * arms[k, 0] + cosine * arms[k, 1]
            n_x, n_y = normals[k]
            weight = weights[k, 0] / angle_sigma
            residuals[k] = weight * wrapped(angles[k] + yaw)
            slopes[k, 0] = weight
            weight = weights[k, 1] / offset_sigma
            offset = offsets[k] - ((arm_x + x) * n_x + (arm_y + y) * n_y)
            residuals[size + k] = weight * offset
            slopes[size + k, 0] = -weight * (n_y * arm_x - n_x * arm_y)
            slopes[size + k, 1] = -weight * n_x
            slopes[size + k, 2] = -weight * n_y
        step = np.linalg.lstsq(slopes, -residuals, 1e-9)[0]
        yaw, x, y = wrapped(yaw + step[0]), x + step[1], y + step[2]
        if np.abs(step).max() < 1e-10:
            break
    return yaw, np.array([x, y])
