"""Candidates from peaks, their weights against 'not in this plan', and the verdict: section 5."""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math
from typing import Literal, NamedTuple

import numpy as np

from situgraph.matching.compiled import entry, part
from situgraph.matching.config import MatchingConfig
from situgraph.matching.slack import wrapped
from situgraph.matching.tables import Floats, Ints, Seen

Verdict = Literal["unique", "ambiguous", "none"]
CELLS = 1024  # of peaks, a power of two


class Posterior(NamedTuple):
    """Candidates best first: (k, 5) height, yaw, x, y, L; and what they are worth."""

    candidate: Floats
    shift: Ints
    probability: Floats
    solutions: int
    outside: float
    verdict: Verdict
    total: float  # ln of the sum of all weights


@entry
def weigh(peaks, candidates, order, spare, cell, share, same, constant, outside, ratio):
    """Rank peaks (height, yaw, x, y, L): those that no better one is the same as, best first.

    ``same``: metres, radians and metres of height to which peaks are the same; ``cell`` and
    ``spare`` are room to work in, the former all zeros. Into ``candidates``
    go those left, into ``order`` their rows, into ``share`` their probabilities: the logarithms of
    their weights are L and ``constant``, against ``outside``. Returns how many there are, how many
    weigh no less than ``ratio`` of the best, their probability, and ln of the sum of all weights.
    """
    _sort(peaks, order, spare)
    count = _distinct(peaks, order, spare, cell, same)
    top = max(outside, peaks[order[0], 4] + constant) if count > 0 else outside
    inside, solutions = 0.0, 0
    for k in range(count):
        for c in range(5):
            candidates[k, c] = peaks[order[k], c]
        share[k] = math.exp(candidates[k, 4] + constant - top)
        inside += share[k]
        solutions += share[k] >= ratio * share[0]
    total = inside + math.exp(outside - top)
    for k in range(count):
        share[k] /= total
    return count, solutions, inside / total, top + math.log(total)


@part
def _sort(peaks, order, spare):
    """Rows of peaks, best first: by L to nine digits, then by height, yaw, x, y."""
    n, width = len(order), 1
    for k in range(n):
        order[k] = k
    while width < n:
        for begin in range(0, n, 2 * width):
            _merge(peaks, order, spare, begin, min(begin + width, n), min(begin + 2 * width, n))
        for k in range(n):
            order[k] = spare[k]
        width *= 2


@part
def _merge(peaks, order, spare, begin, middle, end):
    """Two sorted runs into one."""
    i, j = begin, middle
    for k in range(begin, end):
        if j == end or (i < middle and not _before(peaks, order[j], order[i])):
            spare[k] = order[i]
            i += 1
        else:
            spare[k] = order[j]
            j += 1


@part
def _before(peaks, i, k):
    one, two = math.floor(peaks[i, 4] * 1e9 + 0.5), math.floor(peaks[k, 4] * 1e9 + 0.5)
    if one != two:
        return one > two
    for c in range(4):
        if peaks[i, c] != peaks[k, c]:
            return peaks[i, c] < peaks[k, c]
    return False


@part
def _distinct(peaks, order, linked, cell, same):
    """Keep in ``order`` those that no better kept one is the same as; returns how many.

    They are found by cells of the plan as wide as the same peaks are apart at most: ``cell`` is the
    number of the last one kept, plus 1, and ``linked`` that of the one before each.
    """
    count, width = 0, same[0]
    for k in order:
        x, y = math.floor(peaks[k, 2] / width), math.floor(peaks[k, 3] / width)
        if _is_kept(peaks, k, order, linked, cell, x, y, same):
            continue
        at = _cell(x, y, len(cell))
        order[count], linked[count] = k, cell[at]
        count += 1
        cell[at] = count
    return count


@part
def _is_kept(peaks, k, order, linked, cell, x, y, same):
    """Whether a peak that was kept is the same as peak ``k``, which is in the cell (x, y)."""
    for i in range(x - 1, x + 2):
        for j in range(y - 1, y + 2):
            m = cell[_cell(i, j, len(cell))] - 1
            while m >= 0:
                if _same(peaks, k, order[m], same[0], same[1], same[2]):
                    return True
                m = linked[m] - 1
    return False


@part
def _cell(i, j, cells):
    """Which of so many, a power of two, cells of the plan share."""
    return (i * 73856093 ^ j * 19349663) & (cells - 1)


@part
def _same(peaks, k, m, distance, yaw, height):
    dx, dy = peaks[k, 2] - peaks[m, 2], peaks[k, 3] - peaks[m, 3]
    return (
        dx * dx + dy * dy <= distance * distance
        and abs(peaks[k, 0] - peaks[m, 0]) <= height
        and abs(wrapped(peaks[k, 1] - peaks[m, 1])) <= yaw
    )


def log_alike(
    alike: Ints, seen: Seen, prior_rooms: int, config: MatchingConfig, probability: float = 1.0
) -> float:
    """Ln ratio of rooms that are, with this probability, like those of the plan."""
    gain = config.shape_gain
    shapes, most = zip(alike.tolist(), seen.shape.tolist()), max(prior_rooms, 1)
    return sum(math.log1p(probability * k / most * gain**shape) for k, shape in shapes if shape > 0)


def log_spread(area: float, sigma: float) -> float:
    """Ln of the share of all placements that one candidate stands for: four yaws times the area.

    ``sigma`` (m) is the standard deviation of offsets.
    """
    return math.log(2 * math.pi * sigma**2 / (4 * area))


def judge(
    peaks: Floats,
    shift: Ints,
    outside: float,
    spread: float,
    config: MatchingConfig,
    *,
    filtered: bool = False,
) -> Posterior:
    """Weigh the peaks (height, yaw, x, y, L) against each other and against 'not in this plan'.

    ``spread`` is ``log_spread``. ``filtered``: objects have filtered the candidates (policy
    ``containment``); the best need not be sure against ``outside`` then, which knows nothing of
    the filter.
    """
    size = len(peaks)
    order, spare = np.empty(size, dtype=np.int64), np.empty(size, dtype=np.int64)
    candidates, share, cell = np.empty((size, 5)), np.empty(size), np.zeros(CELLS, dtype=np.int64)
    same = (config.same_distance, config.same_yaw, config.same_height)
    constant = math.log(1 - config.outside_prior) + spread
    count, solutions, inside, total = weigh(
        peaks, candidates, order, spare, cell, share, same, constant, outside, config.rival_ratio
    )
    away = math.exp(outside - total)
    verdict: Verdict = "none"
    if count and away <= inside:
        rivals = inside if filtered else 1.0
        unique = solutions == 1 and share[0] >= config.unique_probability * rivals
        verdict = "unique" if unique else "ambiguous"
    else:
        solutions = 0
    found = candidates[:count], shift[order[:count]], share[:count]
    return Posterior(*found, solutions, away, verdict, total)
