"""Boxes of placements that bring planes of an online room onto planes of a prior room."""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math

from situgraph.matching.boxes import (
    AX,
    AY,
    HU,
    HV,
    PX,
    PY,
    SIDES,
    TURN,
    UX,
    UY,
    YAW,
    narrow,
    slack_of,
)
from situgraph.matching.compiled import part
from situgraph.matching.effort import count_pairs
from situgraph.matching.explained import explain, may_explain
from situgraph.matching.plain import (
    BASE,
    COS,
    CX,
    CY,
    HIGH,
    LOW,
    QUARTER,
    SIN,
    plain_alike,
    plain_pair,
    plain_places,
)
from situgraph.matching.records import scratch
from situgraph.matching.slack import SLACK, no_slack, wrapped
from situgraph.matching.tables import WORK

MOST_CROSSED = 8  # pairs of planes of a room that are all tried
AT_END = 1e-6  # radians from an end of the yaws, where that is the angle tolerance
SHAPE_BOXES = 4000  # searched at most for one placement of one room in isolation


@part
def pair_box(case, i, k, j, m, wx, wy, reach, box):
    """The box in which plane ``i`` lies within ``reach`` of ``j`` and ``k`` of ``m``.

    False when there is none.

    Plane ``k`` may belong to another room, whose centre lies at ``(wx, wy)`` from the anchor.
    """
    seen, plan, limits = case.seen, case.plan, case.limits
    one = wrapped(plan.row[j, 3] - seen.angle[i])
    two = one + wrapped(plan.row[m, 3] - seen.angle[k] - one)
    turn = limits.angle + SLACK - abs(two - one) / 2
    if turn < 0:
        return False
    box[YAW], box[TURN] = (one + two) / 2, turn
    nx, ny, mx, my = plan.row[j, 0], plan.row[j, 1], plan.row[m, 0], plan.row[m, 1]
    cross = nx * my - ny * mx
    if abs(cross) < 0.02:
        return False
    fit = reach + SLACK
    gx, gy, other = 0.0, 0.0, fit
    if wx != 0.0 or wy != 0.0:
        c, s = math.cos(box[YAW]), math.sin(box[YAW])
        gx, gy = c * wx - s * wy, s * wx + c * wy
        other += abs(mx * gx + my * gy) * (1 - math.cos(turn))
        other += abs(my * gx - mx * gy) * math.sin(turn)
    near = seen.distance[i] - plan.row[j, 2]
    far = seen.distance[k] - plan.row[m, 2] - mx * gx - my * gy
    box[PX], box[PY] = (near * my - far * ny) / cross, (far * nx - near * mx) / cross
    box[UX], box[UY] = nx, ny
    box[HU] = fit
    box[HV] = (other + abs(nx * mx + ny * my) * fit) / abs(cross)
    return True


@part
def next_pair_box(case, r, i, k, a, at, reach, box):
    """The next ``pair_box`` of planes ``i`` and ``k`` of ``r`` with two planes of ``a``.

    From number ``at`` on; returns the number to go on from, -1 when there is none. The box must be
    anchored at ``r``.
    """
    seen, plan = case.seen, case.plan
    begin, n = plan.first[a], plan.first[a + 1] - plan.first[a]
    turn = seen.angle[k] - seen.angle[i]
    widest = 2.0 * (case.limits.angle + SLACK) + SLACK
    box[AX], box[AY] = seen.center[r, 0], seen.center[r, 1]
    while at < n * n:
        j, m = begin + at // n, begin + at % n
        at += 1
        if m == j or abs(wrapped(plan.row[m, 3] - plan.row[j, 3] - turn)) > widest:
            continue
        if pair_box(case, i, k, j, m, 0.0, 0.0, reach, box):
            return at
    return -1


