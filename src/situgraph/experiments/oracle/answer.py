"""Everything that can be found in a plan: feasible placements, candidates and their L."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from situgraph.experiments.oracle.explained import Fitting, Motion, View, fitting, view
from situgraph.experiments.oracle.likelihood import (
    evidence,
    log_weight,
    log_weight_outside,
)
from situgraph.experiments.oracle.peaks import beside, highest, peak
from situgraph.experiments.oracle.problem import Flags, Problem
from situgraph.experiments.oracle.regions import Regions
from situgraph.experiments.oracle.scan import feasible_placements
from situgraph.geometry.poses import Placement, rotation2, wrap_angle
from situgraph.scenegraph.mirror import mirrored

COUNTS = 12.0  # nats below the best beyond which a candidate's exact L is of no account


@dataclass(frozen=True, eq=False)
class Candidate:
    """A peak: its L, and its probability against all others and 'outside'."""

    motion: Motion
    evidence: float
    probability: float = 0.0


@dataclass(frozen=True, eq=False)
class Start:
    """A feasible placement that was found, the plane pairs that fit there, where it leads to."""

    motion: Motion
    fitting: frozenset[Fitting]
    peak: Motion


@dataclass(frozen=True, eq=False)
class Found:
    """What there is in the plan, not judged yet; candidates best first.

    ``outside`` and ``mirrored`` are the ln W of these hypotheses, the second None when not asked.
    """

    candidates: tuple[Candidate, ...]
    feasible: tuple[Start, ...]
    outside: float
    mirrored: float | None = None


def search(problem: Problem) -> Found:
    """All feasible placements up to their correspondences, and the candidates."""
    regions = Regions(problem)
    starts: list[Start] = []
    climbed: dict[tuple[object, ...], View] = {}
    tops: list[View] = []
    # The best fitting first: the others then mostly lie beside a peak that is known already.
    for found in sorted(feasible_placements(problem, regions), key=lambda f: -f.fits):
        if any(beside(problem, found.motion, p.motion) for p in tops):
            continue
        start = view(problem, found.motion, found.near)
        key = (found.motion.z, *start.signature)
        if start.feasible and key not in climbed:
            climbed[key] = peak(problem, start, found.near, tops)
            starts.append(Start(start.motion, fitting(start), climbed[key].motion))
            if not any(climbed[key] is top for top in tops):
                tops.append(climbed[key])
    candidates = _raised(problem, _complete(problem, [*climbed.values()]))
    outside = log_weight_outside(problem) if problem.seen and problem.planned else 0.0
    return Found(tuple(candidates), tuple(starts), outside)


def _complete(problem: Problem, peaks: list[View]) -> list[View]:
    """The distinct peaks with all room pairs looked at, not only those near the climb's start."""
    by_place: dict[tuple[float, ...], View] = {}
    for p in peaks:
        key = (p.motion.z, *np.round([p.motion.yaw, *p.motion.point], 4).tolist())
        by_place.setdefault(key, p)
    return [view(problem, p.motion, storeys(problem, p.motion.z), 1e-7) for p in by_place.values()]


def _raised(problem: Problem, peaks: list[View]) -> list[Candidate]:
    """The candidates with the highest peak of each that counts; hopeless ones stay as they are."""
    by_motion = {id(p.motion): p for p in peaks}
    candidates = distinct(problem, weighed(problem, peaks))
    if not candidates:
        return []
    least = candidates[0].evidence - COUNTS
    raised = []
    for k in candidates:
        top = by_motion[id(k.motion)]
        if k.evidence >= least:
            top = highest(problem, top, storeys(problem, k.motion.z))
        raised.append(top)
    return distinct(problem, weighed(problem, raised))


def weighed(problem: Problem, peaks: Iterable[View]) -> list[Candidate]:
    """Those of the peaks that are feasible, with their L."""
    return [Candidate(p.motion, evidence(problem, p)) for p in peaks if p.feasible]


def storeys(problem: Problem, z: float) -> Flags:
    """The room pairs whose storeys a shift in height maps onto each other."""
    return min(problem.shifts, key=lambda s: abs(s.z - z)).pairs


def same(problem: Problem, one: Motion, two: Motion) -> bool:
    """Whether two placements are the same (section 5)."""
    c = problem.constants
    return (
        float(np.linalg.norm(one.point - two.point)) <= c.same_distance
        and abs(float(wrap_angle(one.yaw - two.yaw))) <= c.same_yaw
        and abs(one.z - two.z) <= c.same_height
    )


def distinct(problem: Problem, candidates: Iterable[Candidate]) -> list[Candidate]:
    """Of candidates that are the same the best, best first."""
    kept: list[Candidate] = []
    for candidate in sorted(candidates, key=_rank):
        if not any(same(problem, candidate.motion, k.motion) for k in kept):
            kept.append(candidate)
    return kept


def _rank(candidate: Candidate) -> tuple[float, ...]:
    at = candidate.motion
    return (-round(candidate.evidence, 9), at.z, at.yaw, *at.point.tolist())


def log_weight_mirrored(problem: Problem) -> float:
    """Ln W of 'the plan is mirrored': the best place of the mirror image of the online graph."""
    c = problem.constants
    image = search(Problem(mirrored(problem.online), problem.prior, problem.policy, c))
    if not image.candidates:
        return -math.inf
    best = log_weight(problem, image.candidates[0].evidence)
    return best - math.log(1 - c.outside_prior) + math.log(c.mirror_prior)


def placement(problem: Problem, motion: Motion) -> Placement:
    """The motion as a placement of the map's origin."""
    x, y = motion.point - rotation2(motion.yaw) @ problem.middle
    return Placement(float(x), float(y), motion.z, float(wrap_angle(motion.yaw)))


def motion_of(problem: Problem, at: Placement) -> Motion:
    """A placement of the map's origin as a motion of the mean room centre."""
    return Motion(at.yaw, rotation2(at.yaw) @ problem.middle + (at.x, at.y), at.z)


def explained_at(problem: Problem, at: Placement, slack: float = 1e-9) -> View:
    """What a placement explains, strictly by the definition."""
    motion = motion_of(problem, at)
    return view(problem, motion, storeys(problem, at.z), slack)
