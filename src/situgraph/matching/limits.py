"""Where on a straight way planes meet limits: there the rooms cease to be explained as they were.

It is guessed from how far each plane is off at both ends of the way, by its prior row alone, to be
looked at then: no room is looked up for it.
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math

from situgraph.matching.compiled import part
from situgraph.matching.effort import count_pairs
from situgraph.matching.optimum import arm_of, offset_of
from situgraph.matching.records import scratch
from situgraph.matching.slack import SLACK, wrapped

STRETCH = 1e-3  # share of the way, on which offsets change as on a straight line


@part
def first_limit(case, at, goal, alike):
    """The share of the way from ``at`` to ``goal`` at which too few rooms are explained, about.

    Or, when ``alike``, at which any plane gets another state. ``case.one`` must be the view at
    ``at``. 1 where that is not met on the way.
    """
    ends = scratch(6)
    share = _first(case, at, goal, 0.0, 1.0, alike, ends)
    if 0.0 < share < 1.0:
        low = max(share - STRETCH, 0.0)
        share = _first(case, at, goal, low, share + STRETCH, alike, ends)
    return min(max(share, 0.0), 1.0)


@part
def _first(case, at, goal, low, high, alike, ends):
    """The same, by how far the planes are off at two shares of the way."""
    view, order, count = case.one, case.spans.sorted, 0
    for r in range(len(view.room)):
        if view.room[r] < 0:
            continue
        _place(case, r, at, goal, low, ends, 0)
        _place(case, r, at, goal, high, ends, 3)
        share = _changes(case, r, ends) if alike else _falls(case, r, ends)
        k = count
        while k > 0 and order[k - 1] > share:
            order[k] = order[k - 1]
            k -= 1
        order[k] = share
        count += 1
    k = 0 if alike else count - case.task.least
    return low + (high - low) * order[k] if 0 <= k < count else 1.0


@part
def _place(case, r, at, goal, share, ends, k):
    """Into three of the ``ends``: the yaw and the centre of room ``r`` at a share of the way."""
    yaw = at[0] + share * wrapped(goal[0] - at[0])
    ax, ay = arm_of(case.seen, r, math.cos(yaw), math.sin(yaw))
    ends[k] = yaw
    ends[k + 1] = at[1] + share * (goal[1] - at[1]) + ax
    ends[k + 2] = at[2] + share * (goal[2] - at[2]) + ay


@part
def _changes(case, r, ends):
    """From one end on: when a plane of ``r`` first meets a limit of any plane of its prior room."""
    seen, plan, limits, a = case.seen, case.plan, case.limits, case.one.room[r]
    first = math.inf
    count_pairs(case, r, a)
    for i in range(seen.first[r], seen.first[r + 1]):
        for j in range(plan.first[a], plan.first[a + 1]):
            if abs(wrapped(seen.angle[i] + ends[0] - plan.row[j, 3])) > limits.angle:
                continue
            for k in range(4):
                limit = limits.moved if k & 1 else limits.fit
                share = _meets(case, i, j, limit, ends, k < 2)
                if 0.0 < share < first:
                    first = share
    return first


@part
def _falls(case, r, ends):
    """From one end on: when ``r`` is not explained any more.

    That is when two planes are missing, or no two fit that cross.
    """
    seen, view, limits, fits = case.seen, case.one, case.limits, case.spans.turn_low
    begin, missing, both, least = seen.first[r], math.inf, math.inf, math.inf
    for i in range(begin, seen.first[r + 1]):
        j, fit, near = view.row[i], -math.inf, -math.inf
        if j >= 0:
            fit = _meets(case, i, j, limits.fit, ends, True)
            near = _meets(case, i, j, limits.moved, ends, True)
        fits[i - begin] = fit
        least = min(least, fit)
        both = min(both, max(missing, near))
        missing = min(missing, near)
    if seen.strict[r]:
        return least
    crossed = -math.inf
    for c in range(seen.crossed_first[r], seen.crossed_first[r + 1]):
        i, k = seen.crossed[c, 0] - begin, seen.crossed[c, 1] - begin
        crossed = max(crossed, min(fits[i], fits[k]))
    return min(both, crossed)


@part
def _meets(case, i, j, limit, ends, leaves):
    """From one end on: when plane ``i`` leaves the limit of prior row ``j``, or comes within it.

    Negative where that lies behind.
    """
    one = offset_of(case, i, j, ends[1], ends[2])
    slope = offset_of(case, i, j, ends[4], ends[5]) - one
    if slope == 0.0:
        return math.inf
    edge = math.copysign(limit + SLACK, slope)
    return ((edge if leaves else -edge) - one) / slope
