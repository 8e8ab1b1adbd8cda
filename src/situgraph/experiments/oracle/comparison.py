"""The matcher's answer held against the brute force's (docs/results/matching.md, 'Protocol')."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import msgspec

from situgraph.experiments.oracle.answer import (
    Candidate,
    Found,
    Start,
    distinct,
    explained_at,
    motion_of,
    same,
    search,
    storeys,
    weighed,
)
from situgraph.experiments.oracle.explained import Motion, fitting, view
from situgraph.experiments.oracle.peaks import highest
from situgraph.experiments.oracle.problem import Problem
from situgraph.experiments.oracle.verdict import Answer, judge
from situgraph.geometry.poses import Placement
from situgraph.matching import PlanIndex, match
from situgraph.matching.config import MatchingConfig
from situgraph.scenegraph.graph import SceneGraph

ROUNDING = 1e-6  # metres and radians by which a reported placement may overstep a limit
PROBABILITY_TOLERANCE = 0.01
WEIGHT_TOLERANCE = 0.05  # nats


class Comparison(msgspec.Struct, frozen=True):
    """What differs; all counts are zero and all lists empty when both agree.

    ``missed``: feasible placements of the brute force that no reported candidate represents.
    ``invented``: reported candidates that are not feasible. ``unlike``: solutions of one that are
    not the same as a solution of the other. ``probability_error``: the largest difference of a
    solution's probability.
    """

    feasible: int
    candidates: int
    reported: int
    missed: int
    invented: int
    unlike: int
    verdict: str
    reported_verdict: str
    probability_error: float
    weight_error: float
    complete: bool
    notes: tuple[str, ...] = ()

    @property
    def agrees(self) -> bool:
        """Whether nothing differs beyond the tolerances."""
        return (
            self.missed == self.invented == self.unlike == 0
            and self.verdict == self.reported_verdict
            and self.probability_error <= PROBABILITY_TOLERANCE
        )


def compare(
    online: SceneGraph, prior: SceneGraph, problem: Problem, own: Found | None = None
) -> Comparison:
    """Match with the defaults and with all candidates listed, and compare with the definition.

    ``own`` is the brute force's answer where it is known.
    """
    never = 1e-300
    everything = MatchingConfig(
        rival_ratio=0.0, outside_prior=never, mirror_prior=never, max_solutions=1_000_000
    )
    index = PlanIndex(prior)
    listed = match(online, index, semantics=problem.policy, config=everything).to_dict()
    told = match(online, index, semantics=problem.policy).to_dict()
    placements = [_placement(s) for s in listed["solutions"]]
    views = [explained_at(problem, p, ROUNDING) for p in placements]
    own = search(problem) if own is None else own
    fitting_there = [fitting(v) for v in views]
    missed = [
        _told(start)
        for start in own.feasible
        if not any(
            same(problem, v.motion, start.motion)
            or start.fitting <= fits
            or same(problem, v.motion, start.peak)
            for v, fits in zip(views, fitting_there)
        )
        and not any(same(problem, v.motion, _highest(problem, start.peak)) for v in views)
    ]
    invented = [f"invented {p}" for p, v in zip(placements, views) if not v.feasible]
    # Placements that the grid of yaws passed over count once they are seen to be feasible.
    pooled = distinct(problem, [*own.candidates, *weighed(problem, views)])
    truth = judge(problem, pooled, own.outside, own.mirrored)
    reported = [_placement(s) for s in told["solutions"]]
    unlike = _unlike(problem, truth, reported)
    errors = _errors(problem, truth, told)
    return Comparison(
        feasible=len(own.feasible),
        candidates=len(own.candidates),
        reported=len(placements),
        missed=len(missed),
        invented=len(invented),
        unlike=len(unlike),
        verdict=truth.verdict,
        reported_verdict=str(told["verdict"]),
        probability_error=max((abs(p - q) for p, q in errors), default=0.0),
        weight_error=max((abs(_log(p) - _log(q)) for p, q in errors), default=0.0),
        complete=bool(listed["stats"]["complete"]),
        notes=(*missed[:5], *invented[:5], *unlike[:5]),
    )


def _placement(solution: Mapping[str, Any]) -> Placement:
    return Placement(**{k: float(solution["transform"][k]) for k in ("x", "y", "z", "yaw")})


def _highest(problem: Problem, peak: Motion) -> Motion:
    """Where a peak leads with planes let go or held; the brute force asks it of hopeful ones."""
    near = storeys(problem, peak.z)
    return highest(problem, view(problem, peak, near, ROUNDING), near).motion


def _unlike(problem: Problem, truth: Answer, reported: Sequence[Placement]) -> list[str]:
    """Solutions that have no partner, but for those whose weight is at the limit."""
    there = [motion_of(problem, p) for p in reported]
    best = truth.candidates[0].probability if truth.candidates else 0.0
    limit = problem.constants.rival_ratio * best

    def clear(candidate: Candidate) -> bool:
        return abs(_log(candidate.probability) - _log(limit)) > WEIGHT_TOLERANCE

    lost = [
        f"solution not told: {_spot(s.motion)} p={s.probability:.3g}"
        for s in truth.solutions
        if clear(s) and not any(same(problem, s.motion, m) for m in there)
    ]
    near = [c for c in truth.candidates if c.probability >= limit or not clear(c)]
    more = [
        f"told and no solution: {m}"
        for m in there
        if not any(same(problem, c.motion, m) for c in near)
    ]
    return lost + more


def _errors(problem: Problem, truth: Answer, told: Mapping[str, Any]) -> list[tuple[float, float]]:
    """Probabilities (ours, theirs) of 'outside' and of the solutions both have."""
    pairs = [(truth.probability_outside, float(told["probability_outside"]))]
    for solution in told["solutions"]:
        at = motion_of(problem, _placement(solution))
        ours = [c for c in truth.candidates if same(problem, c.motion, at)]
        if ours:
            nearest = min(ours, key=lambda c: float(abs(c.motion.point - at.point).max()))
            pairs.append((nearest.probability, float(solution["probability"])))
    return pairs


def _log(value: float) -> float:
    return math.log(max(value, 1e-300))


def _spot(at: Motion) -> str:
    return f"yaw {at.yaw:.4f} middle ({at.point[0]:.3f}, {at.point[1]:.3f}) z {at.z:.2f}"


def _told(start: Start) -> str:
    rooms = len({r for r, *_ in start.fitting})
    return f"missed {_spot(start.motion)} rooms {rooms}, peak {_spot(start.peak)}"