@part
def next_plain_box(case, r, a, at, box):
    """The next box in which plain room ``a`` may explain plain room ``r``, of at most 16.

    From number ``at`` on; returns the number to go on from, -1 when there is none. What stands in
    the box must stay between the calls.
    """
    while at < 16:
        if at & 3 == 0:
            if not plain_places(case, r, a, at >> 2):
                at += 4
                continue
            _turned_box(case, r, a, at >> 2, box)
        at += 1
        if _placed_box(case, a, (at - 1) & 3, box):
            return at
    return -1


@part
def _turned_box(case, r, a, quarter, box):
    """The yaws of plain room ``r``, turned by so many quarters onto ``a``, and the axes."""
    seen, plan = case.seen, case.plan.plain
    low, high = seen.plain[r, LOW], seen.plain[r, HIGH]
    box[AX], box[AY] = seen.center[r, 0], seen.center[r, 1]
    turn = plan[a, BASE] - seen.plain[r, BASE] + quarter * QUARTER
    box[YAW], box[TURN] = wrapped(turn + (low + high) / 2), (high - low) / 2
    ux, uy = plan[a, COS], plan[a, SIN]
    for _ in range(quarter):
        ux, uy = -uy, ux
    box[UX], box[UY] = ux, uy


@part
def _placed_box(case, a, m, box):
    """Places number ``m`` of 4 that ``plain_places`` found, into a turned box; False if none."""
    plan, along = case.plan.plain, case.found.along
    one, two = along[0], along[1]
    i, k = m & 2, (m & 1) << 1
    if one[i + 1] < 0 or two[k + 1] < 0:
        return False
    box[HU], box[HV] = one[i + 1], two[k + 1]
    box[PX] = plan[a, CX] + one[i] * box[UX] - two[k] * box[UY]
    box[PY] = plan[a, CY] + one[i] * box[UY] + two[k] * box[UX]
    return True


@part
def pairs_of(case, r):
    """How many pairs of planes of ``r`` have to be tried, and within which reach of their own.

    Two planes that cross fit, so all such pairs will do. Of a room with many planes fewer will:
    at most one is missing, so the planes of one of its probes have counterparts, moved or not.
    """
    seen, limits = case.seen, case.limits
    crossed = seen.crossed_first[r + 1] - seen.crossed_first[r]
    if seen.strict[r] or crossed <= MOST_CROSSED:
        return crossed, limits.fit
    return seen.probe_first[r + 1] - seen.probe_first[r], limits.moved


@part
def pair_of(case, r, c):
    """The rows of pair ``c`` of those ``pairs_of`` counts."""
    seen = case.seen
    if seen.strict[r] or seen.crossed_first[r + 1] - seen.crossed_first[r] <= MOST_CROSSED:
        at = seen.crossed_first[r] + c
        return seen.crossed[at, 0], seen.crossed[at, 1]
    at = seen.probe_first[r] + c
    return seen.probe[at, 0], seen.probe[at, 1]


@part
def fits_somewhere(case, r, a):
    """Whether ``a`` explains ``r`` in isolation, at any placement."""
    if len(case.content.row_need) == 0 and plain_pair(case, r, a):
        return plain_alike(case, r, a)
    box = scratch(SIDES)
    pairs, reach = pairs_of(case, r)
    for c in range(pairs):
        i, k = pair_of(case, r, c)
        at = next_pair_box(case, r, i, k, a, 0, reach, box)
        while at >= 0:
            slack = slack_of(box, 0.0, 0.0)
            if may_explain(case, r, a, box[YAW], box[PX], box[PY], slack) and _explained_in(
                case, r, a, box
            ):
                return True
            at = next_pair_box(case, r, i, k, a, at, reach, box)
    return False


