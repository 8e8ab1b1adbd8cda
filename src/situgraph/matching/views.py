"""What one placement explains, and its log likelihood ratio.

Sections 2 and 4 of ``docs/matching.md``.
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math

from situgraph.matching.compiled import part
from situgraph.matching.containment import room_allowed
from situgraph.matching.explained import Slack, explain, wrapped
from situgraph.matching.lookup import find
from situgraph.matching.pairing import add_option, pair_up
from situgraph.matching.tables import FIT, MISSING, MOVED


@part
def look(case, spot, yaw, x, y, turn, loose):
    """Fill ``spot`` with what is explained when the mean room centre goes to ``(x, y)``.

    ``storeys[u]`` is the prior storey of online storey ``u``, -1 for none. ``turn`` and
    ``loose`` widen the residuals by radians and metres (0: strictly the definition). Returns how
    many rooms are explained.
    """
    view = spot
    seen, plan, task = case.seen, case.plan, case.task
    finder, options = case.finder, case.options
    c, s = math.cos(yaw), math.sin(yaw)
    slack = Slack(turn, 1.0, 0.0, loose, loose, 0.0, 0.0, 0.0, 0.0)
    for r in range(len(seen.storey)):
        options.count[r] = 0
        if task.storeys[seen.storey[r]] < 0:
            continue
        cx, cy = seen.center[r, 0], seen.center[r, 1]
        rx, ry = x + c * cx - s * cy, y + s * cx + c * cy
        found = find(
            case, r, task.storeys[seen.storey[r]], yaw, 0.0, 0.0, 0.0, x, y, 1.5 * loose, True
        )
        for k in range(found):
            a = finder.room[k]
            if room_allowed(case, r, a):
                score = explain(case, r, a, yaw, rx, ry, slack)
                if score > -math.inf:
                    add_option(case, r, a, score)
                    if options.room[r, 0] == a:
                        _note(case, spot, r)
    count = pair_up(case, view.room)
    for r in range(len(seen.storey)):
        a = view.room[r]
        cx, cy = seen.center[r, 0], seen.center[r, 1]
        rx, ry = x + c * cx - s * cy, y + s * cx + c * cy
        if a >= 0 and a != options.room[r, 0]:
            explain(case, r, a, yaw, rx, ry, slack)
            _note(case, spot, r)
        for i in range(seen.first[r], seen.first[r + 1]):
            if a < 0:
                view.state[i] = -1
                view.row[i] = -1
            elif view.row[i] >= 0:
                j = view.row[i]
                view.bend[i] = wrapped(seen.angle[i] + yaw - plan.row[j, 3])
                reach = plan.row[j, 0] * rx + plan.row[j, 1] * ry + plan.row[j, 2]
                view.offset[i] = seen.distance[i] - reach
    return count


@part
def _note(case, spot, r):
    view = spot
    seen, bench = case.seen, case.bench
    begin = seen.first[r]
    for i in range(begin, seen.first[r + 1]):
        view.row[i] = bench.kept[i - begin]
        view.state[i] = bench.state[i - begin]


@part
def fixes(case, spot):
    """Whether the planes that fit are not all parallel."""
    view = spot
    seen, limits = case.seen, case.limits
    first = -1
    for i in range(len(view.state)):
        if view.state[i] != FIT:
            continue
        if first < 0:
            first = i
        elif abs(math.sin(seen.angle[i] - seen.angle[first])) >= limits.sine:
            return True
    for i in range(len(view.state)):
        for k in range(i):
            both = view.state[i] == FIT and view.state[k] == FIT
            if both and abs(math.sin(seen.angle[i] - seen.angle[k])) >= limits.sine:
                return True
    return False


@part
def copy_view(source, target):
    """Copy the correspondences."""
    old, new = source, target
    for r in range(len(old.room)):
        new.room[r] = old.room[r]
    for i in range(len(old.row)):
        new.row[i] = old.row[i]
        new.state[i] = old.state[i]
        new.offset[i] = old.offset[i]
        new.bend[i] = old.bend[i]


@part
def tally_planes(case, spot):
    """Count the occurrences of each distinct plane by state, and sum their squared residuals."""
    view = spot
    seen, tally = case.seen, case.tally
    for p in range(seen.planes):
        tally.missing[p] = 0
        for k in range(5):
            tally.sums[p, k] = 0.0
    for i in range(len(view.state)):
        p = seen.plane[i]
        if view.state[i] == FIT:
            tally.sums[p, 0] += 1
            tally.sums[p, 1] += view.offset[i] * view.offset[i]
            tally.sums[p, 2] += view.bend[i] * view.bend[i]
        elif view.state[i] == MOVED:
            tally.sums[p, 3] += 1
            tally.sums[p, 4] += view.bend[i] * view.bend[i]
        elif view.state[i] == MISSING:
            tally.missing[p] += 1


@part
def evidence(case, spot):
    """L of the walls: distinct planes, and rooms explained or not."""
    view = spot
    seen, limits, tally = case.seen, case.limits, case.tally
    tally_planes(case, spot)
    total = 0.0
    for p in range(seen.planes):
        fits, moved = tally.sums[p, 0], tally.sums[p, 3]
        if fits > 0:
            total += limits.fit_peak - tally.sums[p, 1] / fits * limits.plane_weight
            total -= tally.sums[p, 2] / fits * limits.angle_weight
        elif moved > 0:
            total += limits.moved_base - tally.sums[p, 4] / moved * limits.angle_weight
        elif tally.missing[p] > 0:
            total += limits.missing
            continue
        total += tally.missing[p] * limits.missing_shared
    for r in range(len(view.room)):
        total += limits.room_true if view.room[r] >= 0 else limits.room_false
    return total
