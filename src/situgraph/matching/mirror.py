"""The hypothesis that the plan is mirrored: definition, section 4.

A building and its mirror image are made of the same rooms, so a robot in the one fits many places
of the other but for a few walls. Where the mirror image of what was seen fits the plan better than
what was seen, it is rather the plan that is wrong.
"""

from __future__ import annotations

import math
from itertools import accumulate

import numpy as np

from situgraph.matching.candidates import Known, find
from situgraph.matching.posterior import Posterior
from situgraph.matching.preparation import Inputs
from situgraph.matching.semantics import most_evidence
from situgraph.matching.tables import Aim

SLACK = 1e-6  # of L, for rounding
LEAST_LOSS = 1e-9  # of a room, above zero


def log_mirror(inputs: Inputs, posterior: Posterior, known: Known) -> tuple[float, bool]:
    """Ln W of 'the plan is mirrored', or -inf where it cannot change the verdict ``unique``.

    And whether the search for it was complete.
    """
    config = inputs.config
    if config.mirror_prior <= 0:
        return -math.inf, True
    log_prior = math.log(config.mirror_prior) + inputs.log_spread
    least = _least_that_matters(posterior, config.unique_probability) - log_prior
    aim = aim_at(inputs, least)
    if aim.budget < 0:
        return -math.inf, True
    peaks = find(inputs.mirrored(), aim, known)
    best = float(peaks.place[:, 4].max(initial=-math.inf))
    return log_prior + best if best >= least else -math.inf, not peaks.done[3]


def _least_that_matters(posterior: Posterior, sure: float) -> float:
    """Ln of the weight beside which the best solution is not ``sure`` any more."""
    best = float(posterior.probability[0])
    room = best / sure - 1.0
    return posterior.total + (math.log(room) if room > 0 else -math.inf)


def aim_at(inputs: Inputs, least: float) -> Aim:
    """The placements of the mirror image whose L may reach ``least``."""
    limits, rooms = inputs.limits, len(inputs.kept)
    most = inputs.seen.planes * limits.fit_peak + rooms * max(limits.room_true, limits.room_false)
    loss = _losses(inputs)
    if inputs.weighs_objects:
        alone, together = most_evidence(inputs.objects, inputs.rates)
        most += sum(alone) + together
        for room, value in zip(inputs.objects.only, alone):
            if room >= 0:  # what is in several may be told in any
                loss[room] += value
    most -= sum(min(x, 0.0) for x in loss)
    budget = most - least + SLACK
    loss = [max(x, LEAST_LOSS) for x in loss]
    ranked = sorted(loss)
    spared = sum(lost <= budget for lost in accumulate(ranked))
    # Rooms that lose more than most are not told apart, so that groups can be formed of any.
    median = (ranked[(rooms - 1) // 2] + ranked[rooms // 2]) / 2
    told = np.array([min(x, median) for x in loss])
    return Aim(max(inputs.least, rooms - spared), told, budget)


def _losses(inputs: Inputs) -> list[float]:
    """What each online room's walls at least take from the largest L when it is not explained.

    A plane that other rooms share may still fit in those; and the room may be one like those of
    the plan.
    """
    limits, seen = inputs.limits, inputs.seen
    lost, gain = max(limits.room_true - limits.room_false, 0.0), limits.shape_gain
    return [
        lost
        + own * limits.fit_peak
        - (math.log1p(limits.other_room * gain**shape) if shape > 0 else 0.0)
        for own, shape in zip(seen.own.tolist(), seen.shape.tolist())
    ]
