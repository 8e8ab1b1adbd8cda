"""The verdict of a match in one sentence, with the figures it stands on."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from situgraph.matching.bent_solution import Answer, BentSolution

if TYPE_CHECKING:
    from situgraph.matching.result import MatchResult


def reason(result: MatchResult) -> str:
    """Why the verdict is what it is."""
    if result.verdict == "none":
        return _none(result)
    return _unique(result) if result.unique else _ambiguous(result)


def _none(result: MatchResult) -> str:
    least, rooms, prior = result.figures
    if rooms == 0:
        return "no online room has two planes that can be used"
    if prior == 0:
        return "no room of the plan has two planes that can be used"
    candidates = result.stats["candidates"]
    if candidates == 0:
        if not result.complete:
            return (
                f"the search was cut short, and found no placement that explains at least {least} "
                f"of {rooms} rooms"
            )
        if _all_parallel(result):
            return (
                "all walls that were seen are parallel: nothing tells where along them the robot "
                "is (unconstrained)"
            )
        cut = result.inputs.config.may_be_cut(rooms)
        nor = ", nor do parts of the map by themselves" if cut else ""
        return f"no placement explains at least {least} of {rooms} rooms{nor}"
    outside = f"{100 * result.probability_outside:.3g} %"
    first = result.candidate(0)
    fit = f"{_placements(candidates)} at least {least} of {rooms} rooms"
    if isinstance(first, BentSolution):
        fit = f"{_placement(first)} {_share(first, result)}"
    if result.probability_mirrored > result.probability_outside / 2:
        return (
            f"{fit}, but their mirror image fits the plan better: the plan is mirrored, or not "
            f"this one ({outside})"
        )
    return (
        f"{fit}, but rooms like these fit by chance: not in this plan is the most probable "
        f"({outside})"
    )


def _all_parallel(result: MatchResult) -> bool:
    """Whether no two walls that were seen could fix a placement."""
    inputs = result.inputs
    angle = inputs.seen.angle
    return bool((np.abs(np.sin(angle - angle[0])) < inputs.limits.sine / 2).all())


def _unique(result: MatchResult) -> str:
    best = result.solutions[0]
    first = f"{_placement(best)} {_share(best, result)}"
    rival = result.candidate(1)
    if rival is None:
        if isinstance(best, BentSolution):
            return f"{first}; no others go on from one another"
        least, rooms, _ = result.figures
        return f"{first}; no other one explains at least {least} of {rooms}"
    odds = best.probability / rival.probability if rival.probability > 0 else math.inf
    return f"{first}; the next best explains {_share(rival, result)}, {_odds(odds)}"


def _ambiguous(result: MatchResult) -> str:
    best = result.solutions[0]
    chance = f"{100 * best.probability:.3g} %"
    if result.count == 1:
        if not result.complete:
            return f"{_placement(best)} {_share(best, result)}, but the search was cut short"
        mirror = result.probability_mirrored
        if mirror > result.probability_outside / 2:
            return (
                f"{_placement(best)} {_share(best, result)}, but the mirror image of what was "
                f"seen fits the plan better: the plan may be mirrored ({100 * mirror:.3g} %)"
            )
        if (
            isinstance(best, BentSolution)
            and best.probability >= result.inputs.config.unique_probability
        ):
            return (
                f"{_placement(best)} {_share(best, result)}, but none of the parts is sure to be "
                "there by itself"
            )
        outside = f"{100 * result.probability_outside:.3g} %"
        return (
            f"{_placement(best)} {_share(best, result)} with probability {chance}, which is "
            f"not enough; not in this plan has {outside}"
        )
    second = result.candidate(1)
    assert second is not None
    return (
        f"{result.count:,} placements cannot be told apart; the best explains "
        f"{_share(best, result)} ({chance}), the next {_share(second, result)} "
        f"({100 * second.probability:.3g} %)"
    )


def _placement(solution: Answer) -> str:
    """``one placement explains``, or one for each part."""
    if not isinstance(solution, BentSolution):
        return "one placement explains"
    count = len(solution.parts)
    if count == 1:
        return "one placement of a part of the map explains"
    return (
        f"the map is bent: placements of {count} parts of it, turned against each other by "
        f"{math.degrees(solution.bend):.2g} deg, explain"
    )


def _share(solution: Answer, result: MatchResult) -> str:
    """``6 of 6 rooms with two moved walls``."""
    text = f"{len(solution.rooms)} of {result.figures[1]} rooms"
    moved = solution.moved
    if moved:
        walls = "one moved wall" if moved == 1 else f"{moved} moved walls"
        text += f" with {walls}"
    return text


def _placements(count: int) -> str:
    return "one placement explains" if count == 1 else f"{count:,} placements explain"


def _odds(ratio: float) -> str:
    if ratio > 1e9:
        return "less than 1:1,000,000,000"
    return f"1:{ratio:,.0f}"
