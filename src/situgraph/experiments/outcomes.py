"""What became of a match, given the truth: right, ambiguous, none or wrong.

*right*: unique, and the true placement; *wrong*: unique, and another one. Two placements are the
same as the definition says (docs/matching.md, section 5). Where drift has bent a map, rooms have
different true placements: one that is true for the rooms it explains is right.
"""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from situgraph.experiments.oracle.answer import motion_of, same, storeys
from situgraph.experiments.oracle.definition import Definition, Policy
from situgraph.experiments.oracle.explained import Motion, moved_center, view
from situgraph.experiments.oracle.peaks import optimum
from situgraph.experiments.oracle.problem import Flags, Problem
from situgraph.geometry.poses import Placement, best_placement
from situgraph.matching import MatchResult, Solution
from situgraph.matching.bent_solution import Answer, BentSolution
from situgraph.plan.sample_truth import OnlineSample
from situgraph.scenegraph.graph import SceneGraph

OUTCOMES = ("right", "ambiguous", "none", "wrong")
ROUNDS = 4  # least-squares steps from the true placement
STEP, TURN = 0.1, math.radians(1)  # about the true placement of a bent map, at most
EXACT = 1e-9  # metres and radians, for rounding
REACH = 20.0  # metres between the centres of rooms that may explain each other


