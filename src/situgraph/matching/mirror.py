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
from situgraph.matching.semantics import most_evidence
from situgraph.matching.tables import Floats


def log_mirror(inputs: Inputs, posterior: Posterior, known: Known) -> tuple[float, bool]:
    """Ln W of 'the plan is mirrored', or -inf where it cannot change the verdict ``unique``.

    And whether the search for it was complete.
    """
    config = inputs.config
    if config.mirror_prior <= 0:
        return -math.inf, True
    log_prior = math.log(config.mirror_prior) + log_spread(inputs.index.area, config)
    least = _least_that_matters(posterior, config.unique_probability) - log_prior
    rooms = _least_rooms(inputs, least)
    if rooms > len(inputs.kept):
        return -math.inf, True
    image = inputs.mirrored()
    peaks = find(image, rooms, known)
    best = float(peaks.place[:, 4].max(initial=-math.inf))
    return log_prior + best, not peaks.done[3]


def _least_that_matters(posterior: Posterior, sure: float) -> float:
    """Ln of the weight beside which the best solution is not ``sure`` any more."""
    best = float(posterior.probability[0])
    room = best / sure - 1.0
    return posterior.total + (math.log(room) if room > 0 else -math.inf)


def _least_rooms(inputs: Inputs, least: float) -> int:
    """How many rooms must be explained for L to reach ``least``; N + 1 when all are not enough."""
    limits, losses = inputs.limits, np.sort(_losses(inputs))
    rooms = len(inputs.kept)
    most = inputs.seen.planes * limits.fit_peak + rooms * limits.room_true
    if inputs.weighs_objects:
        most += most_evidence(inputs.objects, inputs.rates)
    if most < least:
        return rooms + 1
    spared = int((most - np.cumsum(losses) >= least).sum())
    return max(inputs.least, rooms - spared)


def _losses(inputs: Inputs) -> Floats:
    """What each online room at least takes from the largest L when it is not explained (N,)."""
    seen, limits = inputs.seen, inputs.limits
    room = np.repeat(np.arange(len(inputs.kept)), np.diff(seen.first))
    # A plane that other rooms share may still fit in those.
    occurrences = np.bincount(seen.plane, minlength=seen.planes)
    own = np.bincount(room[occurrences[seen.plane] == 1], minlength=len(inputs.kept))
    return np.asarray(limits.room_true - limits.room_false + own * limits.fit_peak, dtype=float)
