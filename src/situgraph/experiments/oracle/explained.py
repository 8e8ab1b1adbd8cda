"""What one placement explains: plane assignments of a room pair, and the pairing of rooms."""

from __future__ import annotations

import functools
from collections.abc import Iterator
from dataclasses import dataclass

import msgspec
import numpy as np
from scipy.optimize import linear_sum_assignment

from situgraph.experiments.oracle.loops import (
    Limits,
    explain_pairs,
    explains,
    fit_term,
    moved_term,
)
from situgraph.experiments.oracle.problem import Flags, Numbers, Problem
from situgraph.geometry.poses import Array, rotation2, wrap_angle

SLACK = 1e-9  # equality at a limit, in metres and radians
FEW = 5_000  # assignments of a room's planes that are all tried
IMPOSSIBLE = 1e9
FIT, MOVED, MISSING = "fit", "moved", "missing"


@dataclass(frozen=True, eq=False)
class Motion:
    """A placement: ``yaw``, where the mean online room centre goes (2,), the shift in height."""

    yaw: float
    point: Array
    z: float = 0.0


class PlanePair(msgspec.Struct, frozen=True, eq=False):
    """Online plane ``i`` of a room, its counterpart ``j`` (None when missing), the residuals.

    ``state`` is that of the likelihood; ``fits`` is what feasibility asks for.
    """

    i: int
    j: int | None
    state: str
    fits: bool = False
    angle: float = 0.0
    offset: float = 0.0


class RoomPair(msgspec.Struct, frozen=True, eq=False):
    """An explained room: the planes' counterparts under the best assignment."""

    r: int
    a: int
    planes: tuple[PlanePair, ...]
    score: float

    @property
    def signature(self) -> tuple[object, ...]:
        """The correspondences without the residuals."""
        return (self.r, self.a, *((p.j, p.state) for p in self.planes))


@dataclass(frozen=True, eq=False)
class View:
    """What a placement explains; ``feasible`` by the definition of section 5."""

    motion: Motion
    pairs: tuple[RoomPair, ...]
    feasible: bool

    @property
    def signature(self) -> tuple[object, ...]:
        """The correspondences of all rooms."""
        return tuple(p.signature for p in self.pairs)


def moved_center(problem: Problem, motion: Motion, r: int) -> Array:
    """Where the placement takes the centre of an online room (2,)."""
    arm = problem.seen[r].center - problem.middle
    return np.asarray(rotation2(motion.yaw) @ arm + motion.point)


def view(problem: Problem, motion: Motion, pairs: Flags, slack: float = SLACK) -> View:
    """Everything explained at one placement, among the room pairs whose storeys agree."""
    found = explained(problem, motion, np.argwhere(pairs), slack)
    scores = {
        (r, a): score - _astray(problem, moved_center(problem, motion, r), a)
        for (r, a), (score, *_) in found.items()
    }
    chosen = pair_up(scores, len(problem.seen), len(problem.planned))
    kept = tuple(_room_pair(problem, pair, found[pair], slack) for pair in chosen)
    enough = len(kept) >= problem.least_rooms
    return View(motion, kept, enough and _fixed(problem, kept))


def _astray(problem: Problem, center: Array, a: int) -> float:
    """Section 2: what a pair of rooms loses whose centres are apart."""
    its, least = problem.planned[a], problem.constants.least_reach
    sigma = max(least, float(np.abs(its.distances).max())) / 2
    return float(((center - its.center) ** 2).sum()) / (2 * sigma**2)


Fitting = tuple[int, int, int, int]  # online room, prior room, their planes


def fitting(seen: View) -> frozenset[Fitting]:
    """The plane pairs that fit."""
    return frozenset(
        (p.r, p.a, q.i, q.j) for p in seen.pairs for q in p.planes if q.fits and q.j is not None
    )


Explained = tuple[float, list[int], Array]  # score, counterparts (-1: missing), (angle, offset)


def explained(
    problem: Problem, motion: Motion, pairs: Numbers, slack: float
) -> dict[tuple[int, int], Explained]:
    """The best assignment of those of the room pairs (k, 2) that are explained."""
    c, widest = problem.constants, int(np.diff(problem.mine.first).max(initial=0))
    limits = Limits(c.angle_tolerance + slack, c.moved_limit + slack, c.fit_limit + slack)
    centers = problem.arms @ rotation2(motion.yaw).T + motion.point
    scores, choices = np.empty(len(pairs)), np.empty((len(pairs), widest), dtype=np.int64)
    residuals = np.empty((len(pairs), widest, 2))
    explain_pairs(
        problem.mine,
        problem.theirs,
        problem.allowed,
        problem.crossed,
        limits,
        problem.terms,
        FEW,
        pairs,
        motion.yaw,
        centers,
        scores,
        choices,
        residuals,
    )
    found: dict[tuple[int, int], Explained] = {}
    for n in np.flatnonzero(scores != -np.inf).tolist():
        r, a = pairs[n].tolist()
        if np.isnan(scores[n]):
            many = _explained_by_many(problem, r, a, motion.yaw, centers[r], limits)
            if many is not None:
                found[r, a] = many
        else:
            size = len(problem.seen[r].planes)
            found[r, a] = (float(scores[n]), choices[n, :size].tolist(), residuals[n, :size])
    return found


