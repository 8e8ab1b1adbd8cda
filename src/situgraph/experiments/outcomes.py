"""What became of a match, given the truth: right, ambiguous, none or wrong.

*right*: unique, and the true placement; *wrong*: unique, and another one. Two placements are the
same as the definition says (docs/matching.md, section 5).
"""

from __future__ import annotations

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
STEP, TURN = 0.1, math.radians(1)  # metres and radians about the true placement
REACH = 20.0  # metres between the centres of rooms that may explain each other


class Judge:
    """Judges matches of one sample with one plan."""

    def __init__(self, sample: OnlineSample, prior: SceneGraph, policy: Policy) -> None:
        self._truth = sample.truth
        self._problem = Problem(sample.online, prior, policy, Definition())
        self._true = motion_of(self._problem, self._truth.placement) if self._problem.seen else None

    def is_true(self, placement: Placement) -> bool:
        """Whether a placement is the true one."""
        if self._true is None:
            return False
        return same(self._problem, motion_of(self._problem, placement), self._true)

    def outcome(self, result: MatchResult) -> str:
        """One of ``OUTCOMES``."""
        if result.best is None or result.verdict != "unique":
            return str(result.verdict)
        return "right" if self.is_right(result.best) else "wrong"

    def is_right(self, solution: Answer) -> bool:
        """Whether a solution is the true place; of a bent map, whether each part of it is."""
        if not isinstance(solution, BentSolution):
            return self.is_true(solution.transform)
        return all(self._holds_part(part) for part in solution.parts)

    def rooms_right(self, result: MatchResult) -> bool:
        """Whether all rooms that the best solution explains are those they are."""
        best, true = result.best, self._truth.rooms
        return best is not None and all(true.get(r) == a for r, a in best.rooms.items())

    def _holds_part(self, part: Solution) -> bool:
        """Whether a part lies where the best rigid fit over its own true rooms has it."""
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
        brute force reads it, at the true placement and about it, where least squares lead from
        there (a bent map has no exact place), and where one of the ``results`` puts it.
        """
        if self._true is None:
            return False
        if any(isinstance(s, BentSolution) for r in results for s in r.solutions):
            return True
        known = (self._truth.placement, self._truth.start, *self._truth.room_placements.values())
        starts = [motion_of(self._problem, start) for start in known]
        starts += [
            Motion(self._true.yaw + turn, self._true.point + np.array([x, y]), self._true.z)
            for turn in (0.0, -TURN, TURN)
            for x in (0.0, -STEP, STEP)
            for y in (0.0, -STEP, STEP)
        ]
        told = (s.transform for r in results for s in r.solutions if self.is_true(s.transform))
        starts += [motion_of(self._problem, placement) for placement in told]
        return any(self._feasible_from(start) for start in starts)

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

    def _feasible_from(self, motion: Motion) -> bool:
        problem = self._problem
        assert self._true is not None
        if not problem.planned:
            return False
        near = storeys(problem, motion.z) & _nearby(problem, motion)
        for _ in range(ROUNDS):
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
