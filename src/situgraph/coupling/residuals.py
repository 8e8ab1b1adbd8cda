"""How large the errors are, read off the residuals: variance components a posteriori.

The factors are weighed by what sensors and builders are usually worth. How well this map and this
building really agree shows afterwards: in the residuals of the sightings, of which there are many
more than unknowns (the variance of unit weight of a geodetic adjustment), and in how far most walls
stand from their plan. The standard deviations are stated with these, not with the usual ones.
"""

from __future__ import annotations

import math
from collections import Counter
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from situgraph.geometry.poses import Array

if TYPE_CHECKING:
    from situgraph.coupling.config import CouplingConfig
    from situgraph.coupling.problem import Problem

NORMAL = 1.4826  # standard deviation of a normal distribution by its median deviation (MAD)
CLEAN = 3.0  # standard deviations; sightings farther off are mistakes, not noise
LEAST_SEEN = 4  # sightings of a plane, before they say something of their own noise
LEAST_SIGHTINGS = 20  # in all
PLACEMENT = 3  # unknowns of the building in the plan
LEAST_RATIO = 0.05  # noise is never smaller than this against what is usual


class Scales(NamedTuple):
    """What the residuals say of a building and its map.

    ``map`` is the noise of the map's factors against what they state; ``offset`` (m) and ``angle``
    (rad) are how near to their plan the walls stand.
    """

    map: float
    offset: float
    angle: float


def scales(problem: Problem, values: Any, config: CouplingConfig) -> Scales:
    """Read the scales off a solution; what cannot be told has its usual size."""
    turned = np.array([f.unwhitenedError(values) for f in problem.between]).reshape(-1, 6)
    return Scales(
        _of_the_map(problem, values),
        _built(turned[:, 3], config.built_offset),
        _built(turned[:, 2], config.built_angle),
    )


def _built(residuals: Array, usual: float) -> float:
    """How near walls stand to their plan: most of them, so that moved ones do not count."""
    free = len(residuals) - PLACEMENT
    if free <= 0:
        return usual
    spread = NORMAL * float(np.median(np.abs(residuals))) * math.sqrt(len(residuals) / free)
    return min(max(spread, LEAST_RATIO * usual), usual)


def _of_the_map(problem: Problem, values: Any) -> float:
    """Residuals of the offsets of walls seen often, in the standard deviations they state."""
    factors, keyframes = problem.evidence.factors, set(problem.evidence.keyframes.values())
    planes = set(problem.evidence.planes.values())
    sightings, rows = [], 0
    for slot in range(factors.size()):
        factor = factors.at(slot)
        rows += factor.dim()
        keys = factor.keys()
        if len(keys) == 2 and keys[0] in keyframes and keys[1] in planes:
            sightings.append((keys[1], factor))
    often = Counter(plane for plane, _ in sightings)
    seen = [f.whitenedError(values)[2] for plane, f in sightings if often[plane] >= LEAST_SEEN]
    free = rows - problem.evidence.values.dim()
    if len(seen) < LEAST_SIGHTINGS or free <= 0:
        return 1.0
    off = np.abs(np.array(seen))
    clean = off[off <= CLEAN * NORMAL * float(np.median(off))]
    spread = math.sqrt(float(np.mean(clean**2)) * rows / free)
    return max(spread, LEAST_RATIO)
