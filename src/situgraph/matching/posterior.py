"""Candidates from peaks, their weights against 'not in this plan', and the verdict: section 5."""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math
from typing import Literal, NamedTuple

import numpy as np

from situgraph.matching.compiled import entry
from situgraph.matching.config import MatchingConfig
from situgraph.matching.explained import wrapped
from situgraph.matching.grouping import join
from situgraph.matching.tables import Floats, Ints, Seen

Verdict = Literal["unique", "ambiguous", "none"]


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
def distinct(peaks, distance, yaw, height):
    """Rows of peaks (height, yaw, x, y, L), sorted best first.

    That no better kept one is the same as.
    """
    kept = np.empty(len(peaks), dtype=np.int64)
    count = 0
    for k in range(len(peaks)):
        alone = True
        for m in kept[:count]:
            if (
                (peaks[k, 2] - peaks[m, 2]) ** 2 + (peaks[k, 3] - peaks[m, 3]) ** 2
                <= distance * distance
                and abs(peaks[k, 0] - peaks[m, 0]) <= height
                and abs(wrapped(peaks[k, 1] - peaks[m, 1])) <= yaw
            ):
                alone = False
                break
        if alone:
            kept[count] = k
            count += 1
    return kept[:count]


@entry
def ties(first, angle, distance, center, turn, near, thick):
    """How many of the walls' places say nothing new, as rooms stand wall to wall.

    ``first`` (N + 1,) the rows of each online room, ``angle`` and ``distance`` (P,) of its walls,
    ``center`` (N, 2). Walls of two rooms tie the rooms when they are parallel to ``turn`` (rad)
    and stand on one line to ``near`` (m), or back to back and up to ``thick`` (m) apart. Counted
    are those that join what no other has joined, along each direction by itself.
    """
    rows = len(angle)
    group = np.arange(rows)
    room = np.empty(rows, dtype=np.int64)
    c, s, least = np.cos(angle), np.sin(angle), math.sin(turn)
    for r in range(len(center)):
        for i in range(first[r], first[r + 1]):
            room[i] = r
            for k in range(first[r], i):
                if abs(c[i] * s[k] - s[i] * c[k]) <= least:
                    join(group, i, k)
    count = 0
    for i in range(rows):
        for k in range(i):
            r, q = room[i], room[k]
            if r == q or abs(c[i] * s[k] - s[i] * c[k]) > least:
                continue
            # Both lines are read halfway between the two rooms.
            x, y = (center[q, 0] - center[r, 0]) / 2, (center[q, 1] - center[r, 1]) / 2
            one = distance[i] + c[i] * x + s[i] * y
            two = distance[k] - c[k] * x - s[k] * y
            if c[i] * c[k] + s[i] * s[k] > 0:
                tied = abs(one - two) <= near
            else:
                tied = -near <= -(one + two) <= thick
            if tied and join(group, i, k):
                count += 1
    return count


def log_outside(alike: Ints, seen: Seen, prior_rooms: int, config: MatchingConfig) -> float:
    """Ln W of 'not in this plan': another building is made of similar rooms, wall to wall."""
    gain = config.clutter_length / (2 * config.plane_offset_tolerance)
    share = np.where(seen.shape > 0, alike, 0) / max(prior_rooms, 1)
    tied = ties(
        seen.first,
        seen.angle,
        seen.distance,
        seen.center,
        config.angle_tolerance,
        config.plane_offset_tolerance,
        config.wall_thickness,
    )
    rooms = float(np.log1p(share * gain**seen.shape).sum())
    return math.log(config.outside_prior) + rooms + int(tied) * math.log1p(config.p_tied * gain)


def log_spread(area: float, config: MatchingConfig) -> float:
    """Ln of the share of all placements that one candidate stands for: four yaws times the area."""
    return math.log(2 * math.pi * config.plane_sigma**2 / (4 * area))


def judge(
    peaks: Floats,
    shift: Ints,
    outside: float,
    area: float,
    config: MatchingConfig,
    *,
    filtered: bool = False,
) -> Posterior:
    """Weigh the peaks (height, yaw, x, y, L) against each other and against 'not in this plan'.

    ``filtered``: objects have filtered the candidates (policy ``containment``); the best need not
    be sure against ``outside`` then, which knows nothing of the filter.
    """
    order = np.lexsort((peaks[:, 3], peaks[:, 2], peaks[:, 1], peaks[:, 0], -peaks[:, 4].round(9)))
    order = order[distinct(peaks[order], config.same_distance, config.same_yaw, config.same_height)]
    candidate = peaks[order]
    weight = candidate[:, 4] + math.log(1 - config.outside_prior) + log_spread(area, config)
    top = max(outside, float(weight[0])) if len(weight) else outside
    share = np.exp(weight - top)
    away, inside = math.exp(outside - top), float(share.sum())
    total = inside + away
    probability = share / total
    verdict: Verdict = "none"
    solutions = 0
    if len(weight) and away <= inside:
        solutions = int((share >= config.rival_ratio * share[0]).sum())
        rivals = inside if filtered else total
        unique = solutions == 1 and share[0] >= config.unique_probability * rivals
        verdict = "unique" if unique else "ambiguous"
    sums = (away / total, verdict, top + math.log(total))
    return Posterior(candidate, shift[order], probability, solutions, *sums)