class Judge:
    """Judges matches of one sample with one plan."""

    def __init__(self, sample: OnlineSample, prior: SceneGraph, policy: Policy) -> None:
        self._truth = sample.truth
        self._problem = Problem(sample.online, prior, policy, Definition())
        self._true = motion_of(self._problem, self._truth.placement) if self._problem.seen else None

    def is_true(self, placement: Placement) -> bool:
        """Whether a placement is the true one."""
        return self._true is not None and same(
            self._problem, motion_of(self._problem, placement), self._true
        )

    def outcome(self, result: MatchResult) -> str:
        """One of ``OUTCOMES``."""
        if result.best is None or result.verdict != "unique":
            return str(result.verdict)
        return "right" if self.is_right(result.best) else "wrong"

    def is_right(self, solution: Answer) -> bool:
        """Whether a solution is the true place, of all rooms or of those that it explains.

        A map that is bent has a place for each of its rooms. Of an answer in parts each has to be
        right for its own rooms.
        """
        if isinstance(solution, BentSolution):
            return all(self._holds(part) for part in solution.parts)
        return self.is_true(solution.transform) or self._holds(solution)

    def is_aside(self, result: MatchResult) -> bool:
        """Whether the best solution is right for the rooms that it explains, not for all rooms."""
        best = result.best
        return isinstance(best, Solution) and not self.is_true(best.transform) and self._holds(best)

    def rooms_right(self, result: MatchResult) -> bool:
        """Whether all rooms that the best solution explains are those they are."""
        best, true = result.best, self._truth.rooms
        return best is not None and all(true.get(r) == a for r, a in best.rooms.items())

    def _holds(self, part: Solution) -> bool:
        """Whether a placement is where the best rigid fit over its own true rooms has it."""
        room, own = self._problem.online.room_by_id, self._truth.room_placements
        real = [r for r in part.rooms if r in own]
        if not real:
            return False
        center = np.array([room[r].center[:2] for r in real])
        truth = best_placement([own[r] for r in real], center, self._truth.placement.z)
        middle, limits = center.mean(axis=0), self._problem.constants
        apart = float(np.linalg.norm(part.transform.points(middle) - truth.points(middle)))
        turned = abs(math.remainder(part.transform.yaw - truth.yaw, 2 * math.pi))
        return (
            apart <= limits.same_distance
            and turned <= limits.same_yaw
            and abs(part.transform.z - truth.z) <= limits.same_height
        )

    def true_rank(self, result: MatchResult) -> int | None:
        """Which of the solutions is the truth (0 the best), or None."""
        for rank, solution in enumerate(result.solutions):
            if self.is_right(solution):
                return rank
        return None

    def admissible(self, *results: MatchResult) -> bool:
        """Whether the truth is a candidate: the printed model holds at the true placement.

        Of the map as a whole, that is; an answer in parts claims to cover bent maps, so wherever
        one of the ``results`` is such the truth is admissible. Checked with the definition as the
        brute force reads it, at the true placement. A bent map has no exact one: it is checked as
        far about it as the rooms' own placements differ from it, where least squares lead from
        there, and where one of the ``results`` puts it, too.
        """
        if self._true is None:
            return False
        if any(isinstance(s, BentSolution) for r in results for s in r.solutions):
            return True
        known = (self._truth.placement, self._truth.start, *self._truth.room_placements.values())
        starts = [motion_of(self._problem, placement) for placement in known]
        bend = max(self._away(start) for start in starts)
        turned = max(self._turned(start) for start in starts)
        if max(bend, turned) <= EXACT:
            return self._feasible_from(self._true, bend, turned)
        step, turn = min(STEP, bend), min(TURN, turned)
        true = self._true
        starts += [
            Motion(true.yaw + u * turn, true.point + step * np.array([x, y]), true.z)
            for u, x, y in itertools.product((-1, 0, 1), repeat=3)
        ]
        told = (motion_of(self._problem, s.transform) for r in results for s in r.solutions)
        return any(
            self._feasible_from(start, bend, turned) for start in itertools.chain(starts, told)
        )

    def _away(self, motion: Motion) -> float:
        """Metres between where a placement and the true one take the middle of the rooms."""
        assert self._true is not None
        return float(np.linalg.norm(motion.point - self._true.point))

    def _turned(self, motion: Motion) -> float:
        """Radians between a placement and the true one."""
        assert self._true is not None
        return abs(math.remainder(motion.yaw - self._true.yaw, 2 * math.pi))

    def contained(self) -> bool:
        """Whether every true pair of rooms and of planes passes the paper's containment filter."""
        strict = Problem(
            self._problem.online, self._problem.prior, "containment", self._problem.constants
        )
        rows = {s.room.id: r for r, s in enumerate(strict.seen)}
        columns = {s.room.id: a for a, s in enumerate(strict.planned)}
        for mine, theirs in self._truth.rooms.items():
            r, a = rows.get(mine), columns.get(theirs)
            if r is None or a is None:
                continue
            one, two = strict.seen[r].planes, strict.planned[a].planes
            true = [(one.index(p), self._truth.planes.get(p)) for p in one]
            allowed = strict.planes_allowed(r, a)
            if not strict.room_allowed(r, a) or not all(
                allowed[i, two.index(q)] for i, q in true if q in two
            ):
                return False
        return True

    def _feasible_from(self, motion: Motion, bend: float, turned: float) -> bool:
        """Whether the model holds here, or where least squares lead from here, about the truth."""
        problem = self._problem
        assert self._true is not None
        if not problem.planned:
            return False
        near: Flags | None = None
        for _ in range(ROUNDS):
            if self._away(motion) > bend + EXACT or self._turned(motion) > turned + EXACT:
                return False
            if near is None:
                near = storeys(problem, motion.z) & _nearby(problem, motion)
            seen = view(problem, motion, near)
            if seen.feasible and same(problem, motion, self._true):
                return True
            if not seen.pairs:
                return False
            motion = optimum(problem, seen)
        return False


def _nearby(problem: Problem, motion: Motion) -> Flags:
    moved = np.array([moved_center(problem, motion, r) for r in range(len(problem.seen))])
    there = np.array([room.center for room in problem.planned])
    return np.asarray(np.linalg.norm(moved[:, None] - there[None], axis=2) <= REACH)


def tally(rows: Iterable[Mapping[str, Any]]) -> dict[str, int]:
    """How many rows, and how many of each outcome."""
    counted = Counter(str(row["outcome"]) for row in rows)
    return {"trials": counted.total(), **{name: counted[name] for name in OUTCOMES}}
