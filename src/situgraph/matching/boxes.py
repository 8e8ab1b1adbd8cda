"""Boxes of placements: what can be explained somewhere inside, and the box made smaller by it.

A box is anchored at a point of the map, the arm ``(ax, ay)`` from the mean room centre; it holds
the placements that turn by ``yaw`` up to ``turn`` more or less and take the anchor to ``(px,
py)`` plus up to ``hu`` along the axis ``(ux, uy)`` and up to ``hv`` across it.
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math

from situgraph.matching.compiled import part
from situgraph.matching.containment import may_be
from situgraph.matching.explained import may_explain
from situgraph.matching.hulls import hull, plane_spans
from situgraph.matching.lookup import Reach, find
from situgraph.matching.pairing import add_option, pair_up
from situgraph.matching.plain import QUARTER
from situgraph.matching.records import scratch
from situgraph.matching.slack import Slack, give, wrapped
from situgraph.matching.tables import WORK

YAW, TURN, PX, PY, UX, UY, HU, HV, AX, AY = range(10)  # columns of a box
SIDES = 10
ROUNDS = 8  # of shrinking one box
GAIN = 0.8  # a round that leaves more of the box is the last


@part
def slack_of(box, wx, wy):
    """What may change inside the box for a room at ``(wx, wy)``, turned, from the anchor."""
    turn, bend, swing = box[TURN], 1 - math.cos(box[TURN]), math.sin(box[TURN])
    return Slack(turn, box[UX], box[UY], box[HU], box[HV], wx, wy, bend, swing)


@part
def reach_of(box):
    """The placements of a box, for rooms to be looked up."""
    yaw, turn, ax, ay, px, py = box[YAW], box[TURN], box[AX], box[AY], box[PX], box[PY]
    c, s, bend, swing = math.cos(yaw), math.sin(yaw), 1 - math.cos(turn), math.sin(turn)
    sweep = 2 * math.sin(turn / 2)
    return Reach(yaw, turn, c, s, bend, swing, sweep, ax, ay, px, py, radius(box))


@part
def reach_again(case, box):
    """``reach_of`` a box whose yaws are those of many others: the last of each quarter are kept."""
    kept = case.spans.turned[round(box[YAW] / QUARTER) & 3]
    if kept[0] != box[YAW] or kept[1] != box[TURN]:
        new = reach_of(box)
        kept[0], kept[1], kept[2], kept[3] = new.yaw, new.turn, new.cos, new.sin
        kept[4], kept[5], kept[6] = new.bend, new.swing, new.sweep
    turned = (kept[0], kept[1], kept[2], kept[3], kept[4], kept[5], kept[6])
    return Reach(*turned, box[AX], box[AY], box[PX], box[PY], radius(box))


@part
def slack_at(box, at, wx, wy):
    """``slack_of`` a box whose ``reach_of`` is known."""
    return Slack(at.turn, box[UX], box[UY], box[HU], box[HV], wx, wy, at.bend, at.swing)


@part
def slack_of_room(case, box, at, r):
    """``slack_of`` a box for room ``r``, the ``reach_of`` the box is known."""
    gx, gy = case.seen.center[r, 0] - box[AX], case.seen.center[r, 1] - box[AY]
    return slack_at(box, at, at.cos * gx - at.sin * gy, at.sin * gx + at.cos * gy)


@part
def radius(box):
    """How far the anchor moves inside the box."""
    return math.sqrt(box[HU] ** 2 + box[HV] ** 2)


@part
def centre(box, out):
    """The placement (yaw, x, y of the mean room centre) in the middle of a box."""
    c, s = math.cos(box[YAW]), math.sin(box[YAW])
    out[0] = wrapped(box[YAW])
    out[1] = box[PX] - c * box[AX] + s * box[AY]
    out[2] = box[PY] - s * box[AX] - c * box[AY]


@part
def move_anchor(box):
    """Anchor the box at the mean room centre instead: it holds what it held, and more."""
    at = scratch(3)
    centre(box, at)
    wx, wy = at[1] - box[PX], at[2] - box[PY]
    slack = slack_of(box, wx, wy)
    box[HU], box[HV] = give(slack, box[UX], box[UY]), give(slack, -box[UY], box[UX])
    box[PX], box[PY] = at[1], at[2]
    box[AX] = box[AY] = 0.0


@part
def possible(case, box, at, r):
    """Whether room ``r`` may be explained somewhere in the box, whose ``reach_of`` is ``at``."""
    seen, finder, task = case.seen, case.finder, case.task
    storey = task.storeys[seen.storey[r]]
    if storey < 0:
        return False
    found = find(case, r, storey, at, False)
    if found < 0:
        return True
    gx, gy = seen.center[r, 0] - box[AX], seen.center[r, 1] - box[AY]
    wx, wy = at.cos * gx - at.sin * gy, at.sin * gx + at.cos * gy
    slack = slack_at(box, at, wx, wy)
    for k in range(found):
        a = finder.room[k]
        if may_be(case, r, a) and may_explain(
            case, r, a, box[YAW], box[PX] + wx, box[PY] + wy, slack
        ):
            return True
    return False


@part
def confine(case, box, r):
    """Cut from a box where room ``r`` cannot be explained; False when that is all of it."""
    spans = case.spans
    case.options.count[r] = 0
    if not _span(case, box, reach_again(case, box), r):
        return False
    for side in range(3):
        _cut(box, side, spans.low[side, r], spans.high[side, r])
    return True


@part
def shrink(case, box):
    """Cut from the box what cannot be feasible; False when nothing is left.

    At least ``least`` rooms must be explained at a feasible placement, and the required ones. So
    its yaw is not below the ``least``-th smallest of the rooms' lowest yaws; likewise on all six
    sides.
    """
    seen, options, spans, task = (
        case.seen,
        case.options,
        case.spans,
        case.task,
    )
    rooms, at = len(seen.storey), reach_of(box)
    counted, lost, order = 0, 0.0, spans.order
    for k in range(rooms):
        r = order[k]
        options.count[r] = 0
        if _span(case, box, at, r):
            counted += 1
        else:
            spans.low[0, r] = math.inf
            lost += task.loss[r]
            first = k - counted
            order[first], order[k] = order[k], order[first]
            few = counted + rooms - k - 1 < task.least
            if spans.required[r] or few or lost > task.budget:
                return False
    if not _enough_apart(case):
        return False
    for side in range(3):
        low = _extreme(case, spans.low[side], 1.0)
        high = -_extreme(case, spans.high[side], -1.0)
        if low > high:
            return False
        _cut(box, side, low, high)
    return True


@part
def squeeze(case, box, arm):
    """Shrink a box while it pays; False when nothing is left."""
    before = extent(box, arm)
    return shrink(case, box) and squeeze_on(case, box, arm, before)


@part
def squeeze_on(case, box, arm, before):
    """Go on with a box that was shrunk once, from the extent ``before``."""
    for _ in range(1, ROUNDS):
        now = extent(box, arm)
        if now > GAIN * before:
            break
        before = now
        if not shrink(case, box):
            return False
    return True


@part
def extent(box, arm):
    """How large a box is: its half widths, with that of the yaw as far as ``arm`` tells it."""
    return box[TURN] * arm + box[HU] + box[HV]


@part
def _cut(box, side, low, high):
    """Keep of a box what lies between two values on one axis."""
    middle, half = (low + high) / 2, (high - low) / 2
    if side == 0:
        box[YAW] += middle
        box[TURN] = min(half, box[TURN])
    elif side == 1:
        box[PX] += middle * box[UX]
        box[PY] += middle * box[UY]
        box[HU] = min(half, box[HU])
    else:
        box[PX] -= middle * box[UY]
        box[PY] += middle * box[UX]
        box[HV] = min(half, box[HV])


@part
def narrow(case, box, r, a):
    """Cut from a box that is anchored at ``r`` what ``a`` cannot explain; False if that is all."""
    spans = case.spans
    slack = slack_of(box, 0.0, 0.0)
    if not may_explain(case, r, a, box[YAW], box[PX], box[PY], slack):
        return False
    for side in range(3):
        spans.low[side, r], spans.high[side, r] = math.inf, -math.inf
    plane_spans(case, r, a, box[YAW], box[PX], box[PY], slack)
    if not hull(case, (box[TURN], box[HU], box[HV]), r):
        return False
    for side in range(3):
        _cut(box, side, spans.low[side, r], spans.high[side, r])
    return True


@part
def _extreme(case, bound, sign):
    """The ``least``-th smallest of ``sign * bound`` over the rooms.

    Not below any required room's.
    """
    spans, task = case.spans, case.task
    count, must = 0, -math.inf
    for r in range(len(bound)):
        if spans.low[0, r] == math.inf:
            continue
        value = sign * bound[r]
        if spans.required[r] and value > must:
            must = value
        k = count
        while k > 0 and spans.sorted[k - 1] > value:
            spans.sorted[k] = spans.sorted[k - 1]
            k -= 1
        spans.sorted[k] = value
        case.found.count[WORK] += 1 + (count - k) // 4
        count += 1
    return max(spans.sorted[task.least - 1], must)


@part
def _enough_apart(case):
    """Whether enough rooms can go to prior rooms of their own."""
    options, spans, task = case.options, case.spans, case.task
    free = 0
    for r in range(len(options.count)):
        if options.count[r] < 0:  # anything is possible
            options.count[r] = 0
            free += 1
            continue
        for k in range(options.count[r]):
            a = options.room[r, k]
            if options.owner[a] == 0:
                options.owner[a] = 1
                free += 1
                break
    for r in range(len(options.count)):
        for k in range(options.count[r]):
            options.owner[options.room[r, k]] = 0
    if free >= task.least:
        return True
    unknown = 0
    for r in range(len(options.count)):
        unknown += options.count[r] == 0 and spans.wide[r]
    return unknown + pair_up(case, case.two.room) >= task.least


@part
def _span(case, box, at, r):
    """Where in the box ``r`` can be explained, as a hull on the three axes; False when nowhere."""
    seen, finder, options = case.seen, case.finder, case.options
    spans, task = case.spans, case.task
    storey = task.storeys[seen.storey[r]]
    spans.wide[r] = False
    if storey < 0:
        return False
    found = find(case, r, storey, at, False)
    half = (box[TURN], box[HU], box[HV])
    if found < 0:
        spans.wide[r] = True
        options.count[r] = -1
        for side in range(3):
            spans.low[side, r], spans.high[side, r] = -half[side], half[side]
        return True
    gx, gy = seen.center[r, 0] - box[AX], seen.center[r, 1] - box[AY]
    wx, wy = at.cos * gx - at.sin * gy, at.sin * gx + at.cos * gy
    slack = slack_at(box, at, wx, wy)
    x, y = box[PX] + wx, box[PY] + wy
    for side in range(3):
        spans.low[side, r], spans.high[side, r] = math.inf, -math.inf
    for k in range(found):
        a = finder.room[k]
        if not may_be(case, r, a):
            continue
        if not may_explain(case, r, a, box[YAW], x, y, slack):
            continue
        plane_spans(case, r, a, box[YAW], x, y, slack)
        if hull(case, half, r):
            add_option(case, r, a, 0.0)
    return spans.low[0, r] < math.inf
