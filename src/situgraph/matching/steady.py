"""What was found of a room at one placement, and how far from there the same would be found.

Climbing looks at placements a few centimetres apart. There most rooms are explained by the same
prior room, plane by plane in the same states: only the residuals are other ones.
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math

from situgraph.matching.compiled import part
from situgraph.matching.containment import plane_allowed, room_allowed
from situgraph.matching.explained import may_explain
from situgraph.matching.lookup import Reach, find
from situgraph.matching.slack import SLACK, Slack, wrapped
from situgraph.matching.strands import row_at, rows_near

FARTHEST = 0.05  # metres by which a room's centre may lie elsewhere, at most
WIDEST = 0.005  # rad by which the yaw may be another, at most
NEARBY = 0.3  # metres from where a room was looked at before, to look how far it is steady


@part
def is_steady(case, r, storey, yaw, x, y):
    """Whether what was found last of room ``r`` is found here too, with its centre at (x, y)."""
    last = case.steady
    turn, dx, dy = abs(wrapped(yaw - last.place[r, 0])), x - last.place[r, 1], y - last.place[r, 2]
    far = last.reach[r, 1]
    return turn < last.reach[r, 0] and dx * dx + dy * dy < far * far and last.storey[r] == storey


@part
def recall_steady(case, spot, r):
    """The option of a steady room, without its score, and its planes."""
    last, seen, options, view = case.steady, case.seen, case.options, spot
    if last.room[r] < 0:
        return
    options.count[r], options.room[r, 0], options.score[r, 0] = 1, last.room[r], 0.0
    for i in range(seen.first[r], seen.first[r + 1]):
        view.row[i], view.state[i] = last.row[i], last.state[i]


@part
def keep_steady(case, spot, r, storey, yaw, x, y):
    """Keep what has been found here of room ``r`` (in ``options``), and how far it is steady.

    That is looked for only where the room was near before: else it is not worth the time.
    """
    last, seen, options, view = case.steady, case.seen, case.options, spot
    dx, dy = x - last.place[r, 1], y - last.place[r, 2]
    again = dx * dx + dy * dy < NEARBY * NEARBY and last.storey[r] == storey
    last.place[r, 0], last.place[r, 1], last.place[r, 2] = yaw, x, y
    last.storey[r] = storey
    last.reach[r, 0] = last.reach[r, 1] = 0.0
    if not again or options.count[r] > 1:
        return
    last.room[r] = options.room[r, 0] if options.count[r] == 1 else -1
    for i in range(seen.first[r], seen.first[r + 1]):
        last.row[i], last.state[i] = view.row[i], view.state[i]
    if not _others_out(case, r, storey, yaw, x, y):
        return
    last.reach[r, 0], last.reach[r, 1] = WIDEST, FARTHEST
    if last.room[r] >= 0 and not _measure(case, r, yaw, x, y):
        last.reach[r, 0] = last.reach[r, 1] = 0.0


@part
def _others_out(case, r, storey, yaw, x, y):
    """Whether no prior room but the one that explains ``r`` here could do so near here."""
    seen, finder = case.seen, case.finder
    c, s, swing = math.cos(yaw), math.sin(yaw), math.sin(WIDEST)
    bend, sweep = 1.0 - math.cos(WIDEST), 2.0 * math.sin(WIDEST / 2.0)
    cx, cy = seen.center[r, 0], seen.center[r, 1]
    near = Reach(yaw, WIDEST, c, s, bend, swing, sweep, cx, cy, x, y, FARTHEST)
    slack = Slack(WIDEST, 1.0, 0.0, FARTHEST, FARTHEST, 0.0, 0.0, bend, swing)
    for k in range(find(case, r, storey, near, True)):
        a = finder.room[k]
        other = a != case.steady.room[r] and room_allowed(case, r, a)
        if other and may_explain(case, r, a, yaw, x, y, slack):
            return False
    return True


@part
def _measure(case, r, yaw, x, y):
    """How far all planes of ``r`` keep their states; False unless each has one counterpart at most.

    ``steady.row`` are those it has here.
    """
    last, seen, plan, limits = case.steady, case.seen, case.plan, case.limits
    a, shift, turn = last.room[r], FARTHEST, WIDEST
    slack = Slack(WIDEST, 1.0, 0.0, FARTHEST, FARTHEST, 0.0, 0.0, 0.0, 0.0)
    # A moved plane that is bent further is rather missing.
    bent = math.sqrt(max(0.0, (limits.moved_base - limits.missing) / limits.angle_weight))
    lowest = limits.fit_peak - limits.fit**2 * limits.plane_weight
    if lowest - limits.angle**2 * limits.angle_weight < limits.missing:
        return False
    for i in range(seen.first[r], seen.first[r + 1]):
        top, rows = rows_near(case, a, i, yaw, x, y, limits.moved, slack)
        own = -1
        for k in range(rows):
            j = row_at(case, top, k)
            bend = abs(wrapped(seen.angle[i] + yaw - plan.row[j, 3]))
            turn = min(turn, abs(bend - limits.angle - SLACK))
            if bend > limits.angle + WIDEST or not plane_allowed(case, i, j):
                continue
            off = plan.row[j, 0] * x + plan.row[j, 1] * y + plan.row[j, 2]
            off = abs(seen.distance[i] - off) - SLACK
            shift = min(shift, abs(off - limits.fit), abs(off - limits.moved))
            if bend > limits.angle + SLACK or off > limits.moved:
                continue
            if own >= 0:
                return False
            own = j
            if off > limits.fit:
                turn = min(turn, bent - bend)
        if own != last.row[i]:
            return False
    last.reach[r, 0], last.reach[r, 1] = turn - SLACK, shift - SLACK
    return True
