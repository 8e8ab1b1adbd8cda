"""The hypothesis that the plan is mirrored: definition, section 4.

A building and its mirror image are made of the same rooms, so a robot in the one fits many places
of the other but for a few walls. Where the mirror image of what was seen fits the plan better than
what was seen, it is rather the plan that is wrong.
"""

from __future__ import annotations

import math

import numpy as np

from situgraph.matching.candidates import Known, find
from situgraph.matching.posterior import Posterior, log_spread
from situgraph.matching.preparation import Inputs
from situgraph.matching.semantics import in_one_room, most_evidence
from situgraph.matching.tables import Aim, Floats

SLACK = 1e-6  # of L, for rounding
LEAST_LOSS = 1e-9  # of a room, above zero


def log_mirror(inputs: Inputs, posterior: Posterior, known: Known) -> tuple[float, bool]:
    """Ln W of 'the plan is mirrored', or -inf where it cannot change the verdict ``unique``.

    And whether the search for it was complete.
    """
    config = inputs.config
    if config.mirror_prior <= 0:
        return -math.inf, True
    log_prior = math.log(config.mirror_prior) + log_spread(inputs.index.area, config)
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
        most += float(alone.sum()) + together
        loss += in_one_room(inputs.objects, alone, rooms)
    loss -= _others(inputs)
    most -= float(np.minimum(loss, 0.0).sum())
    loss = np.maximum(loss, LEAST_LOSS)
    budget = most - least + SLACK
    ranked = np.sort(loss)
    spared = int((ranked.cumsum() <= budget).sum())
    # Rooms that lose more than most are not told apart, so that groups can be formed of any.
    median = (ranked[(rooms - 1) // 2] + ranked[rooms // 2]) / 2
    return Aim(max(inputs.least, rooms - spared), np.minimum(loss, median), budget)


def _others(inputs: Inputs) -> Floats:
    """What each online room says at most where it is not explained."""
    limits, shape = inputs.limits, inputs.seen.shape
    told = np.log1p(limits.other_room * limits.shape_gain**shape)
    return np.where(shape > 0, told, 0.0)


def _losses(inputs: Inputs) -> Floats:
    """What each online room's walls at least take from the largest L when it is not explained.

    A plane that other rooms share may still fit in those.
    """
    limits = inputs.limits
    lost = max(limits.room_true - limits.room_false, 0.0)
    return np.asarray(lost + inputs.seen.own * limits.fit_peak, dtype=float)
