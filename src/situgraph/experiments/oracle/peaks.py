"""The peak of a feasible placement: least squares, correspondences held, until they stay."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from situgraph.experiments.oracle.explained import FIT, MISSING, MOVED, Motion, View, view
from situgraph.experiments.oracle.likelihood import wall_evidence
from situgraph.experiments.oracle.problem import Flags, Problem
from situgraph.geometry.poses import Array, rotation2, wrap_angle

ROUNDS = 30
LEAST_GAIN = 1e-3  # of L
SMALLEST_STEP = 1e-6  # share of a step to the optimum below which it is not followed


def peak(problem: Problem, start: View, near: Flags, known: Sequence[View] = ()) -> View:
    """Climb from a feasible placement; ``near`` are the room pairs looked at on the way.

    A climb that comes beside a ``known`` peak ends there.
    """
    best, height = start, wall_evidence(problem, start)
    for _ in range(ROUNDS):
        goal = optimum(problem, best)
        for there in known:
            if beside(problem, there.motion, goal):
                return there
        found = _kept_feasible(problem, best, goal, near)
        value = wall_evidence(problem, found)
        if value <= height + 1e-12:
            break
        stays = found.signature == best.signature
        best, height = found, value
        if stays:
            break
    return best


def highest(problem: Problem, top: View, near: Flags) -> View:
    """The highest peak that is reached from a peak when any one plane is let go, or held again.

    Peaks that are the same placement differ in which planes fit; of these the highest counts.
    """
    best, height = top, wall_evidence(problem, top)
    better = True
    while better:
        better = False
        for held in _changed(best):
            found = peak(problem, _kept_feasible(problem, best, optimum(problem, held), near), near)
            value = wall_evidence(problem, found)
            if value > height + LEAST_GAIN:
                best, height, better = found, value, True
    return best


def _changed(held: View) -> Iterator[View]:
    """The same correspondences with one plane that fits let go, or one that is moved held."""
    for k, pair in enumerate(held.pairs):
        for i, plane in enumerate(pair.planes):
            if plane.state == MISSING:
                continue
            state = MOVED if plane.state == FIT else FIT
            planes = (*pair.planes[:i], replace(plane, state=state), *pair.planes[i + 1 :])
            changed = replace(pair, planes=planes)
            yield replace(held, pairs=(*held.pairs[:k], changed, *held.pairs[k + 1 :]))


def beside(problem: Problem, one: Motion, two: Motion) -> bool:
    """Whether two placements are so near that no second candidate can lie between them."""
    c = problem.constants
    apart = float(np.abs(one.point - two.point).max())
    turned = abs(float(wrap_angle(one.yaw - two.yaw)))
    return one.z == two.z and apart <= c.same_distance / 2 and turned <= c.same_yaw / 2


def optimum(problem: Problem, held: View) -> Motion:
    """The placement of the largest L for fixed correspondences (Gauss-Newton; nearly linear)."""
    c, walls = problem.constants, _walls(problem, held)
    motion = held.motion
    for _ in range(6):
        arms = walls.arms @ rotation2(motion.yaw).T
        angle = wrap_angle(walls.angles + motion.yaw)
        offset = walls.offsets - ((arms + motion.point) * walls.normals).sum(axis=1)
        swing = walls.normals[:, 1] * arms[:, 0] - walls.normals[:, 0] * arms[:, 1]
        turn = np.zeros((len(angle), 3))
        turn[:, 0] = 1.0
        slide = -np.column_stack([swing, walls.normals])
        fits = walls.fits
        residuals = np.concatenate(
            [walls.weights * angle / c.angle_sigma, (walls.weights * offset / c.plane_sigma)[fits]]
        )
        slopes = np.concatenate(
            [
                walls.weights[:, None] * turn / c.angle_sigma,
                (walls.weights[:, None] * slide / c.plane_sigma)[fits],
            ]
        )
        step = np.linalg.lstsq(slopes, -residuals, rcond=1e-9)[0]
        yaw = float(wrap_angle(motion.yaw + step[0]))
        motion = Motion(yaw, motion.point + step[1:], motion.z)
        if np.abs(step).max() < 1e-10:
            break
    return motion


@dataclass(frozen=True, eq=False)
class _Walls:
    """The plane pairs that pull at a placement, at yaw and point zero."""

    arms: Array
    normals: Array
    offsets: Array
    angles: Array
    weights: Array
    fits: Flags


def _walls(problem: Problem, held: View) -> _Walls:
    paired = [(p, q) for p in held.pairs for q in p.planes if q.j is not None]
    names = [(problem.seen[p.r].planes[q.i], q.state) for p, q in paired]
    count = Counter(names)
    # The state of a shared plane is the best of its occurrences; the others do not count.
    pulls = [
        (problem.seen[p.r], q.i, problem.planned[p.a], q.j, name)
        for (p, q), name in zip(paired, names)
        if name[1] == FIT or (name[0], FIT) not in count
    ]
    return _Walls(
        arms=np.array([mine.center - problem.middle for mine, *_ in pulls]),
        normals=np.array([theirs.normals[j] for _, _, theirs, j, _ in pulls]),
        offsets=np.array([m.distances[i] - t.offsets[j] for m, i, t, j, _ in pulls]),
        angles=np.array([m.angles[i] - t.angles[j] for m, i, t, j, _ in pulls]),
        weights=np.array([1 / np.sqrt(count[name]) for *_, name in pulls]),
        fits=np.array([name[1] == FIT for *_, name in pulls]),
    )


def _kept_feasible(problem: Problem, start: View, goal: Motion, near: Flags) -> View:
    """The goal, or the last feasible placement on the straight way to it."""
    reached = view(problem, goal, near)
    if reached.feasible:
        return reached
    low, high, best = 0.0, 1.0, start
    turn = float(wrap_angle(goal.yaw - start.motion.yaw))
    while high - low > SMALLEST_STEP:
        share = (low + high) / 2
        point = start.motion.point + share * (goal.point - start.motion.point)
        tried = view(problem, Motion(start.motion.yaw + share * turn, point, goal.z), near)
        if tried.feasible:
            low, best = share, tried
        else:
            high = share
    return best
