"""A map that is bent too much for one placement: its parts, each placed by itself, in chains.

Definition, section 12 of ``docs/matching.md``.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from situgraph.geometry.poses import wrap_angle
from situgraph.matching.config import MatchingConfig
from situgraph.matching.posterior import log_alike
from situgraph.matching.result import MatchResult
from situgraph.matching.solution import Solution
from situgraph.matching.tables import Floats, Ints
from situgraph.scenegraph.graph import SceneGraph

Cut = Literal["across", "along"]  # the direction in which most rooms lie
CUTS: tuple[Cut, ...] = ("across", "along")
Solve = Callable[[SceneGraph], MatchResult]  # of a part, as if the plan were not mirrored
Chosen = dict[int, tuple[int, float]]  # of parts: which candidate, and what its gap costs
Gap = tuple[float, float, float]  # how far two parts are apart, and the point between them
Gaps = dict[tuple[int, int], Gap]
FARTHEST = 3.0  # standard deviations between placements that go on from one another
LISTED = 1000  # candidates of a part that are put together with those of others


@dataclass(frozen=True, eq=False)
class Part:
    """Rooms that lie together, matched by themselves."""

    rooms: tuple[int, ...]  # of the online graph
    result: MatchResult

    @cached_property
    def candidates(self) -> tuple[Solution, ...]:
        """Placements of the part, best first, whether they are solutions or not."""
        result = self.result
        return tuple(
            Solution(result.inputs, result.found.posterior, rank)
            for rank in range(min(LISTED, result.candidates))
        )

    @cached_property
    def places(self) -> Floats:
        """(k, 5) x, y, z, yaw and L of the candidates."""
        at = [(c.transform, c.log_likelihood) for c in self.candidates]
        return np.array([(t.x, t.y, t.z, t.yaw, high) for t, high in at]).reshape(-1, 5)

    @cached_property
    def center(self) -> Floats:
        """(n, 2) of its rooms, map frame."""
        online = self.result.inputs.online
        return np.array([room.center[:2] for room in online.rooms])

    @property
    def complete(self) -> bool:
        """Whether all its placements are known."""
        return self.result.complete and self.result.candidates <= LISTED

    @cached_property
    def alone(self) -> float:
        """What its rooms add to L when it is not placed: bent as the map, or not of the plan."""
        inputs, config = self.result.inputs, self.result.inputs.config
        rooms = (self.result.alike, inputs.seen, inputs.index.rooms, config)
        bent = math.log(config.p_bent_part) + log_alike(*rooms)
        false = len(inputs.kept) * math.log(config.p_false_room)
        other = math.log(1 - config.p_bent_part) + false + log_alike(*rooms, config.p_other_room)
        return float(np.logaddexp(bent, other))


@dataclass(frozen=True, eq=False)
class Chain:
    """A placement for each of several parts, which go on from one another."""

    links: dict[int, Solution]  # by part
    weight: float  # ln W

    @cached_property
    def rooms(self) -> dict[str, str]:
        """Explained online rooms and the prior rooms they are."""
        return {r: a for link in self.links.values() for r, a in link.rooms.items()}


def parts_of(whole: MatchResult, solve: Solve, cut: Cut) -> list[Part]:
    """Halves of the map, those of which nothing fits halved again, while they have enough rooms."""
    inputs = whole.inputs
    online, least = inputs.online, inputs.config.part_rooms
    center = np.array([online.rooms[k].center[:2] for k in inputs.kept.tolist()])
    waiting = _halves(np.arange(len(center)), center, cut)
    found: list[Part] = []
    while waiting:
        rows = waiting.pop(0)
        rooms = tuple(int(inputs.kept[k]) for k in rows)
        result = solve(online.replace(rooms=tuple(online.rooms[k] for k in rooms)))
        if result.verdict == "none" and len(rows) >= 2 * least:
            waiting[:0] = _halves(rows, center, "across")
        else:
            found.append(Part(rooms, result))
    return found


def _halves(rows: Ints, center: Floats, cut: Cut) -> list[Ints]:
    at = center[rows] - center[rows].mean(axis=0)
    axes = np.linalg.eigh(at.T @ at)[1]  # the direction in which most lie is the second
    along = at @ axes[:, int(cut == "across")]
    if (along**3).sum() < 0.0:  # in any frame the same half has the room that is over
        along = -along
    order = rows[np.lexsort((rows, along.round(6)))]
    half = len(order) // 2
    return [np.sort(order[:half]), np.sort(order[half:])]


def chains_of(parts: list[Part], config: MatchingConfig) -> list[Chain]:
    """What the parts' candidates can be put together to, best first; of one place the best.

    Only such as place parts that hold half of the rooms.
    """
    gaps = {(p, q): _gap(parts[p], parts[q]) for p in range(len(parts)) for q in range(p)}
    gaps |= {(q, p): gap for (p, q), gap in gaps.items()}
    rooms = sum(len(part.rooms) for part in parts)
    found: list[Chain] = []
    known: set[tuple[int, int]] = set()  # parts and candidates in some chain
    for root, part in enumerate(parts):
        for rank in range(len(part.candidates)):
            if (root, rank) in known:
                continue
            chosen = _grow(root, rank, parts, gaps, config)
            known.update((p, k) for p, (k, _) in chosen.items())
            if 2 * sum(len(parts[p].rooms) for p in chosen) >= rooms:
                found.append(_chain(chosen, parts, config))
    found.sort(key=lambda chain: -chain.weight)
    return _distinct(found)


def _grow(root: int, rank: int, parts: list[Part], gaps: Gaps, config: MatchingConfig) -> Chosen:
    """From a candidate of one part on, always to the part that lies nearest."""
    chosen: Chosen = {root: (rank, 0.0)}
    left = set(range(len(parts))) - {root}
    taken = set(parts[root].candidates[rank].rooms.values())
    while left:
        _, x, y, part, beside = min((*gaps[p, q], p, q) for p in left for q in chosen)
        left.remove(part)
        one = parts[beside].places[chosen[beside][0]]
        away = _misfit(one, parts[part].places, x, y, config)
        near = np.flatnonzero(away < math.inf)
        value = parts[part].places[near, 4] - away[near]
        for k in near[np.argsort(-value, kind="stable")].tolist():
            rooms = parts[part].candidates[k].rooms.values()
            if taken.isdisjoint(rooms):
                chosen[part] = k, float(away[k])
                taken.update(rooms)
                break
    return chosen


def _gap(part: Part, other: Part) -> Gap:
    one, two = part.center, other.center
    apart = np.linalg.norm(one[:, None] - two[None], axis=2).round(6)
    i, j = np.unravel_index(int(np.argmin(apart)), apart.shape)
    x, y = ((one[i] + two[j]) / 2).tolist()
    return float(apart[i, j]), x, y


def _misfit(one: Floats, all_two: Floats, x: float, y: float, config: MatchingConfig) -> Floats:
    """(k,) minus ln of how likely placements go on from one at a point, against no gap there."""
    two = all_two.T
    off = [_moved(two, x, y)[axis] - _moved(one, x, y)[axis] for axis in (0, 1)]
    gap = np.hypot(off[0], off[1]) / config.part_gap
    turned = np.abs(wrap_angle(two[3] - one[3]))
    beside = (
        (turned <= config.part_yaw)
        & (np.abs(two[2] - one[2]) <= config.same_height)
        & (gap <= FARTHEST)
    )
    return np.where(beside, gap**2 / 2, np.inf)


def _moved(at: Floats, x: float, y: float) -> tuple[Floats, Floats]:
    """A point under placements x, y, z, yaw (each a number or (k,))."""
    c, s = np.cos(at[3]), np.sin(at[3])
    return at[0] + c * x - s * y, at[1] + s * x + c * y


def _chain(chosen: Chosen, parts: list[Part], config: MatchingConfig) -> Chain:
    """With its weight: the first part may lie anywhere in the plan, the others near the former."""
    links = {p: parts[p].candidates[k] for p, (k, _) in sorted(chosen.items())}
    sigma = sorted(parts[p].result.inputs.sigma for p in links)
    weight = math.log(1 - config.outside_prior)
    weight += max(parts[p].result.inputs.log_spread for p in links)
    weight += sum(2 * math.log(s / config.part_gap) for s in sigma[1:])
    weight += sum(links[p].log_likelihood - chosen[p][1] for p in links)
    weight += sum(part.alone for p, part in enumerate(parts) if p not in links)
    seen = [plane for link in links.values() for plane in link.planes]
    twice = len(seen) - len(set(seen))  # a wall between two parts tells only once
    limits = parts[0].result.inputs.limits
    return Chain(links, weight - twice * max(limits.fit_peak, 0.0))


def _distinct(chains: list[Chain]) -> list[Chain]:
    """Of chains that agree in most rooms that both explain the first."""
    online = {r: k for k, r in enumerate(sorted({r for c in chains for r in c.rooms}))}
    prior = {a: k for k, a in enumerate(sorted({a for c in chains for a in c.rooms.values()}))}
    kept: list[Chain] = []
    told = np.full((len(chains), len(online)), -1)  # the prior room of each online room, or -1
    for chain in chains:
        row = told[len(kept)]
        row[:] = -1
        for r, a in chain.rooms.items():
            row[online[r]] = prior[a]
        both = (told[: len(kept)] >= 0) & (row >= 0)
        same = both & (told[: len(kept)] == row)
        if not (2 * same.sum(axis=1) > both.sum(axis=1)).any():
            kept.append(chain)
    return kept
