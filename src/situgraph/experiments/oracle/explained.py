"""What one placement explains: plane assignments of a room pair, and the pairing of rooms."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from situgraph.experiments.oracle.problem import Flags, Problem
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


@dataclass(frozen=True, eq=False)
class PlanePair:
    """Online plane ``i`` of a room, its counterpart ``j`` (None when missing), the residuals.

    ``state`` is that of the likelihood; ``fits`` is what feasibility asks for.
    """

    i: int
    j: int | None
    state: str
    fits: bool = False
    angle: float = 0.0
    offset: float = 0.0


@dataclass(frozen=True, eq=False)
class RoomPair:
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
    rows, columns = len(problem.seen), len(problem.planned)
    found: dict[tuple[int, int], RoomPair] = {}
    for r in range(rows):
        center = moved_center(problem, motion, r)
        for a in range(columns):
            if pairs[r, a] and problem.room_allowed(r, a):
                pair = explain(problem, r, a, motion.yaw, center, slack)
                if pair is not None:
                    found[r, a] = pair
    chosen = pair_up({k: v.score for k, v in found.items()}, rows, columns)
    kept = tuple(found[k] for k in chosen)
    enough = len(kept) >= problem.least_rooms
    return View(motion, kept, enough and _fixed(problem, kept))


def explain(
    problem: Problem, r: int, a: int, yaw: float, center: Array, slack: float = SLACK
) -> RoomPair | None:
    """The best assignment that explains online room ``r`` by prior room ``a``, or None."""
    c = problem.constants
    mine, theirs = problem.seen[r], problem.planned[a]
    angle = wrap_angle(mine.angles[:, None] + yaw - theirs.angles[None, :])
    offset = mine.distances[:, None] - (theirs.normals @ center + theirs.offsets)[None, :]
    possible = (np.abs(angle) <= c.angle_tolerance + slack) & (
        np.abs(offset) <= c.moved_limit + slack
    )
    if (~possible.any(axis=1)).sum() > 1:
        return None
    possible &= problem.planes_allowed(r, a)
    if (~possible.any(axis=1)).sum() > 1:
        return None
    fits = possible & (np.abs(offset) <= c.fit_limit + slack)
    fit, moved = fit_term(problem, offset, angle), moved_term(problem, angle)
    likely = fit >= moved if c.continuous else fits
    terms = np.where(likely, fit, moved)
    crossed = mine.not_parallel(c.parallel_sine)
    if math.prod((possible.sum(axis=1) + 1).tolist()) <= FEW:
        found = _best_of_all(possible, fits, terms, crossed, math.log(c.p_missing))
    else:
        found = _best_of_many(possible, fits, terms, crossed, math.log(c.p_missing))
    if found is None:
        return None
    score, choice = found
    planes = tuple(
        PlanePair(i, None, MISSING)
        if j < 0
        else PlanePair(
            i,
            j,
            FIT if likely[i, j] else MOVED,
            bool(fits[i, j]),
            float(angle[i, j]),
            float(offset[i, j]),
        )
        for i, j in enumerate(choice)
    )
    return RoomPair(r, a, planes, score)


def _best_of_all(
    possible: Flags, fits: Flags, terms: Array, crossed: Flags, missing: float
) -> tuple[float, list[int]] | None:
    """The best assignment that explains, all of them tried."""
    choices = np.array(assignments(possible), dtype=int).reshape(-1, len(possible))
    # Column -1 stands for a missing plane.
    fitting = _column_added(fits, False)[np.arange(len(fits)), choices]
    scores = _column_added(terms, missing)[np.arange(len(terms)), choices].sum(axis=1)
    scores[~_explains(fitting, crossed)] = -math.inf
    best = int(np.argmax(scores)) if len(scores) else -1
    if best < 0 or scores[best] == -math.inf:
        return None
    return float(scores[best]), choices[best].tolist()


def _best_of_many(
    possible: Flags, fits: Flags, terms: Array, crossed: Flags, missing: float
) -> tuple[float, list[int]] | None:
    """The same for rooms of many walls: linear assignments, with each wall missing in turn.

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
        fit = np.array([[j >= 0 and bool(fits[i, j]) for i, j in enumerate(found[1])]])
        tried = [found] if bool(_explains(fit, crossed)[0]) else None
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


def _column_added(values: NDArray[Any], last: object) -> NDArray[Any]:
    return np.concatenate([values, np.full((len(values), 1), last)], axis=1)


def fit_term(problem: Problem, offset: Array, angle: Array) -> Array:
    """Log ratio of planes that fit, per plane."""
    c = problem.constants
    peak = (
        (1 - c.p_moved - c.p_missing) * c.clutter_length / (math.sqrt(2 * math.pi) * c.plane_sigma)
    )
    bend = angle**2 / (2 * c.angle_sigma**2)
    return np.asarray(math.log(peak) - offset**2 / (2 * c.plane_sigma**2) - bend)


def moved_term(problem: Problem, angle: Array) -> Array:
    """Log ratio of moved planes, per plane."""
    c = problem.constants
    spread = math.log(c.p_moved * c.clutter_length / (2 * c.moved_limit))
    return np.asarray(spread - angle**2 / (2 * c.angle_sigma**2))


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


def _explains(fitting: Flags, crossed: Flags) -> Flags:
    """Section 2's conditions on assignments, given which planes fit (k, planes)."""
    if fitting.shape[1] == 2 or not crossed.any():
        return np.asarray(fitting.all(axis=1))
    fit = fitting.astype(int)
    return np.asarray(((fit @ crossed.astype(int)) * fit).any(axis=1))


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
    angles = np.array([problem.seen[p.r].angles[q.i] for p in pairs for q in p.planes if q.fits])
    crossed = np.abs(np.sin(angles[:, None] - angles[None, :]))
    return bool((crossed >= problem.constants.parallel_sine).any())