@part
def _explained_in(case, r, a, start):
    """Whether ``a`` explains ``r`` somewhere in the box; yes where it takes too long to tell."""
    limits = case.limits
    stack, box = case.found.stack, scratch(SIDES)
    copy_box(start, stack[0])
    depth = 1
    for _ in range(SHAPE_BOXES):
        if case.found.count[WORK] > limits.max_work:
            break
        if depth == 0:
            return False
        depth -= 1
        copy_box(stack[depth], box)
        if not narrow(case, box, r, a) or not narrow(case, box, r, a):
            continue
        if explain(case, r, a, box[YAW], box[PX], box[PY], no_slack()) > -math.inf:
            return True
        slack = slack_of(box, 0.0, 0.0)
        if explain(case, r, a, box[YAW], box[PX], box[PY], slack) == -math.inf:
            continue
        side, widest = 0, 5 * box[TURN]
        if box[HU] > widest or not _yaw_decides(case, r, a, box):
            side, widest = 1, box[HU]
        if box[HV] > widest:
            side, widest = 2, box[HV]
        if widest < limits.smallest_step or depth + 2 > len(stack):
            continue
        split(box, side, stack[depth], stack[depth + 1])
        depth += 2
    return depth > 0


@part
def _yaw_decides(case, r, a, box):
    """Whether some planes have the same direction at some yaws of the box only.

    Offsets are compared at the room's centre, so the yaw changes nothing else.
    """
    seen, plan, limits = case.seen, case.plan, case.limits
    count_pairs(case, r, a)
    for i in range(seen.first[r], seen.first[r + 1]):
        for j in range(plan.first[a], plan.first[a + 1]):
            bend = abs(wrapped(seen.angle[i] + box[YAW] - plan.row[j, 3]))
            if abs(bend - limits.angle) < box[TURN] - AT_END:
                return True
    return False


@part
def copy_box(source, target):
    """Copy a box."""
    for k in range(SIDES):
        target[k] = source[k]


@part
def split(box, side, one, two):
    """The two halves of a box, cut across an axis: 0 the yaw, 1 along, 2 across."""
    for k in range(SIDES):
        one[k] = two[k] = box[k]
    if side == 0:
        half = box[TURN] / 2
        one[TURN] = two[TURN] = half
        one[YAW] -= half
        two[YAW] += half
        return
    if side == 1:
        half = box[HU] / 2
        one[HU] = two[HU] = half
        x, y = box[UX] * half, box[UY] * half
    else:
        half = box[HV] / 2
        one[HV] = two[HV] = half
        x, y = -box[UY] * half, box[UX] * half
    one[PX] -= x
    one[PY] -= y
    two[PX] += x
    two[PY] += y


@part
def join(box, other, most):
    """Widen ``box`` to hold ``other``, of the same anchor; False, and nothing done.

    Where a half width would be more than ``most``, or the yaws differ by more than half of theirs.
    """
    if abs(wrapped(other[YAW] - box[YAW])) > box[TURN] / 2:
        return False
    both = scratch(SIDES)
    copy_box(box, both)
    enclose(both, other)
    if both[HU] > most or both[HV] > most:
        return False
    copy_box(both, box)
    return True


@part
def enclose(box, other):
    """Widen ``box`` to hold ``other``, of the same anchor."""
    turned = wrapped(other[YAW] - box[YAW])
    along = abs(box[UX] * other[UX] + box[UY] * other[UY])
    across = abs(box[UX] * other[UY] - box[UY] * other[UX])
    x, y = other[PX] - box[PX], other[PY] - box[PY]
    u, v = x * box[UX] + y * box[UY], y * box[UX] - x * box[UY]
    hu, hv = along * other[HU] + across * other[HV], across * other[HU] + along * other[HV]
    u0, u1 = min(-box[HU], u - hu), max(box[HU], u + hu)
    v0, v1 = min(-box[HV], v - hv), max(box[HV], v + hv)
    low, high = min(-box[TURN], turned - other[TURN]), max(box[TURN], turned + other[TURN])
    box[YAW], box[TURN] = box[YAW] + (low + high) / 2, (high - low) / 2
    u, v = (u0 + u1) / 2, (v0 + v1) / 2
    box[PX] += u * box[UX] - v * box[UY]
    box[PY] += u * box[UY] + v * box[UX]
    box[HU], box[HV] = (u1 - u0) / 2, (v1 - v0) / 2
