"""What one plane more or less does to a peak, by its leverage: no placement is looked at."""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math

from situgraph.matching.compiled import part
from situgraph.matching.optimum import arm_of, offset_of, solve
from situgraph.matching.slack import wrapped
from situgraph.matching.tables import FIT, MOVED

LEAST_REST = 1e-3  # share of what a plane says that others say as well, to go by its leverage
LEAST_EASE = 1e-9  # square metres by which a plane gives way to one unit of L


@part
def measure_margins(case, at, margin):
    """The least change of an offset, and of an angle, by which a plane fits, is moved or missing.

    Third the longest lever arm. Of rooms that are explained, with the planes of their prior rooms.
    """
    view, seen, plan, limits = case.one, case.seen, case.plan, case.limits
    margin[0], margin[1], margin[2] = math.inf, math.inf, 0.0
    c, s = math.cos(at[0]), math.sin(at[0])
    for r in range(len(view.room)):
        a = view.room[r]
        if a < 0:
            continue
        ax, ay = arm_of(seen, r, c, s)
        margin[2] = max(margin[2], math.hypot(ax, ay))
        for i in range(seen.first[r], seen.first[r + 1]):
            for j in range(plan.first[a], plan.first[a + 1]):
                bend = abs(wrapped(seen.angle[i] + at[0] - plan.row[j, 3]))
                margin[1] = min(margin[1], abs(bend - limits.angle))
                if bend > limits.angle:
                    continue
                off = abs(offset_of(case, i, j, at[1] + ax, at[2] + ay))
                margin[0] = min(margin[0], abs(off - limits.fit), abs(off - limits.moved))


@part
def nearly_moved(case, at, r, i):
    """The wall nearest by of those just beyond where missing plane ``i`` would be moved, or -1."""
    seen, plan, limits, a = case.seen, case.plan, case.limits, case.one.room[r]
    nearest, found = limits.moved + limits.fit, -1
    ax, ay = arm_of(seen, r, math.cos(at[0]), math.sin(at[0]))
    for j in range(plan.first[a], plan.first[a + 1]):
        if abs(wrapped(seen.angle[i] + at[0] - plan.row[j, 3])) > limits.angle:
            continue
        off = abs(offset_of(case, i, j, at[1] + ax, at[2] + ay))
        if limits.moved < off < nearest:
            nearest, found = off, j
    return found


@part
def stays_low(case, at, r, i, j, system, margin, spared, step):
    """Whether letting plane ``i`` go, holding it or not missing it leads no higher than the peak.

    That follows from its leverage, unless another plane changes its state on the way. ``j`` is its
    prior row.
    """
    view, seen, plan, limits, tally = case.one, case.seen, case.plan, case.limits, case.tally
    p, state = seen.plane[i], view.state[i]
    if tally.sums[p, 0] + tally.sums[p, 3] + tally.missing[p] != 1:
        return False
    ax, ay = arm_of(seen, r, math.cos(at[0]), math.sin(at[0]))
    nx, ny = plan.row[j, 0], plan.row[j, 1]
    turn, offset = ny * ax - nx * ay, offset_of(case, i, j, at[1] + ax, at[2] + ay)
    if not solve(system, turn, nx, ny, step):
        return False
    weight, worth = limits.plane_weight, limits.fit_peak - limits.moved_base
    off, ease = abs(offset), turn * step[0] + nx * step[1] + ny * step[2]
    if state == FIT:
        rest = 1.0 - weight * ease
        if rest < LEAST_REST or weight * off * off / rest > worth - spared:
            return False
        push = -weight * off / rest
    else:
        pull, gain = off - limits.moved, limits.moved_base - limits.missing + spared
        if state == MOVED:
            pull = off - min(limits.fit, off / (1.0 + weight * ease))
            gain = worth - weight * (off - pull) ** 2
        if ease < LEAST_EASE or pull * pull / ease < gain:
            return False
        push = pull / ease
    push *= math.copysign(1.0, offset)
    for k in range(3):
        step[k] *= push
    swing, shift = abs(step[0]), abs(step[1]) + abs(step[2])
    if swing < margin[1] and shift + swing * margin[2] < margin[0]:
        return True
    return _keeps_states(case, at, step, i, j)


@part
def _keeps_states(case, at, step, changed, row):
    """Whether all planes but the one that is changed stay within their limits on a step, or beyond.

    Those of rooms that are explained, towards each plane of their prior rooms.
    """
    view, seen, plan, limits = case.one, case.seen, case.plan, case.limits
    c, s = math.cos(at[0]), math.sin(at[0])
    for r in range(len(view.room)):
        a = view.room[r]
        if a < 0:
            continue
        ax, ay = arm_of(seen, r, c, s)
        for i in range(seen.first[r], seen.first[r + 1]):
            for j in range(plan.first[a], plan.first[a + 1]):
                if i == changed and j == row:
                    continue
                bend = wrapped(seen.angle[i] + at[0] - plan.row[j, 3])
                near = abs(bend) <= limits.angle
                if near != (abs(bend + step[0]) <= limits.angle):
                    return False
                if not near:
                    continue
                nx, ny = plan.row[j, 0], plan.row[j, 1]
                off = offset_of(case, i, j, at[1] + ax, at[2] + ay)
                then = abs(off - nx * step[1] - ny * step[2] - (ny * ax - nx * ay) * step[0])
                off = abs(off)
                if (off <= limits.fit) != (then <= limits.fit):
                    return False
                if (off <= limits.moved) != (then <= limits.moved):
                    return False
    return True
