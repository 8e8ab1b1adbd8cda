"""Candidates from peaks, their weights against 'not in this plan', and the verdict: section 5."""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math
from typing import Literal, NamedTuple

import numpy as np

from situgraph.matching.compiled import entry
from situgraph.matching.config import MatchingConfig
from situgraph.matching.slack import wrapped
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


def log_outside(alike: Ints, seen: Seen, prior_rooms: int, config: MatchingConfig) -> float:
    """Ln W of 'not in this plan': another building is made of similar rooms, wall to wall."""
    tied = int(seen.tied[0]) * math.log1p(config.p_tied * config.shape_gain)
    return math.log(config.outside_prior) + log_alike(alike, seen, prior_rooms, config) + tied


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
    z, yaw, x, y, height = peaks.T
    order = np.lexsort((y, x, yaw, z, -height.round(9)))
    order = order[distinct(peaks[order], config.same_distance, config.same_yaw, config.same_height)]
    candidate = peaks[order]
    weight = candidate[:, 4] + math.log(1 - config.outside_prior) + spread
    top = max(outside, float(weight[0])) if len(weight) else outside
    share = np.exp(weight - top)
    away, inside = math.exp(outside - top), float(share.sum())
    total = inside + away
    probability = share / total
    verdict: Verdict = "none"
    solutions = 0
    if len(weight) and away <= inside:
        solutions = int(np.count_nonzero(share >= config.rival_ratio * share[0]))
        rivals = inside if filtered else total
        unique = solutions == 1 and share[0] >= config.unique_probability * rivals
        verdict = "unique" if unique else "ambiguous"
    sums = (away / total, verdict, top + math.log(total))
    return Posterior(candidate, shift[order], probability, solutions, *sums)
