"""What one placement explains, and its log likelihood ratio: sections 2 and 4 of ``docs/matching.md``."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from situgraph.matching.compiled import kernel
from situgraph.matching.containment import room_allowed
from situgraph.matching.explained import Bench, Slack, explain, new_bench, wrapped
from situgraph.matching.lookup import Finder, find, new_finder
from situgraph.matching.pairing import Options, add_option, new_options, pair_up
from situgraph.matching.tables import FIT, MISSING, MOVED, Flags, Floats, Ints


class View(NamedTuple):
    """The correspondences at a placement."""

    room: Ints  # (N,) prior room, -1 for none
    row: Ints  # (P,) prior row of each online row of an explained room, -1 for none
    state: Ints  # (P,) FIT, MOVED or MISSING; -1 in rooms that are not explained
    offset: Floats  # (P,) residuals, where there is a prior row
    bend: Floats  # (P,)


class Work(NamedTuple):
    """Room to work in; one per match."""

    finder: Finder
    bench: Bench
    options: Options
    tally: Floats  # (planes, 5) fits, their squares of offset and bend; moved, their squares of bend
    missing: Ints  # (planes,)
    wide: Flags  # (N,) rooms of which a box is too wide to say where they go
    one: View
    two: View


@kernel
def new_view(rooms, rows):
    """A view of nothing."""
    return View(
        np.full(rooms, -1, dtype=np.int64),
        np.full(rows, -1, dtype=np.int64),
        np.full(rows, -1, dtype=np.int64),
        np.zeros(rows),
        np.zeros(rows),
    )


@kernel
def new_work(seen, plan):
    """Room to work in for these tables."""
    rooms, rows = len(seen.storey), len(seen.angle)
    widest, broadest = 1, 1
    for r in range(rooms):
        widest = max(widest, seen.first[r + 1] - seen.first[r])
    for a in range(len(plan.storey)):
        broadest = max(broadest, plan.first[a + 1] - plan.first[a])
    return Work(
        new_finder(len(plan.storey)),
        new_bench(widest, broadest),
        new_options(rooms, len(plan.storey)),
        np.zeros((seen.planes, 5)),
        np.zeros(seen.planes, dtype=np.int64),
        np.zeros(rooms, dtype=np.bool_),
        new_view(rooms, rows),
        new_view(rooms, rows),
    )


@kernel
def look(seen, plan, limits, content, storeys, work, view, yaw, x, y, turn, loose):
    """Fill ``view`` with what is explained when the mean room centre goes to ``(x, y)``.

    ``storeys[u]`` is the prior storey of online storey ``u``, -1 for none. ``turn`` and
    ``loose`` widen the residuals by radians and metres (0: strictly the definition). Returns how many rooms are explained.
    """
    options = work.options
    c, s = math.cos(yaw), math.sin(yaw)
    slack = Slack(turn, 1.0, 0.0, loose, loose, 0.0, 0.0, 0.0, 0.0)
    for r in range(len(seen.storey)):
        options.count[r] = 0
        if storeys[seen.storey[r]] < 0:
            continue
        cx, cy = seen.center[r, 0], seen.center[r, 1]
        rx, ry = x + c * cx - s * cy, y + s * cx + c * cy
        found = find(
            seen, plan, limits, work.finder, r, storeys[seen.storey[r]],
            yaw, 0.0, 0.0, 0.0, x, y, 1.5 * loose, True,
        )
        for k in range(found):
            a = work.finder.room[k]
            if room_allowed(content, r, a):
                score = explain(seen, plan, limits, content, r, a, yaw, rx, ry, slack, work.bench)
                if score > -np.inf:
                    add_option(options, r, a, score)
                    if options.room[r, 0] == a:
                        _note(seen, view, work.bench, r)
    count = pair_up(options, view.room)
    for r in range(len(seen.storey)):
        a = view.room[r]
        cx, cy = seen.center[r, 0], seen.center[r, 1]
        rx, ry = x + c * cx - s * cy, y + s * cx + c * cy
        if a >= 0 and a != options.room[r, 0]:
            explain(seen, plan, limits, content, r, a, yaw, rx, ry, slack, work.bench)
            _note(seen, view, work.bench, r)
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


@kernel
def _note(seen, view, bench, r):
    begin = seen.first[r]
    for i in range(begin, seen.first[r + 1]):
        view.row[i] = bench.kept[i - begin]
        view.state[i] = bench.state[i - begin]


@kernel
def fixes(seen, limits, view):
    """Whether the planes that fit are not all parallel."""
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
            if view.state[i] == FIT and view.state[k] == FIT:
                if abs(math.sin(seen.angle[i] - seen.angle[k])) >= limits.sine:
                    return True
    return False


@kernel
def copy_view(source, target):
    """Copy the correspondences."""
    target.room[:] = source.room
    target.row[:] = source.row
    target.state[:] = source.state
    target.offset[:] = source.offset
    target.bend[:] = source.bend


@kernel
def tally_planes(seen, view, work):
    """Count the occurrences of each distinct plane by state, and sum their squared residuals."""
    work.tally[:] = 0.0
    work.missing[:] = 0
    for i in range(len(view.state)):
        p = seen.plane[i]
        if view.state[i] == FIT:
            work.tally[p, 0] += 1
            work.tally[p, 1] += view.offset[i] ** 2
            work.tally[p, 2] += view.bend[i] ** 2
        elif view.state[i] == MOVED:
            work.tally[p, 3] += 1
            work.tally[p, 4] += view.bend[i] ** 2
        elif view.state[i] == MISSING:
            work.missing[p] += 1


@kernel
def evidence(seen, limits, view, work):
    """L of the walls: distinct planes, and rooms explained or not."""
    tally_planes(seen, view, work)
    total = 0.0
    for p in range(seen.planes):
        fits, moved = work.tally[p, 0], work.tally[p, 3]
        if fits > 0:
            total += limits.fit_peak - work.tally[p, 1] / fits * limits.plane_weight
            total -= work.tally[p, 2] / fits * limits.angle_weight
        elif moved > 0:
            total += limits.moved_base - work.tally[p, 4] / moved * limits.angle_weight
        elif work.missing[p] > 0:
            total += limits.missing
            continue
        total += work.missing[p] * limits.missing_shared
    for r in range(len(view.room)):
        total += limits.room_true if view.room[r] >= 0 else limits.room_false
    return total
