"""What one plane more or less does to a peak, by its leverage: no placement is looked at."""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math

from situgraph.matching.compiled import part
from situgraph.matching.optimum import solve
from situgraph.matching.slack import wrapped
from situgraph.matching.tables import FIT

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
        cx, cy = seen.center[r, 0], seen.center[r, 1]
        x, y = at[1] + c * cx - s * cy, at[2] + s * cx + c * cy
        margin[2] = max(margin[2], math.hypot(cx, cy))
        for i in range(seen.first[r], seen.first[r + 1]):
            for j in range(plan.first[a], plan.first[a + 1]):
                bend = abs(wrapped(seen.angle[i] + at[0] - plan.row[j, 3]))
                margin[1] = min(margin[1], abs(bend - limits.angle))
                if bend > limits.angle:
                    continue
                reach = plan.row[j, 0] * x + plan.row[j, 1] * y + plan.row[j, 2]
                off = abs(seen.distance[i] - reach)
                margin[0] = min(margin[0], abs(off - limits.fit), abs(off - limits.moved))


@part
def stays_low(case, at, r, i, system, margin, spared, step):
    """Whether letting plane ``i`` go, or holding it, leads no higher than the peak.

    That follows from its leverage, unless another plane changes its state on the way.
    """
    view, seen, plan, limits, tally = case.one, case.seen, case.plan, case.limits, case.tally
    p, j, fit = seen.plane[i], view.row[i], view.state[i] == FIT
    if tally.sums[p, 0] + tally.sums[p, 3] != 1:
        return False
    c, s = math.cos(at[0]), math.sin(at[0])
    cx, cy = seen.center[r, 0], seen.center[r, 1]
    nx, ny = plan.row[j, 0], plan.row[j, 1]
    turn = ny * (c * cx - s * cy) - nx * (s * cx + c * cy)
    if not solve(system, turn, nx, ny, step):
        return False
    weight, worth = limits.plane_weight, limits.fit_peak - limits.moved_base
    off, ease = abs(view.offset[i]), turn * step[0] + nx * step[1] + ny * step[2]
    if fit:
        rest = 1.0 - weight * ease
        if rest < LEAST_REST or weight * off * off / rest > worth - spared:
            return False
        push = weight * off / rest
    else:
        pull = off - min(limits.fit, off / (1.0 + weight * ease))
        if ease < LEAST_EASE or pull * pull / ease + weight * (off - pull) ** 2 < worth:
            return False
        push = pull / ease
    push = math.copysign(push, view.offset[i] if not fit else -view.offset[i])
    for k in range(3):
        step[k] *= push
    swing, shift = abs(step[0]), abs(step[1]) + abs(step[2])
    if swing < margin[1] and shift + swing * margin[2] < margin[0]:
        return True
    return _keeps_states(case, at, step, i)


@part
def _keeps_states(case, at, step, changed):
    """Whether all planes but the one that is changed stay within their limits on a step, or beyond.

    Those of rooms that are explained, towards each plane of their prior rooms.
    """
    view, seen, plan, limits = case.one, case.seen, case.plan, case.limits
    c, s = math.cos(at[0]), math.sin(at[0])
    for r in range(len(view.room)):
        a = view.room[r]
        if a < 0:
            continue
        cx, cy = seen.center[r, 0], seen.center[r, 1]
        ax, ay = c * cx - s * cy, s * cx + c * cy
        for i in range(seen.first[r], seen.first[r + 1]):
            for j in range(plan.first[a], plan.first[a + 1]):
                if i == changed and j == view.row[i]:
                    continue
                bend = wrapped(seen.angle[i] + at[0] - plan.row[j, 3])
                near = abs(bend) <= limits.angle
                if near != (abs(bend + step[0]) <= limits.angle):
                    return False
                if not near:
                    continue
                nx, ny = plan.row[j, 0], plan.row[j, 1]
                off = seen.distance[i] - (nx * (at[1] + ax) + ny * (at[2] + ay) + plan.row[j, 2])
                then = abs(off - nx * step[1] - ny * step[2] - (ny * ax - nx * ay) * step[0])
                off = abs(off)
                if (off <= limits.fit) != (then <= limits.fit):
                    return False
                if (off <= limits.moved) != (then <= limits.moved):
                    return False
    return True
