"""What a match answers; everything that is not the verdict is worked out when it is asked for."""

from __future__ import annotations

import math
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

from situgraph.matching.bent_solution import Answer
from situgraph.matching.posterior import Posterior, Verdict
from situgraph.matching.preparation import Inputs
from situgraph.matching.solution import Solution
from situgraph.matching.stages import plane_candidates, room_candidates
from situgraph.matching.tables import BOXES, TRIED, WORK, Ints

if TYPE_CHECKING:
    from situgraph.matching.disambiguation import Advice

MOST_ADVICE = 12  # listed in the match JSON


class Found(NamedTuple):
    """What a search found, and how it was judged."""

    posterior: Posterior
    alike: Ints  # (N,) how many prior rooms explain each online room in isolation
    done: list[int]  # peaks, hypotheses, boxes, incomplete, steps
    complete: bool
    log_mirror: float  # of the probability that the plan is mirrored; -inf when it is of no account


class MatchResult:
    """The answer of ``match``.

    Attributes:
        verdict: ``unique``, ``ambiguous`` or ``none``.
        certified: unique, by a complete search, under a policy that has an error model.
        probability_outside: the probability that the robot is not in this plan, mirrored plans
            included.
        complete: whether nothing was left out of the search.
    """

    def __init__(self, inputs: Inputs, found: Found, seconds: tuple[float, float]) -> None:
        """Keep what the search found; ``seconds``: of the search, and of all."""
        self._inputs = inputs
        self._posterior = found.posterior
        self.found = found
        self.seconds = seconds
        self.verdict: Verdict = found.posterior.verdict
        self.probability_outside = found.posterior.outside
        self.complete = found.complete
        if self.verdict == "unique" and not self.complete:
            self.verdict = "ambiguous"

    @property
    def unique(self) -> bool:
        """Whether the verdict is unique."""
        return self.verdict == "unique"

    @property
    def certified(self) -> bool:
        """Whether the verdict is unique and proven under the printed model."""
        return self.unique and self.complete and self._inputs.semantics != "containment"

    @property
    def count(self) -> int:
        """How many solutions there are."""
        return self._posterior.solutions

    @property
    def truncated(self) -> bool:
        """Whether ``solutions`` holds fewer than there are."""
        return self.count > self._inputs.config.max_solutions

    @cached_property
    def solutions(self) -> tuple[Answer, ...]:
        """The solutions, best first, ``max_solutions`` at most."""
        listed = min(self.count, self._inputs.config.max_solutions)
        return tuple(Solution(self._inputs, self._posterior, k) for k in range(listed))

    def candidate(self, rank: int) -> Answer | None:
        """The candidate of this rank, whether a solution or not; None when there are fewer."""
        if rank >= len(self._posterior.candidate):
            return None
        return Solution(self._inputs, self._posterior, rank)

    @property
    def probability_mirrored(self) -> float:
        """The part of ``probability_outside`` that is 'the plan is mirrored'.

        0 where it could not have changed the verdict and was not worked out.
        """
        return math.exp(self.found.log_mirror)

    @property
    def alike(self) -> Ints:
        """(N,) how many prior rooms explain each online room in isolation."""
        return self.found.alike

    @property
    def log_outside(self) -> float:
        """Ln of the weight of 'not in this plan'."""
        chance = self._posterior.outside
        return self._posterior.total + (math.log(chance) if chance > 0 else -math.inf)

    @property
    def inputs(self) -> Inputs:
        """What was matched."""
        return self._inputs

    @property
    def candidates(self) -> int:
        """How many candidates there are, solutions or not."""
        return len(self._posterior.candidate)

    @property
    def figures(self) -> tuple[int, int, int]:
        """K, the online rooms that count, the prior rooms that count."""
        inputs = self._inputs
        rooms = len(inputs.kept)
        return inputs.config.least_rooms(rooms), rooms, inputs.index.rooms

    @property
    def best(self) -> Answer | None:
        """The most probable solution; None when the verdict is none."""
        return self.solutions[0] if self.solutions else None

    @cached_property
    def reason(self) -> str:
        """The verdict in a sentence, with figures."""
        from situgraph.matching.reasons import reason

        return reason(self)

    @property
    def model(self) -> str:
        """What the search assumes."""
        config, n = self._inputs.config, len(self._inputs.kept)
        return (
            f"at least {config.least_rooms(n)} of {n} rooms, {config.plane_offset_tolerance:g} m, "
            f"{math.degrees(config.angle_tolerance):g} deg, "
            f"walls moved up to {config.moved_limit:g} m"
        )

    @cached_property
    def advice(self) -> tuple[Advice, ...]:
        """Observations that would tell the solutions apart, the most telling first."""
        if self.verdict != "ambiguous":
            return ()
        from situgraph.matching.disambiguation import advise

        inputs = self._inputs
        looked = inputs.config.seen_whole if inputs.weighs_objects else 0.0
        return advise(
            self.solutions,
            inputs.online,
            inputs.index.prior,
            looked=looked,
            contents=inputs.semantics != "none",
        )

    @property
    def disambiguation(self) -> list[dict[str, Any]]:
        """The most telling advice as the match JSON has it."""
        return [item.to_dict() for item in self.advice[:MOST_ADVICE]]

    @cached_property
    def stats(self) -> dict[str, Any]:
        """Counts and times of the search, as in the match JSON."""
        inputs = self._inputs
        search, total = self.seconds
        return {
            "rooms_online": len(inputs.kept),
            "rooms_prior": inputs.index.rooms,
            "semantics": inputs.semantics,
            "room_candidates": room_candidates(inputs, self.found.alike),
            "plane_candidates": plane_candidates(
                inputs, self._posterior.shift, self._posterior.candidate[:, 1:4]
            ),
            "hypotheses": int(self.found.done[TRIED]),
            "boxes": int(self.found.done[BOXES]),
            "steps": int(self.found.done[WORK]),
            "candidates": self.candidates,
            "seconds": {"index": inputs.index.seconds, "search": search, "total": total},
            "complete": self.complete,
            "probability_mirrored": self.probability_mirrored,
            "model": self.model,
        }

    def to_dict(self) -> dict[str, Any]:
        """The match JSON (``situgraph/match``, version 1)."""
        return {
            "format": "situgraph/match",
            "version": 1,
            "unique": self.unique,
            "certified": self.certified,
            "verdict": self.verdict,
            "reason": self.reason,
            "probability_outside": self.probability_outside,
            "count": self.count,
            "truncated": self.truncated,
            "solutions": [s.to_dict() for s in self.solutions],
            "disambiguation": self.disambiguation,
            "stats": self.stats,
        }
