"""Probabilities, solutions and the verdict (sections 4 and 5)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from situgraph.experiments.oracle.answer import Candidate, log_weight_mirrored, search
from situgraph.experiments.oracle.likelihood import log_weight, most_evidence
from situgraph.experiments.oracle.problem import Problem


@dataclass(frozen=True, eq=False)
class Answer:
    """Everything the definition says about a pair of graphs; candidates best first.

    ``mirrored`` is the ln W of 'the plan is mirrored', None when it was not asked.
    """

    candidates: tuple[Candidate, ...]
    solutions: tuple[Candidate, ...]
    verdict: str
    probability_outside: float
    mirrored: float | None = None


def answer(problem: Problem) -> Answer:
    """The definition's answer."""
    found = search(problem)
    return judge(problem, found.candidates, found.outside)


def judge(
    problem: Problem,
    candidates: Sequence[Candidate],
    outside: float,
    mirrored: float | None = None,
) -> Answer:
    """The answer for these candidates; ``mirrored`` is worked out when it is asked.

    Whether the plan is mirrored is asked only of what would be unique, and not where that would
    stay unique if the mirror image were explained as well as can be; it counts where it changes
    the verdict.
    """
    judged = _judged(problem, candidates, outside)
    c = problem.constants
    if judged.verdict != "unique" or problem.policy == "containment" or c.mirror_prior <= 0:
        return judged
    prior = math.log(c.mirror_prior) - math.log(1 - c.outside_prior)
    most = log_weight(problem, most_evidence(problem)) + prior
    if _judged(problem, candidates, float(np.logaddexp(outside, most))).verdict == "unique":
        return judged
    if mirrored is None:
        mirrored = log_weight_mirrored(problem)
    beside = _judged(problem, candidates, float(np.logaddexp(outside, mirrored)))
    return replace(judged if beside.verdict == "unique" else beside, mirrored=mirrored)


def _judged(problem: Problem, candidates: Sequence[Candidate], outside: float) -> Answer:
    c = problem.constants
    weights = [log_weight(problem, k.evidence) for k in candidates]
    total = float(np.logaddexp.reduce([*weights, outside]))
    shared = tuple(replace(k, probability=math.exp(w - total)) for k, w in zip(candidates, weights))
    inside = float(np.logaddexp.reduce(weights)) if weights else -math.inf
    solutions: tuple[Candidate, ...] = ()
    verdict = "none"
    if outside <= inside:
        least = max(weights) + (math.log(c.rival_ratio) if c.rival_ratio > 0 else -math.inf)
        solutions = tuple(k for k, w in zip(shared, weights) if w >= least)
        # The paper's filter knows nothing of what lies outside the plan.
        among = inside if problem.policy == "containment" else total
        sure = len(solutions) == 1 and math.exp(weights[0] - among) >= c.unique_probability
        verdict = "unique" if sure else "ambiguous"
    return Answer(shared, solutions, verdict, math.exp(outside - total))
