"""The hypothesis that the plan is mirrored: definition, section 4.

A building and its mirror image are made of the same rooms, so a robot in the one fits many places
of the other but for a few walls. Where the mirror image of what was seen fits the plan better than
what was seen, it is rather the plan that is wrong.
"""

from __future__ import annotations

import math

from situgraph.matching.candidates import Known
from situgraph.matching.drafting import bound
from situgraph.matching.posterior import Posterior
from situgraph.matching.preparation import Inputs
from situgraph.matching.tables import CUT, Aim

SLACK = 1e-6  # of L, for rounding
# By how much less L is asked for, where nothing is found, so that it is known when more rooms come.
SPARE, SPARE_SHARE = 10.0, 0.2  # of L, and of what may be lost


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
    spare = SPARE + SPARE_SHARE * aim.budget
    if known.rules_out_mirrored(inputs, aim, lambda: aim_at(inputs, least - spare)):
        return -math.inf, True
    peaks = known.find(inputs.mirrored(), aim)
    best = float(peaks.place[:, 4].max()) if len(peaks.place) else -math.inf
    return log_prior + best if best >= least else -math.inf, not peaks.done[CUT]


def _least_that_matters(posterior: Posterior, sure: float) -> float:
    """Ln of the weight beside which the best solution is not ``sure`` any more."""
    best = float(posterior.probability[0])
    room = best / sure - 1.0
    return posterior.total + (math.log(room) if room > 0 else -math.inf)


def aim_at(inputs: Inputs, least: float) -> Aim:
    """The placements of the mirror image whose L may reach ``least``."""
    draft, rooms = inputs.draft, inputs.count
    most, spared = bound(draft.place, inputs.limits.slots.place, least - SLACK)
    return Aim(max(inputs.least, rooms - spared), draft.array("loss").copy(), most - least + SLACK)
