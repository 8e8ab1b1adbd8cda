"""The peak of a feasible placement: least squares with the correspondences held.

Until they stay.
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math

from situgraph.matching.compiled import part
from situgraph.matching.explained import wrapped
from situgraph.matching.records import scratch
from situgraph.matching.tables import FIT, MOVED, PEAKS
from situgraph.matching.views import copy_view, evidence, fixes, look, tally_planes

ROUNDS = 30
STEPS = 6  # of Gauss-Newton: only the rotation is not linear, and hardly
LEAST_GAIN = 1e-3  # of L, for which another peak is climbed to
ARRIVED = 1e-6  # metres and radians from the optimum
SAME_PEAK = 1e-4  # metres along both axes, radians
SMALLEST_STEP = 1e-6  # share of the way to an optimum that is not feasible
AT_LIMIT = 1e-4  # metres from a limit, at which a plane can be what ends a way
INSIDE = (0.0, 1e-5, 1e-3)  # metres from it, at which it is then held; 0: not held
STIFF = 1e6  # times its weight


@part
def optimum(case, spot, at, inside, out):
    """Into ``out`` the placement (yaw, x, y) of the largest L for the correspondences in ``spot``.

    Unless ``inside`` is 0, planes at a limit are held so far inside of it: it is slid along what
    ended a way. A straight way leaves such a limit when it turns; farther inside it can be longer.
    """
    view = spot
    seen, plan, limits, tally = (
        case.seen,
        case.plan,
        case.limits,
        case.tally,
    )
    tally_planes(case, spot)
    yaw, x, y = at[0], at[1], at[2]
    g = scratch(3)
    for _ in range(STEPS):
        c, s = math.cos(yaw), math.sin(yaw)
        h00 = h01 = h02 = h11 = h12 = h22 = 0.0
        for k in range(3):
            g[k] = 0.0
        for r in range(len(view.room)):
            if view.room[r] < 0:
                continue
            cx, cy = seen.center[r, 0], seen.center[r, 1]
            ax, ay = c * cx - s * cy, s * cx + c * cy
            for i in range(seen.first[r], seen.first[r + 1]):
                state, p, j = view.state[i], seen.plane[i], view.row[i]
                fit, stop = state == FIT, limits.fit if state == FIT else limits.moved
                if not fit and state != MOVED:
                    continue
                stiff = inside > 0 and stop - abs(view.offset[i]) < AT_LIMIT
                if fit or tally.sums[p, 0] == 0:
                    bend = wrapped(seen.angle[i] + yaw - plan.row[j, 3])
                    weight = limits.angle_weight / tally.sums[p, 0 if fit else 3]
                    h00 += weight
                    g[0] += weight * bend
                if not (fit or stiff):
                    continue
                nx, ny = plan.row[j, 0], plan.row[j, 1]
                off = seen.distance[i] - (nx * (x + ax) + ny * (y + ay) + plan.row[j, 2])
                if stiff:
                    weight = limits.plane_weight * STIFF
                    off -= math.copysign(stop - inside, view.offset[i])
                else:
                    weight = limits.plane_weight / tally.sums[p, 0]
                turn = ny * ax - nx * ay
                h00 += weight * turn * turn
                h01 += weight * turn * nx
                h02 += weight * turn * ny
                h11 += weight * nx * nx
                h12 += weight * nx * ny
                h22 += weight * ny * ny
                g[0] -= weight * turn * off
                g[1] -= weight * nx * off
                g[2] -= weight * ny * off
        if not _solve(h00, h01, h02, h11, h12, h22, g):
            break
        yaw -= g[0]
        x -= g[1]
        y -= g[2]
        if abs(g[0]) + abs(g[1]) + abs(g[2]) < 1e-12:
            break
    out[0] = wrapped(yaw)
    out[1] = x
    out[2] = y


@part
def _solve(a, b, c, d, e, f, g):
    """Solve the symmetric system (upper half given) in place of ``g``; False when singular."""
    m0, m1, m2 = d * f - e * e, c * e - b * f, b * e - c * d
    det = a * m0 + b * m1 + c * m2
    if not det > 1e-12 * abs(a * d * f):
        return False
    g0, g1, g2 = g[0], g[1], g[2]
    g[0] = (m0 * g0 + m1 * g1 + m2 * g2) / det
    g[1] = (m1 * g0 + (a * f - c * c) * g1 + (b * c - a * e) * g2) / det
    g[2] = (m2 * g0 + (b * c - a * e) * g1 + (a * d - b * b) * g2) / det
    return True


@part
def feasible(case, spot, at):
    """Fill ``spot`` at a placement (yaw, x, y); whether it is feasible."""
    task = case.task
    count = look(case, spot, at[0], at[1], at[2], 0.0, 0.0)
    return count >= task.least and fixes(case, spot)


@part
def climb(case, at):
    """Climb from a feasible placement, whose view is ``case.one``, to its peak.

    ``at`` (3,) becomes the peak, ``case.one`` its view; returns L there.
    """
    height, held = evidence(case, case.one), 0
    goal, tried = scratch(3), scratch(3)
    for _ in range(ROUNDS):
        optimum(case, case.one, at, INSIDE[held], goal)
        _part_way(goal, goal, 0.0, 0.0, tried)
        arrives = feasible(case, case.two, tried)
        value = height
        if arrives or _last_feasible(case, at, goal, tried):
            value = evidence(case, case.two)
        if value <= height + 1e-12:
            held = len(INSIDE) if arrives else held + 1
            if held == len(INSIDE):
                break
            continue
        height = value
        stays = _same(case)
        _part_way(tried, tried, 0.0, 0.0, at)
        copy_view(case.two, case.one)
        if stays and arrives and INSIDE[held] < INSIDE[-1]:
            break
        held = 0 if arrives or held else 1
    return height


@part
def add_peak(case, at, height):
    """Note a peak, unless it is known; where there is no room for it, it is only counted."""
    peaks, count = case.found.peak, case.found.count
    for k in range(min(count[PEAKS], len(peaks))):
        if (
            abs(peaks[k, 1] - at[1]) + abs(peaks[k, 2] - at[2]) < SAME_PEAK
            and abs(wrapped(peaks[k, 0] - at[0])) < SAME_PEAK
        ):
            return
    if count[PEAKS] < len(peaks):
        for k in range(3):
            peaks[count[PEAKS], k] = at[k]
        peaks[count[PEAKS], 3] = height
    count[PEAKS] += 1


@part
def same_place(case, one, two):
    """Whether two peaks (yaw, x, y, L) are the same placement."""
    apart = math.hypot(one[1] - two[1], one[2] - two[2])
    turned = abs(wrapped(one[0] - two[0]))
    return apart <= case.limits.same_distance and turned <= case.limits.same_yaw


@part
def rise(case, at, height):
    """Note a peak ``at`` (3,), and if it is the highest of its place, those to which it leads.

    Peaks that are the same placement differ in which planes fit: it is climbed on with one plane
    let go, or held again, as long as that leads higher. All higher ones are noted, as objects may
    prefer one that by the walls is as good as another. ``case.one`` must be the view at the peak.
    """
    peaks, highest = case.found.peak, True
    for k in range(min(case.found.count[PEAKS], len(peaks))):
        if peaks[k, 3] >= height - LEAST_GAIN and same_place(case, peaks[k], at):
            highest = False
            break
    add_peak(case, at, height)
    if not highest:
        return
    goal, tried, top = scratch(3), scratch(3), scratch(3)
    while True:
        best = _raise_once(case, at, height, goal, tried, top)
        if best <= height + LEAST_GAIN:
            return
        height = best
        _part_way(top, top, 0.0, 0.0, at)
        feasible(case, case.one, at)


@part
def _raise_once(case, at, height, goal, tried, top):
    """Note the higher peaks that one plane leads to; returns the largest L, reached at ``top``."""
    view, limits, best = case.one, case.limits, height
    free = _arrived(case, at, goal)
    # Letting a plane go gains at most what all planes that fit pay for their residuals.
    strained = _strain(case) > limits.fit_peak - limits.moved_base - _most_spared(case)
    for i in range(len(view.state)):
        state = view.state[i]
        if state != MOVED and (state != FIT or (free and not strained)):
            continue
        view.state[i] = FIT if state == MOVED else MOVED
        optimum(case, case.one, at, 0.0, goal)
        view.state[i] = state
        _part_way(goal, goal, 0.0, 0.0, tried)
        if not feasible(case, case.two, tried) and not _last_feasible(case, at, goal, tried):
            continue
        # From where a limit stopped the climb, another way may lead on.
        if free and _same(case):
            continue
        copy_view(case.two, case.one)
        value = climb(case, tried)
        if value > height + LEAST_GAIN:
            add_peak(case, tried, value)
            if value > best:
                best = value
                _part_way(tried, tried, 0.0, 0.0, top)
        feasible(case, case.one, at)
    return best


@part
def _arrived(case, at, goal):
    """Whether the peak is the optimum of its correspondences: no limit stopped the climb to it."""
    optimum(case, case.one, at, 0.0, goal)
    turn = abs(wrapped(goal[0] - at[0]))
    return max(turn, abs(goal[1] - at[1]), abs(goal[2] - at[2])) < ARRIVED


@part
def _most_spared(case):
    """What a plane that is let go spares at most, as its wall has moved."""
    view, limits = case.one, case.limits
    for i in range(len(view.state)):
        if view.state[i] == MOVED:
            return max(0.0, math.log(limits.together + limits.alone))
    return 0.0


@part
def _strain(case):
    """What the planes that fit pay for their residuals, at most."""
    view, limits = case.one, case.limits
    total = 0.0
    for i in range(len(view.state)):
        if view.state[i] == FIT:
            total += view.offset[i] * view.offset[i] * limits.plane_weight
            total += view.bend[i] * view.bend[i] * limits.angle_weight
    return total


@part
def _last_feasible(case, at, goal, tried):
    """Into ``tried`` the last feasible placement found by bisection on the way to ``goal``."""
    low, high, last = 0.0, 1.0, 0.0
    turn = wrapped(goal[0] - at[0])
    while high - low > SMALLEST_STEP:
        share = (low + high) / 2
        _part_way(at, goal, turn, share, tried)
        if feasible(case, case.two, tried):
            low = last = share
        else:
            high = share
    if last == 0.0:
        return False
    _part_way(at, goal, turn, last, tried)
    return feasible(case, case.two, tried)


@part
def _part_way(at, goal, turn, share, out):
    out[0] = at[0] + share * turn
    out[1] = at[1] + share * (goal[1] - at[1])
    out[2] = at[2] + share * (goal[2] - at[2])


@part
def _same(case):
    """Whether the two views hold the same correspondences in the same states."""
    one, two = case.one, case.two
    for r in range(len(one.room)):
        if one.room[r] != two.room[r]:
            return False
    for i in range(len(one.row)):
        if one.row[i] != two.row[i] or one.state[i] != two.state[i]:
            return False
    return True
