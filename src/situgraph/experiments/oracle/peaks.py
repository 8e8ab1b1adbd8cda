"""The peak of a feasible placement: least squares, correspondences held, until they stay."""

from __future__ import annotations

from collections import Counter

import numpy as np

from situgraph.experiments.oracle.explained import FIT, Motion, View, view
from situgraph.experiments.oracle.likelihood import wall_evidence
from situgraph.experiments.oracle.problem import Flags, Problem
from situgraph.geometry.poses import Array, rotation2, wrap_angle

ROUNDS = 30
SMALLEST_STEP = 1e-6  # share of a step to the optimum below which it is not followed


def peak(problem: Problem, start: View, near: Flags) -> View:
    """Climb from a feasible placement; ``near`` are the room pairs looked at on the way."""
    best, height = start, wall_evidence(problem, start)
    for _ in range(ROUNDS):
        found = _kept_feasible(problem, best, optimum(problem, best), near)
        value = wall_evidence(problem, found)
        if value <= height + 1e-12:
            break
        stays = found.signature == best.signature
        best, height = found, value
        if stays:
            break
    return best


def optimum(problem: Problem, held: View) -> Motion:
    """The placement of the largest L for fixed correspondences (Gauss-Newton; nearly linear)."""
    motion = held.motion
    for _ in range(6):
        residuals, slopes = _linearised(problem, held, motion)
        step = np.linalg.lstsq(slopes, -residuals, rcond=1e-9)[0]
        yaw = float(wrap_angle(motion.yaw + step[0]))
        motion = Motion(yaw, motion.point + step[1:], motion.z)
        if np.abs(step).max() < 1e-12:
            break
    return motion


def _linearised(problem: Problem, held: View, motion: Motion) -> tuple[Array, Array]:
    """Residuals over their sigma (k,) and their slopes (k, 3) in yaw, x, y."""
    c = problem.constants
    paired = [(p, q) for p in held.pairs for q in p.planes if q.j is not None]
    names = [(problem.seen[p.r].planes[q.i], q.state) for p, q in paired]
    count = Counter(names)
    fitting = {name for name, state in count if state == FIT}
    turn = rotation2(motion.yaw)
    residuals, slopes = [], []
    for (p, q), (name, state) in zip(paired, names):
        if state != FIT and name in fitting:
            continue  # the state of a shared plane is the best of its occurrences
        mine, theirs, j = problem.seen[p.r], problem.planned[p.a], q.j
        assert j is not None
        share = 1 / np.sqrt(count[name, state])
        angle = wrap_angle(mine.angles[q.i] + motion.yaw - theirs.angles[j])
        residuals.append(share * float(angle) / c.angle_sigma)
        slopes.append([share / c.angle_sigma, 0.0, 0.0])
        if state == FIT:
            arm = turn @ (mine.center - problem.middle)
            n = theirs.normals[j]
            offset = mine.distances[q.i] - (n @ (arm + motion.point) + theirs.offsets[j])
            swing = n @ np.array([-arm[1], arm[0]])
            residuals.append(share * float(offset) / c.plane_sigma)
            slopes.append([-share * v / c.plane_sigma for v in (swing, *n)])
    return np.array(residuals), np.array(slopes)


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
