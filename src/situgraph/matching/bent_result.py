"""What a match answers of a map that is bent: a placement for each part of it.

Definition, section 12 of ``docs/matching.md``.
"""

from __future__ import annotations

import math
import time
from functools import cached_property
from typing import Any

import numpy as np

from situgraph.matching.bent_map import CUTS, FARTHEST, Chain, Part, Solve, chains_of, parts_of
from situgraph.matching.bent_solution import Answer, BentSolution
from situgraph.matching.candidates import Known
from situgraph.matching.mirror import log_mirror
from situgraph.matching.result import MatchResult
from situgraph.scenegraph.mirror import mirrored


def in_parts(whole: MatchResult, solve: Solve) -> MatchResult:
    """The answer for the parts of a map, or as it was where they do not explain enough of it."""
    begin = time.perf_counter()
    for cut in CUTS:
        parts = parts_of(whole, solve, cut)
        chains = chains_of(parts, whole.inputs.config)
        if chains and (found := BentResult(whole, parts, chains)).verdict != "none":
            if found.unique and not _is_anchored(parts, chains[0]):
                found.verdict = "ambiguous"
            if found.unique:
                found = BentResult(whole, parts, chains, *_log_mirror(whole, solve))
            found.take(time.perf_counter() - begin)
            return found
    return whole


def _log_mirror(whole: MatchResult, solve: Solve) -> tuple[float, bool]:
    """Ln W of 'the plan is mirrored': how well the map's mirror image fits, whole or in parts.

    And whether all searches for it were complete.
    """
    inputs, config = whole.inputs, whole.inputs.config
    if inputs.semantics == "containment" or config.mirror_prior <= 0:
        return -math.inf, True
    image = solve(mirrored(inputs.online))
    best, complete = -math.inf, image.complete
    if image.candidates:
        best = float(image.found.posterior.candidate[0, 4]) + inputs.log_spread
    if image.verdict == "none":
        in_plan = math.log(1 - config.outside_prior)
        for parts in (parts_of(image, solve, cut) for cut in CUTS):
            complete = complete and all(part.complete for part in parts)
            best = max([best, *(chain.weight - in_plan for chain in chains_of(parts, config)[:1])])
    return math.log(config.mirror_prior) + best, complete


def _is_anchored(parts: list[Part], chain: Chain) -> bool:
    """Whether some part is unique by itself, its mirror image considered."""
    unique = [p for p in chain.links if parts[p].result.unique]
    unique.sort(key=lambda p: (-len(parts[p].rooms), p))
    return any(_stands_mirrored(parts[p].result) for p in unique)


def _stands_mirrored(result: MatchResult) -> bool:
    """Whether a unique answer stays so when the plan may be mirrored."""
    if result.inputs.semantics == "containment":
        return True
    mirror, complete = log_mirror(result.inputs, result.found.posterior, Known())
    return complete and mirror == -math.inf


class BentResult(MatchResult):
    """The answer where no placement explains the map as a whole, but placements of its parts do."""

    def __init__(
        self,
        whole: MatchResult,
        parts: list[Part],
        chains: list[Chain],
        log_mirror: float = -math.inf,
        mirror_complete: bool = True,
    ) -> None:
        """``whole`` is the answer for all rooms at once, ``chains`` are best first.

        ``log_mirror`` is ln W of 'the plan is mirrored', and whether all of that was searched.
        """
        elsewhere = float(np.logaddexp(whole.log_outside, log_mirror))
        top = max(chains[0].weight, elsewhere)
        share = np.exp([chain.weight - top for chain in chains])
        away = math.exp(elsewhere - top)
        total = float(share.sum()) + away
        found = whole.found._replace(log_mirror=log_mirror - top - math.log(total))
        super().__init__(whole.inputs, found, whole.seconds)
        self.parts = parts
        self._chains = list(zip(chains, (share / total).tolist()))
        self.probability_outside = away / total
        self.complete = mirror_complete and all(part.complete for part in parts)
        config = whole.inputs.config
        self._count = int(np.count_nonzero(share >= config.rival_ratio * share[0]))
        self.verdict = "ambiguous"
        if away > share.sum():
            self.verdict, self._count = "none", 0
        elif self.complete and self._count == 1 and share[0] >= config.unique_probability * total:
            self.verdict = "unique"

    def take(self, seconds: float) -> None:
        """Count the time that was spent on the parts."""
        search, total = self.seconds
        self.seconds = search + seconds, total + seconds

    def left_out(self, room: str) -> int:
        """How many rooms the part with this one has, where the best chain does not place it."""
        online, placed = self.inputs.online, self._chains[0][0].links
        for k, part in enumerate(self.parts):
            if k not in placed and any(online.rooms[r].id == room for r in part.rooms):
                return len(part.rooms)
        return 0

    @property
    def count(self) -> int:
        """How many solutions there are."""
        return self._count

    @property
    def candidates(self) -> int:
        """How many chains of placements explain enough rooms."""
        return len(self._chains)

    @cached_property
    def solutions(self) -> tuple[Answer, ...]:
        """The solutions, best first."""
        listed = min(self.count, self.inputs.config.max_solutions)
        return tuple(self._solution(k) for k in range(listed))

    def candidate(self, rank: int) -> Answer | None:
        """The chain of this rank, whether a solution or not; None when there are fewer."""
        return self._solution(rank) if rank < len(self._chains) else None

    def _solution(self, rank: int) -> BentSolution:
        chain, probability = self._chains[rank]
        return BentSolution(
            tuple(chain.links.values()), self.inputs.online, probability, chain.weight
        )

    @cached_property
    def stats(self) -> dict[str, Any]:
        """As of the whole map, with what the search of the parts adds."""
        whole, own = super().stats, [part.result.stats for part in self.parts]
        sums = {k: whole[k] + sum(s[k] for s in own) for k in ("hypotheses", "boxes", "steps")}
        return {**whole, **sums, "parts": len(own)}

    @property
    def model(self) -> str:
        """What the search assumes."""
        config = self.inputs.config
        return (
            f"{super().model}; or parts of at least {config.part_rooms} rooms in one place each, "
            f"which hold half of all and lie up to {FARTHEST * config.part_gap:g} m and "
            f"{math.degrees(config.part_yaw):g} deg apart"
        )
