"""What the shape of a room says wherever it stands: buildings are made of similar rooms."""

from __future__ import annotations

import functools
import math
from collections import Counter

from situgraph.experiments.oracle.problem import Problem
from situgraph.experiments.oracle.regions import Regions


def alike_anyway(problem: Problem, r: int, probability: float) -> float:
    """Log ratio of online room ``r`` when it is like the plan's rooms with this probability."""
    return math.log(1 + probability * _likelier(problem)[r])


@functools.lru_cache(maxsize=4)
def _likelier(problem: Problem) -> tuple[float, ...]:
    """For each online room how much likelier its shape is among such rooms than anywhere."""
    c, regions = problem.constants, Regions(problem)
    sharing = Counter(plane for mine in problem.seen for plane in mine.planes)
    found = []
    for r, mine in enumerate(problem.seen):
        # A room is placed by two of its walls, the others are its shape; a wall that bounds several
        # rooms is shared out among them.
        own = sum(1 / sharing[plane] for plane in mine.planes)
        walls = max(0.0, min(c.shape_walls, own) - 2)
        alike = sum(regions.fits_somewhere(r, a) for a in range(len(problem.planned)))
        gain = (c.clutter_length / (2 * c.fit_limit)) ** walls
        found.append(alike / len(problem.planned) * gain if walls > 0 else 0.0)
    return tuple(found)
