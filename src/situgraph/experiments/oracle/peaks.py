"""The peak of a feasible placement: least squares, correspondences held, until they stay."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import combinations

import msgspec
import numpy as np

from situgraph.experiments.oracle.explained import (
    FIT,
    MISSING,
    MOVED,
    Motion,
    PlanePair,
    RoomPair,
    View,
    view,
)
from situgraph.experiments.oracle.likelihood import wall_evidence
from situgraph.experiments.oracle.loops import least_squares, wrapped
from situgraph.experiments.oracle.problem import Flags, Problem
from situgraph.geometry.poses import rotation2

ROUNDS = 30
LEAST_GAIN = 1e-3  # of L
SMALLEST_STEP = 1e-6  # share of a step to the optimum below which it is not followed
AT_LIMIT = 1e-4  # metres that a plane is from a limit when it may be what ends a way
INSIDE = (0.0, 1e-5, 1e-3)  # metres from it, where it is then held; the first: not held
STIFF = 1e3  # its weight
FREEDOM = 3  # planes that are held at once, at most
ROUNDING = 1e-6  # metres


def peak(problem: Problem, start: View, near: Flags, known: Sequence[View] = ()) -> View:
    """Climb from a feasible placement; ``near`` are the room pairs looked at on the way.

    A climb that comes beside a ``known`` peak ends there.
    """
    best, height, held = start, wall_evidence(problem, start), 0
    for _ in range(ROUNDS):
        goal = slid(problem, best, INSIDE[held]) if held else optimum(problem, best)
        for there in known:
            if beside(problem, there.motion, goal):
                return there
        found, arrives = _kept_feasible(problem, best, goal, near)
        value = wall_evidence(problem, found)
        if arrives and value < height - LEAST_GAIN:
            # L falls where a plane ceases to fit: that ends the way as well.
            found, arrives = _last_feasible(problem, best, goal, near, best.signature), False
            value = wall_evidence(problem, found)
        if value <= height + 1e-12:
            held = len(INSIDE) if arrives else held + 1
            if held == len(INSIDE):
                break
            continue
        stays = found.signature == best.signature
        if stays and arrives and INSIDE[held] < INSIDE[-1]:
            best = found
            break
        best, height, held = found, value, 0 if arrives or held else 1
    return best


def highest(problem: Problem, top: View, near: Flags) -> View:
    """The highest peak that is reached from a peak when any one plane changes its state.

    Peaks that are the same placement differ in which planes fit; of these the highest counts.
    """
    best, height = top, wall_evidence(problem, top)
    better = True
    while better:
        better = False
        for held in _changes(problem, best):
            found = peak(problem, _towards(problem, best, held, near), near)
            value = wall_evidence(problem, found)
            if value > height + LEAST_GAIN:
                best, height, better = found, value, True
    return best


def _towards(problem: Problem, start: View, held: View, near: Flags) -> View:
    """Where the way to the optimum of other correspondences leads, on which they hold if they can.

    A plane that is held, or no longer missing, and would not be there, is held at the limit.
    """
    before = _states(start)
    wanted = {
        plane: state
        for plane, state in _states(held).items()
        if (before.get(plane), state) in {(MOVED, FIT), (MISSING, MOVED)}
    }
    found, arrives = _kept_feasible(problem, start, optimum(problem, held), near)
    if arrives and wanted.items() <= _states(found).items():
        return found
    found, arrives = _kept_feasible(problem, start, slid(problem, held, INSIDE[1]), near)
    there = arrives and wanted.items() <= _states(found).items()
    return found if there or MOVED not in wanted.values() else start


def _states(seen: View) -> dict[tuple[int, int], str]:
    """The state of each plane of the explained rooms."""
    return {(p.r, q.i): q.state for p in seen.pairs for q in p.planes}


def _changes(problem: Problem, held: View) -> Iterator[View]:
    """The same correspondences with one plane changed.

    One that fits is let go, one that is moved is held, one that is missing is moved if a wall of
    its direction is near enough.
    """
    for k, pair in enumerate(held.pairs):
        for i, plane in enumerate(pair.planes):
            if plane.state == MISSING:
                others = _nearly_moved(problem, held.motion, pair, plane)
            else:
                state = MOVED if plane.state == FIT else FIT
                others = [msgspec.structs.replace(plane, state=state)]
            for other in others:
                planes = (*pair.planes[:i], other, *pair.planes[i + 1 :])
                changed = msgspec.structs.replace(pair, planes=planes)
                yield replace(held, pairs=(*held.pairs[:k], changed, *held.pairs[k + 1 :]))


def _nearly_moved(
    problem: Problem, at: Motion, pair: RoomPair, plane: PlanePair
) -> list[PlanePair]:
    """A missing plane with each wall just beyond where it would be moved."""
    c, found = problem.constants, []
    p = int(problem.mine.first[pair.r]) + plane.i
    first = int(problem.theirs.first[pair.a])
    for j in range(int(problem.theirs.first[pair.a + 1]) - first):
        angle = wrapped(float(problem.mine.angles[p] + at.yaw - problem.theirs.angles[first + j]))
        offset = _offset(problem, at, pair.r, p, first + j)
        near = c.moved_limit < abs(offset) < c.moved_limit + c.fit_limit
        if near and abs(angle) <= c.angle_tolerance and problem.allowed[p, first + j]:
            found.append(PlanePair(plane.i, j, MOVED, angle=angle, offset=offset))
    return found


def beside(problem: Problem, one: Motion, two: Motion) -> bool:
    """Whether two placements are so near that no second candidate can lie between them."""
    c = problem.constants
    (x, y), (u, v) = one.point, two.point
    apart, turned = max(abs(x - u), abs(y - v)), abs(wrapped(one.yaw - two.yaw))
    return one.z == two.z and bool(apart <= c.same_distance / 2 and turned <= c.same_yaw / 2)


# Online room, plane, prior plane, weight by angle and by offset, the offset that is kept.
Pull = tuple[int, int, int, float, float, float]


def slid(problem: Problem, held: View, inside: float) -> Motion:
    """The placement of the largest L where no plane that is at a limit, or over it, is beyond it.

    All sets of such planes are tried that may stay so far ``inside`` of their limits.
    """
    stiff = _stiff(problem, held, inside)
    best, least = optimum(problem, held), math.inf
    for size in range(min(len(stiff), FREEDOM) + 1):
        for some in combinations(stiff, size):
            at = optimum(problem, held, some)
            within = all(
                abs(_offset(problem, at, *pull[:3])) <= abs(pull[5]) + inside + ROUNDING
                for pull in stiff
            )
            cost = _cost(problem, held, at)
            if within and cost < least:
                best, least = at, cost
    return best


def _offset(problem: Problem, at: Motion, r: int, p: int, q: int) -> float:
    """The residual of a plane pair."""
    center = rotation2(at.yaw) @ problem.arms[r] + at.point
    reach = float(problem.theirs.normals[q] @ center + problem.theirs.offsets[q])
    return float(problem.mine.distances[p]) - reach


def _cost(problem: Problem, held: View, at: Motion) -> float:
    """What the planes pay for their residuals."""
    c, total = problem.constants, 0.0
    for r, p, q, by_angle, by_offset, _ in _pulls(problem, held):
        angle = wrapped(float(problem.mine.angles[p] + at.yaw - problem.theirs.angles[q]))
        total += (by_angle * angle / c.angle_sigma) ** 2
        total += (by_offset * _offset(problem, at, r, p, q) / problem.sigma) ** 2
    return total


def optimum(problem: Problem, held: View, stiff: Sequence[Pull] = ()) -> Motion:
    """The placement of the largest L for fixed correspondences, some planes held where they are."""
    c, motion = problem.constants, held.motion
    mine, theirs = problem.mine, problem.theirs
    pulls = [*_pulls(problem, held), *stiff]
    r, p, q, angles, offsets, kept = np.array(pulls).T
    r, p, q = r.astype(int), p.astype(int), q.astype(int)
    yaw, point = least_squares(
        problem.arms[r],
        theirs.normals[q],
        mine.distances[p] - theirs.offsets[q] - kept,
        mine.angles[p] - theirs.angles[q],
        np.stack([angles, offsets], axis=1),
        (problem.sigma, c.angle_sigma),
        motion.yaw,
        motion.point,
    )
    return Motion(yaw, point, motion.z)


def _pulls(problem: Problem, held: View) -> list[Pull]:
    """How the plane pairs pull."""
    mine, theirs = problem.mine.first.tolist(), problem.theirs.first.tolist()
    paired = [
        ((problem.seen[p.r].planes[q.i], q.state), p.r, mine[p.r] + q.i, theirs[p.a] + q.j)
        for p in held.pairs
        for q in p.planes
        if q.j is not None
    ]
    count = Counter(name for name, *_ in paired)
    # The state of a shared plane is the best of its occurrences; the others do not count.
    return [
        (*pull, 1 / math.sqrt(count[name]), (name[1] == FIT) / math.sqrt(count[name]), 0.0)
        for name, *pull in paired
        if name[1] == FIT or (name[0], FIT) not in count
    ]


def _stiff(problem: Problem, held: View, inside: float) -> list[Pull]:
    """The planes at a limit, as if they stayed there."""
    c, mine, theirs = problem.constants, problem.mine.first, problem.theirs.first
    limits = {FIT: c.fit_limit, MOVED: c.moved_limit}
    pulls: list[Pull] = []
    for p in held.pairs:
        for q in p.planes:
            if q.j is not None and limits[q.state] - abs(q.offset) < AT_LIMIT:
                sought = math.copysign(limits[q.state] - inside, q.offset)
                pair = (p.r, int(mine[p.r]) + q.i, int(theirs[p.a]) + q.j)
                pulls.append((*pair, 0.0, STIFF, sought))
    return pulls


def _kept_feasible(problem: Problem, start: View, goal: Motion, near: Flags) -> tuple[View, bool]:
    """The goal, or the last feasible placement on the straight way to it; whether it arrives."""
    reached = view(problem, goal, near)
    if reached.feasible:
        return reached, True
    return _last_feasible(problem, start, goal, near, None), False


def _last_feasible(
    problem: Problem, start: View, goal: Motion, near: Flags, alike: tuple[object, ...] | None
) -> View:
    """The last feasible placement on the straight way, if given with these correspondences."""
    low, high, best = 0.0, 1.0, start
    turn = wrapped(goal.yaw - start.motion.yaw)
    while high - low > SMALLEST_STEP:
        share = (low + high) / 2
        point = start.motion.point + share * (goal.point - start.motion.point)
        tried = view(problem, Motion(start.motion.yaw + share * turn, point, goal.z), near)
        if tried.feasible and alike in (None, tried.signature):
            low, best = share, tried
        else:
            high = share
    return best
