"""The log likelihood ratio of a placement, and of the hypothesis 'not in this plan'."""

from __future__ import annotations

import functools
import math
from collections import defaultdict

import numpy as np

from situgraph.experiments.oracle.explained import (
    FIT,
    MISSING,
    MOVED,
    PlanePair,
    View,
)
from situgraph.experiments.oracle.loops import fit_term, moved_term
from situgraph.experiments.oracle.moved_walls import moved_together
from situgraph.experiments.oracle.objects import most_object_evidence, object_evidence
from situgraph.experiments.oracle.problem import Problem
from situgraph.experiments.oracle.shapes import alike_anyway
from situgraph.experiments.oracle.wall_lines import tied
from situgraph.geometry.poses import Array, rotation2


def wall_evidence(problem: Problem, seen: View) -> float:
    """Section 4 without objects: the distinct planes of the explained rooms, and the rooms."""
    c = problem.constants
    occurrences: dict[str, list[PlanePair]] = defaultdict(list)
    moved: dict[str, list[tuple[int, PlanePair]]] = defaultdict(list)
    for pair in seen.pairs:
        for plane in pair.planes:
            name = problem.seen[pair.r].planes[plane.i]
            occurrences[name].append(plane)
            if plane.state == MOVED:
                moved[name].append((pair.a, plane))
    total = sum(_plane_term(problem, found) for found in occurrences.values())
    fits = {name for name, found in occurrences.items() if any(p.state == FIT for p in found)}
    total += moved_together(problem, [found for name, found in moved.items() if name not in fits])
    explained = len(seen.pairs)
    return (
        total
        + explained * math.log(1 - c.p_false_room)
        + (len(problem.seen) - explained) * math.log(c.p_false_room)
    )


def _plane_term(problem: Problem, found: list[PlanePair]) -> float:
    """One online plane, seen by one or more explained rooms."""
    c = problem.constants
    untied = sum(p.state == MISSING for p in found) * math.log(c.p_missing_shared)
    fits = [p for p in found if p.state == FIT]
    same = fits or [p for p in found if p.state == MOVED]
    if not same:
        return math.log(c.p_missing)
    # The terms are quadratic, so the mean of the squares goes in as one root mean square.
    angle = math.sqrt(sum(p.angle**2 for p in same) / len(same))
    offset = math.sqrt(sum(p.offset**2 for p in same) / len(same))
    if fits:
        return fit_term(problem.terms, offset, angle) + untied
    return moved_term(problem.terms, angle) + untied


def evidence(problem: Problem, seen: View) -> float:
    """L: walls and rooms, under the policy ``likelihood`` objects too."""
    walls = wall_evidence(problem, seen) + _unexplained(problem, seen)
    return walls + object_evidence(problem, seen) if problem.policy == "likelihood" else walls


def _unexplained(problem: Problem, seen: View) -> float:
    """What the rooms say that are not explained: they may be like those of the plan."""
    explained = {pair.r for pair in seen.pairs}
    left = [r for r in range(len(problem.seen)) if r not in explained]
    return sum(alike_anyway(problem, r, problem.constants.p_other_room) for r in left)


def most_evidence(problem: Problem) -> float:
    """No L is larger: every wall, every room and every object at its place, and more."""
    c = problem.constants
    planes = {plane for shape in problem.seen for plane in shape.planes}
    walls = len(planes) * fit_term(problem.terms, 0.0, 0.0)
    others = sum(alike_anyway(problem, r, 1.0) for r in range(len(problem.seen)))
    total = walls + len(problem.seen) * math.log(1 - c.p_false_room) + others
    return total + most_object_evidence(problem) if problem.policy == "likelihood" else total


def log_weight(problem: Problem, total: float) -> float:
    """Ln W of a placement whose L is ``total``."""
    c = problem.constants
    spread = 2 * math.pi * problem.sigma**2 / (4 * plan_area(problem))
    return math.log(1 - c.outside_prior) + total + math.log(spread)


@functools.lru_cache(maxsize=16)
def plan_area(problem: Problem) -> float:
    """Sum over storeys of the smallest rectangle around the room centres, grown by the margin."""
    elevations = {s.id: s.elevation for s in problem.prior.storeys}
    by_storey: dict[float, list[tuple[float, float]]] = defaultdict(list)
    for room in problem.prior.rooms:
        by_storey[elevations.get(room.storey or "", 0.0)].append(room.center[:2])
    return sum(_smallest(np.array(c), problem.constants.plan_margin) for c in by_storey.values())


def _smallest(points: Array, margin: float) -> float:
    """The smallest rectangle lies along the way between two of the points: all are tried."""
    least = math.inf if len(points) > 1 else (2 * margin) ** 2
    for k in range(1, len(points)):
        ways = points[k:] - points[:-k]
        for angle in np.arctan2(ways[:, 1], ways[:, 0]):
            sides = np.ptp(points @ rotation2(angle), axis=0) + 2 * margin
            least = min(least, float(np.prod(sides)))
    return least


def log_weight_outside(problem: Problem) -> float:
    """Ln W of 'not in this plan': another building is made of similar rooms."""
    c = problem.constants
    rooms = sum(alike_anyway(problem, r, 1.0) for r in range(len(problem.seen)))
    same = c.p_tied * c.clutter_length / (2 * c.fit_limit)
    return math.log(c.outside_prior) + rooms + tied(problem) * math.log(1 + same)
