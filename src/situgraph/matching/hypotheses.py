"""Boxes of placements that bring planes of an online room onto planes of a prior room."""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math

import numpy as np

from situgraph.matching.boxes import AX, AY, HU, HV, PX, PY, SIDES, TURN, UX, UY, YAW, slack_of
from situgraph.matching.compiled import kernel
from situgraph.matching.explained import SLACK, explain, may_explain, no_slack, wrapped
from situgraph.matching.pointers import read

SHAPE_BOXES = 4000  # searched at most for one placement of one room in isolation


@kernel
def pair_box(case, i, k, j, m, wx, wy, box):
    """The box in which plane ``i`` fits ``j`` and ``k`` fits ``m``; False when there is none.

    Plane ``k`` may belong to another room, whose centre lies at ``(wx, wy)`` from the anchor.
    """
    seen, plan, limits = read(case.seen), read(case.plan), read(case.limits)
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
    c, s = math.cos(box[YAW]), math.sin(box[YAW])
    gx, gy = c * wx - s * wy, s * wx + c * wy
    fit = limits.fit + SLACK
    other = fit + abs(mx * gx + my * gy) * (1 - math.cos(turn))
    other += abs(my * gx - mx * gy) * math.sin(turn)
    near = seen.distance[i] - plan.row[j, 2]
    far = seen.distance[k] - plan.row[m, 2] - mx * gx - my * gy
    box[PX], box[PY] = (near * my - far * ny) / cross, (far * nx - near * mx) / cross
    box[UX], box[UY] = nx, ny
    box[HU] = fit
    box[HV] = (other + abs(nx * mx + ny * my) * fit) / abs(cross)
    return True


@kernel
def room_boxes(case, r, a, out):
    """All boxes in which two crossing planes of ``r`` fit ``a`` and it may be explained.

    Into ``out`` (k, SIDES), anchored at the room's centre; returns how many there are. When
    ``out`` is too small, the number is right all the same.
    """
    seen, plan = read(case.seen), read(case.plan)
    count = 0
    box = np.empty(SIDES)
    box[AX], box[AY] = seen.center[r, 0], seen.center[r, 1]
    for c in range(seen.crossed_first[r], seen.crossed_first[r + 1]):
        i, k = seen.crossed[c, 0], seen.crossed[c, 1]
        for j in range(plan.first[a], plan.first[a + 1]):
            for m in range(plan.first[a], plan.first[a + 1]):
                if m == j or not pair_box(case, i, k, j, m, 0.0, 0.0, box):
                    continue
                slack = slack_of(box, 0.0, 0.0)
                if not may_explain(case, r, a, box[YAW], box[PX], box[PY], slack):
                    continue
                if count < len(out):
                    for side in range(SIDES):
                        out[count, side] = box[side]
                count += 1
    return count


@kernel
def fits_somewhere(case, r, a, boxes):
    """Whether ``a`` explains ``r`` in isolation, at any placement; ``boxes`` is room to work in."""
    known = _rectangles(case, r, a)
    if known >= 0:
        return known == 1
    count = room_boxes(case, r, a, boxes)
    for b in range(min(count, len(boxes))):  # noqa: SIM110
        if _explained_in(case, r, a, boxes[b]):
            return True
    return False


@kernel
def _rectangles(case, r, a):
    """Whether ``a`` explains ``r`` when both are rectangles: 1 yes, 0 no, -1 they are not.

    One plane of each direction can always be made to fit, and one of the other two may be missing.
    So a width that agrees, within what a plane that fits and one that is moved allow, is enough.
    """
    seen, plan, limits = read(case.seen), read(case.plan), read(case.limits)
    i, j = seen.first[r], plan.first[a]
    if seen.first[r + 1] - i != 4 or plan.first[a + 1] - j != 4 or len(_needs(case)) > 0:
        return -1
    one, three = _opposite(seen.angle[i : i + 4], limits.angle / 2)
    if one < 0:
        return -1
    two, four = _opposite(plan.row[j : j + 4, 3], 1e-9)
    if two < 0:
        return -1
    width = seen.distance[i] + seen.distance[i + one]
    depth = seen.distance[i + three // 4] + seen.distance[i + three % 4]
    along = plan.row[j, 2] + plan.row[j + two, 2]
    across = plan.row[j + four // 4, 2] + plan.row[j + four % 4, 2]
    most = limits.fit + limits.moved + 2 * SLACK
    for theirs in (along, across):
        if abs(width - theirs) <= most or abs(depth - theirs) <= most:
            return 1
    return 0


@kernel
def _needs(case):
    return read(case.content).row_need


@kernel
def _opposite(angle, spread):
    """Of four directions, the one opposite the first, and the other two as ``4 * k + m``.

    (-1, -1) when they are not those of a rectangle, within ``spread``.
    """
    for one in range(1, 4):
        k = 1 if one > 1 else 2
        m = 6 - one - k
        if (
            abs(wrapped(angle[one] - angle[0] - math.pi)) <= spread
            and abs(wrapped(angle[m] - angle[k] - math.pi)) <= spread
            and abs(abs(wrapped(angle[k] - angle[0])) - math.pi / 2) <= spread
        ):
            return one, 4 * k + m
    return -1, -1


@kernel
def _explained_in(case, r, a, start):
    limits = read(case.limits)
    stack = np.empty((64, SIDES))
    stack[0] = start
    depth = 1
    for _ in range(SHAPE_BOXES):
        if depth == 0:
            return False
        depth -= 1
        box = stack[depth].copy()
        x, y = box[PX], box[PY]
        if explain(case, r, a, box[YAW], x, y, no_slack()) > -np.inf:
            return True
        slack = slack_of(box, 0.0, 0.0)
        if explain(case, r, a, box[YAW], x, y, slack) == -np.inf:
            continue
        widths = (5 * box[TURN], box[HU], box[HV])
        side = 0
        if widths[1] > widths[side]:
            side = 1
        if widths[2] > widths[side]:
            side = 2
        if widths[side] < limits.smallest_step or depth > 61:
            continue
        split(box, side, stack[depth], stack[depth + 1])
        depth += 2
    return False


@kernel
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