def _room_pair(problem: Problem, pair: tuple[int, int], found: Explained, slack: float) -> RoomPair:
    score, choice, residuals = found
    fit_limit, planes = problem.constants.fit_limit + slack, []
    for i, (j, (angle, offset)) in enumerate(zip(choice, residuals.tolist())):
        if j < 0:
            planes.append(PlanePair(i, None, MISSING))
        else:
            fits = abs(offset) <= fit_limit
            planes.append(PlanePair(i, j, FIT if fits else MOVED, fits, angle, offset))
    return RoomPair(*pair, tuple(planes), score)


def _explained_by_many(
    problem: Problem, r: int, a: int, yaw: float, center: Array, limits: Limits
) -> Explained | None:
    """The best assignment of a pair of rooms of many walls."""
    mine, theirs = problem.seen[r], problem.planned[a]
    rows, columns = problem.mine.planes(r), problem.theirs.planes(a)
    angle = wrap_angle(mine.angles[:, None] + yaw - theirs.angles[None, :])
    offset = mine.distances[:, None] - (theirs.normals @ center + theirs.offsets)[None, :]
    possible = (np.abs(angle) <= limits.angle) & (np.abs(offset) <= limits.moved)
    possible &= problem.allowed[rows, columns]
    fits = possible & (np.abs(offset) <= limits.fit)
    terms = problem.terms
    scores = np.where(fits, fit_term(terms, offset, angle), moved_term(terms, angle))
    found = _best_of_many(possible, fits, scores, problem.crossed[rows, rows], terms.missing)
    if found is None:
        return None
    score, choice = found
    # What stands at a missing plane is not looked at.
    at = (np.arange(len(choice)), choice)
    return score, choice, np.stack([angle[at], offset[at]], axis=1)


def _best_of_many(
    possible: Flags, fits: Flags, terms: Array, crossed: Flags, missing: float
) -> tuple[float, list[int]] | None:
    """The best assignment that explains, by linear assignments with each wall missing in turn.

    Of each the best assignment is tried first, then, should it lack two walls that fit and cross,
    the best with any two such walls held.
    """
    everyone = len(possible) == 2 or not crossed.any()
    best: tuple[float, list[int]] | None = None
    for gone in [None] if everyone else [None, *range(len(possible))]:
        pool = fits if everyone else possible
        found = _assigned(pool, terms, missing, gone, ())
        if found is None or (best is not None and found[0] <= best[0]):
            continue
        fit = np.array([j >= 0 and bool(fits[i, j]) for i, j in enumerate(found[1])])
        tried = [found] if explains(fit, crossed) else None
        held = (_assigned(pool, terms, missing, gone, h) for h in _holds(fits, crossed))
        for better in tried or held:
            if better is not None and (best is None or better[0] > best[0]):
                best = better
    return best


def _holds(fits: Flags, crossed: Flags) -> Iterator[tuple[tuple[int, int], ...]]:
    """Every two plane pairs that fit and cross."""
    pairs = np.argwhere(fits).tolist()
    for n, (i, j) in enumerate(pairs):
        for k, m in pairs[n + 1 :]:
            if crossed[i, k] and j != m:
                yield ((i, j), (k, m))


def _assigned(
    pool: Flags, terms: Array, missing: float, gone: int | None, held: tuple[tuple[int, int], ...]
) -> tuple[float, list[int]] | None:
    """The best assignment of all rows but ``gone``, with some pairs given."""
    value = np.where(pool, terms, -IMPOSSIBLE)
    for i, j in held:
        keep = value[i, j]
        value[i, :] = value[:, j] = -IMPOSSIBLE
        value[i, j] = keep
    rows = [i for i in range(len(pool)) if i != gone]
    if len(rows) > pool.shape[1]:
        return None
    at, columns = linear_sum_assignment(-value[rows])
    total = float(value[rows][at, columns].sum())
    if total < -IMPOSSIBLE / 2:
        return None
    choice = [-1] * len(pool)
    for n, j in zip(at, columns):
        choice[rows[n]] = int(j)
    return total + (missing if gone is not None else 0.0), choice


def assignments(possible: Flags) -> list[tuple[int, ...]]:
    """All injective assignments of rows to columns where at most one row is left out (-1)."""
    return _assignments(tuple(tuple(np.flatnonzero(row).tolist()) for row in possible))


@functools.lru_cache(maxsize=100_000)
def _assignments(options: tuple[tuple[int, ...], ...]) -> list[tuple[int, ...]]:
    found: list[tuple[int, ...]] = []

    def extend(chosen: tuple[int, ...]) -> None:
        if len(chosen) == len(options):
            found.append(chosen)
            return
        for j in options[len(chosen)]:
            if j not in chosen:
                extend((*chosen, j))
        if -1 not in chosen:
            extend((*chosen, -1))

    extend(())
    return found


def pair_up(scores: dict[tuple[int, int], float], rows: int, columns: int) -> list[tuple[int, int]]:
    """Most pairs first, then the largest sum of scores, then the smallest prior indices."""
    if not scores:
        return []
    # A pair outweighs any sum of scores; the last digits prefer small indices.
    bonus = 4 * (1 + sum(abs(s) for s in scores.values()))
    value = np.zeros((rows, columns))
    for (r, a), score in scores.items():
        value[r, a] = bonus + score - 1e-9 * a / columns
    chosen = zip(*linear_sum_assignment(-value))
    return sorted((int(r), int(a)) for r, a in chosen if (r, a) in scores)


def _fixed(problem: Problem, pairs: tuple[RoomPair, ...]) -> bool:
    """Whether the fitting planes are not all parallel."""
    fitting = [int(problem.mine.first[p.r]) + q.i for p in pairs for q in p.planes if q.fits]
    return bool(problem.crossed[np.ix_(fitting, fitting)].any())
