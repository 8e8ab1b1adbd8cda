"""The peak of a feasible placement: least squares with the correspondences held.

Until they stay.
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math

from situgraph.matching.compiled import part
from situgraph.matching.effort import exhausted
from situgraph.matching.leverage import (
    far_apart,
    leads_back,
    measure_margins,
    nearly_moved,
    stays_low,
)
from situgraph.matching.limits import first_limit
from situgraph.matching.nearby import LEAST_GAIN, add_peak
from situgraph.matching.optimum import (
    KEPT_ALL,
    KEPT_AT_LIMITS,
    KEPT_NONE,
    SUMS,
    arm_of,
    offset_of,
    optimum,
    pull_of,
    slide,
    sum_pulls,
)
from situgraph.matching.records import scratch
from situgraph.matching.slack import wrapped
from situgraph.matching.tables import FIT, MISSING, MOVED
from situgraph.matching.views import (
    copy_view,
    count_planes,
    evidence,
    fixes,
    look_near,
    nearly_explained,
)

ROUNDS = 30
ARRIVED = 1e-6  # metres and radians from the optimum
STILL = 1e-10  # metres and radians: L is nowhere higher
SMALLEST_STEP = 1e-6  # share of the way to an optimum that is not feasible
INSIDE = (0.0, 1e-5, 1e-3)  # metres from it, at which it is then held; 0: not held


@part
def feasible(case, spot, at):
    """Fill ``spot`` at a placement (yaw, x, y); whether it is feasible."""
    count = look_near(case, spot, at[0], at[1], at[2], False)
    return count >= case.task.least and fixes(case, spot)


@part
def arrive(case, spot, at):
    """``feasible`` on a climb, where one looks near by again."""
    count = look_near(case, spot, at[0], at[1], at[2], True)
    return count >= case.task.least and fixes(case, spot)


@part
def climb(case, at):
    """Climb from a feasible placement, whose view is ``case.one``, to its peak.

    ``at`` (3,) becomes the peak, ``case.one`` its view; returns L there.
    """
    height, held = evidence(case, case.one), 0
    goal, tried = scratch(3), scratch(3)
    for _ in range(ROUNDS):
        if exhausted(case):
            break
        if held == 0:
            optimum(case, case.one, at, 0.0, goal)
        else:
            slide(case, at, INSIDE[held], KEPT_AT_LIMITS, goal)
        if _step_to(at, goal, tried) < STILL:
            break
        _part_way(goal, goal, 0.0, 0.0, tried)
        arrives = arrive(case, case.two, tried)
        value = height
        if arrives or _last_feasible(case, at, goal, False, tried):
            value = evidence(case, case.two)
        stays = _same(case.one, case.two)
        falls = arrives and value < height - LEAST_GAIN
        # L falls where a plane ceases to fit: that ends the way as well.
        if falls and not stays and _last_feasible(case, at, goal, True, tried):
            arrives, stays, value = False, True, evidence(case, case.two)
        # Walls that moved as one may say less at the optimum: they move nothing.
        settles = stays and arrives and value < height - LEAST_GAIN
        if value <= height + 1e-12 and not settles:
            held = len(INSIDE) if arrives else held + 1
            if held == len(INSIDE):
                break
            continue
        height = value
        _part_way(tried, tried, 0.0, 0.0, at)
        copy_view(case.two, case.one)
        if stays and arrives and INSIDE[held] < INSIDE[-1]:
            break
        held = 0 if arrives or held else 1
    return height


@part
def rise(case, at, height):
    """Note the peaks to which a peak ``at`` (3,) leads; returns L at the highest, then ``at``.

    Peaks that are the same placement differ in which planes fit: it is climbed on with one plane
    let go, or held again, as long as that leads higher. All higher ones are noted, as objects may
    prefer one that by the walls is as good as another. ``case.one`` must be the view at the peak,
    and is so afterwards.
    """
    goal, tried, top = scratch(3), scratch(3), scratch(3)
    while True:
        best = _raise_once(case, at, height, goal, tried, top)
        if best <= height + LEAST_GAIN:
            return height
        height = best
        _part_way(top, top, 0.0, 0.0, at)
        arrive(case, case.one, at)


@part
def _raise_once(case, at, height, goal, tried, top):
    """Note the higher peaks that one plane leads to; returns the largest L, reached at ``top``."""
    view, seen, best, far = case.one, case.seen, height, -1.0
    system, margin, step, origin = scratch(9), scratch(3), scratch(3), scratch(3)
    copy_view(view, case.kept)
    free = _find_origin(case, at, origin, system)
    if free:
        copy_view(view, case.root)
        measure_margins(case, at, margin)
    else:
        far = _fall_back(case, height, origin, tried, margin, step)
    count_planes(case, view)
    for r in range(len(view.room)):
        if view.room[r] < 0:
            value = _explained(case, at, r, goal, tried)
            best = _note_higher(case, value, height, best, tried, top)
            count_planes(case, view)
            continue
        for i in range(seen.first[r], seen.first[r + 1]):
            if exhausted(case):
                return best
            j = view.row[i]
            if view.state[i] == MISSING:
                j = nearly_moved(case, at, r, i)
            if j < 0 or (free and stays_low(case, at, r, i, j, system, margin, step)):
                continue
            falls = far > 0.0 and view.state[i] == FIT
            if falls and leads_back(case, origin, r, i, system, margin, far, step):
                continue
            value = _changed(case, at, r, i, j, free, goal, tried)
            best = _note_higher(case, value, height, best, tried, top)
            count_planes(case, view)
    return best


@part
def _note_higher(case, value, height, best, tried, top):
    """Note a peak at ``tried`` that is higher than ``height``; ``top`` becomes the highest one."""
    if value <= height + LEAST_GAIN:
        return best
    add_peak(case, tried, value, math.nan)
    if value > best:
        best = value
        _part_way(tried, tried, 0.0, 0.0, top)
    return best


@part
def _find_origin(case, at, origin, system):
    """Whether no limit stopped the climb to the peak: it is the optimum of its correspondences.

    That is the origin. ``system`` is how the planes pull there.
    """
    optimum(case, case.one, at, 0.0, origin)
    sums, step = scratch(SUMS), scratch(3)
    free = _step_to(at, origin, step) < ARRIVED
    if free:
        _part_way(at, at, 0.0, 0.0, origin)
        _step_to(at, at, step)
    sum_pulls(case, case.one, at, 0.0, sums)
    pull_of(sums, step[0], step[1], step[2], system)
    return free


@part
def _step_to(one, two, out):
    """The step from one placement to another, and the largest of what changes."""
    turn, x, y = wrapped(two[0] - one[0]), two[1] - one[1], two[2] - one[2]
    out[0], out[1], out[2] = turn, x, y
    return max(abs(turn), abs(x), abs(y))


@part
def _fall_back(case, height, origin, tried, margin, step):
    """Climb from the optimum of a peak's correspondences, over a limit, to one that is lower.

    Returns how far from that optimum other placements of the same view may lie, which becomes
    ``case.root``, so that from them it is climbed there as well, and to nothing higher than
    ``height`` on the way. -1 where that is not so.
    """
    if not arrive(case, case.two, origin):
        return -1.0
    copy_view(case.two, case.root)
    copy_view(case.two, case.one)
    measure_margins(case, origin, margin)
    _part_way(origin, origin, 0.0, 0.0, tried)
    value = climb(case, tried)
    stays = _same(case.one, case.root)
    optimum(case, case.one, tried, 0.0, step)
    stays = stays and _step_to(tried, step, step) < ARRIVED
    _step_to(origin, tried, step)
    copy_view(case.kept, case.one)
    return far_apart(case, height - value, margin, step) if stays and value <= height else -1.0


@part
def _changed(case, at, r, i, j, free, goal, tried):
    """L of the peak, at ``tried``, to which plane ``i`` leads that is let go, held, or not missing.

    ``j`` is its prior row. No L is as low as when it leads nowhere. ``case.one`` is that of ``at``
    before and after. Where other planes change as well, it is tried again with those held that
    are at their limits, then with all that would go over them.
    """
    state, value, other, last = case.one.state[i], -math.inf, scratch(3), scratch(3)
    for kept in range(KEPT_NONE, KEPT_ALL + 1):
        if (free and kept == KEPT_AT_LIMITS) or (state == FIT and kept == KEPT_ALL):
            continue
        arrives = _lead(case, at, r, i, j, kept, goal)
        repeats = value > -math.inf and _step_to(last, goal, other) < ARRIVED
        _part_way(goal, goal, 0.0, 0.0, last)
        if repeats or (state == MISSING and (not arrives or case.two.state[i] == MISSING)):
            continue
        _part_way(goal, goal, 0.0, 0.0, other)
        stays = arrives and _others_stay(case, i)
        if not arrives and (value > -math.inf or not _last_feasible(case, at, goal, False, other)):
            continue
        # From where a limit stopped the climb, another way may lead on.
        if not (free and _same(case.one, case.two)):
            copy_view(case.two, case.one)
            reached = climb(case, other)
            copy_view(case.kept, case.one)
            if reached > value:
                value = reached
                _part_way(other, other, 0.0, 0.0, tried)
        if stays:
            break
    return value


@part
def _lead(case, at, r, i, j, kept, goal):
    """Into ``goal`` where a change of plane ``i`` leads; whether that is feasible (``case.two``).

    A plane that does not come within its limit so is held at it.
    """
    state = case.one.state[i]
    _change(case, at, r, i, j)
    holds = state == MISSING and abs(case.one.offset[i]) > case.limits.moved
    holds = holds or (state == MOVED and kept != KEPT_NONE)
    case.tally.held[i] = holds
    slide(case, at, INSIDE[1], kept, goal)
    arrives = arrive(case, case.two, goal)
    if state == MOVED and not holds and not (arrives and case.two.state[i] == FIT):
        case.tally.held[i] = 1
        slide(case, at, INSIDE[1], kept, goal)
        arrives = arrive(case, case.two, goal)
    case.one.state[i] = state
    if state == MISSING:
        case.one.row[i] = -1
    return arrives


@part
def _change(case, at, r, i, j):
    """Let plane ``i`` go in ``case.one``, hold it, or pair it with row ``j`` if it is missing."""
    view, limits = case.one, case.limits
    if view.state[i] == MISSING:
        ax, ay = arm_of(case.seen, r, math.cos(at[0]), math.sin(at[0]))
        view.row[i], view.offset[i] = j, offset_of(case, i, j, at[1] + ax, at[2] + ay)
        view.bend[i] = wrapped(case.seen.angle[i] + at[0] - case.plan.row[j, 3])
        view.state[i] = FIT if abs(view.offset[i]) <= limits.fit else MOVED
    else:
        view.state[i] = FIT if view.state[i] == MOVED else MOVED


@part
def _others_stay(case, i):
    """Whether all planes but ``i`` are in the same states in ``case.two`` as in ``case.one``."""
    for k in range(len(case.one.state)):
        if k != i and case.one.state[k] != case.two.state[k]:
            return False
    return True


@part
def _explained(case, at, r, goal, tried):
    """L of the peak, at ``tried``, to which it leads to explain ``r`` by what it nearly is.

    No L is as low as when it leads nowhere. ``case.one`` is that of ``at`` before and after.
    """
    view, near = case.one, case.two
    a = nearly_explained(case, near, r, at, case.limits.fit)
    if a < 0:
        return -math.inf
    for k in range(len(view.room)):
        if view.room[k] == a:
            return -math.inf
    view.room[r] = a
    for i in range(case.seen.first[r], case.seen.first[r + 1]):
        view.row[i], view.state[i] = near.row[i], near.state[i]
        view.offset[i], view.bend[i] = near.offset[i], near.bend[i]
    slide(case, at, INSIDE[1], KEPT_AT_LIMITS, goal)
    copy_view(case.kept, view)
    _part_way(goal, goal, 0.0, 0.0, tried)
    if not arrive(case, case.two, tried) or case.two.room[r] < 0:
        return -math.inf
    copy_view(case.two, view)
    value = climb(case, tried)
    copy_view(case.kept, view)
    return value


@part
def _last_feasible(case, at, goal, alike, tried):
    """Into ``tried`` the last feasible placement found on the way to ``goal``.

    When ``alike``, the last at which all correspondences are those in ``case.one``. It is looked
    for just before and behind where the planes meet their limits, then by bisection.
    """
    low, high, last = 0.0, 1.0, 0.0
    turn, met = wrapped(goal[0] - at[0]), first_limit(case, at, goal, alike)
    looks = 0
    while high - low > SMALLEST_STEP:
        share, looks = met + (looks - 0.5) * 0.9 * SMALLEST_STEP, looks + 1
        if looks > 2 or not low < share < high:
            share = (low + high) / 2
        _part_way(at, goal, turn, share, tried)
        if arrive(case, case.two, tried) and (not alike or _same(case.one, case.two)):
            low = last = share
        else:
            high = share
    if last == 0.0:
        return False
    _part_way(at, goal, turn, last, tried)
    return arrive(case, case.two, tried)


@part
def _part_way(at, goal, turn, share, out):
    out[0] = at[0] + share * turn
    out[1] = at[1] + share * (goal[1] - at[1])
    out[2] = at[2] + share * (goal[2] - at[2])


@part
def _same(one, two):
    """Whether two views hold the same correspondences in the same states."""
    for r in range(len(one.room)):
        if one.room[r] != two.room[r]:
            return False
    for i in range(len(one.row)):
        if one.row[i] != two.row[i] or one.state[i] != two.state[i]:
            return False
    return True
