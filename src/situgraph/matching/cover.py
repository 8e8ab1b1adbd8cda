"""Boxes that hold all feasible placements, for a search that comes later: the cover.

They are what a search could not prove infeasible: boxes that a peak represents, or that are too
small to be halved.
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math

from situgraph.matching.boxes import AX, AY, HU, HV, PX, PY, SIDES, TURN, YAW, radius
from situgraph.matching.compiled import part
from situgraph.matching.hypotheses import copy_box, enclose
from situgraph.matching.plain import CX, CY, HIGH, LOW, farthest
from situgraph.matching.records import scratch
from situgraph.matching.slack import wrapped
from situgraph.matching.tables import HELD, LEFT, WORK

JOINED = 0.3  # half widths of kept boxes put together, at most, metres
STRAY, STRAY_TURN = 0.5, 0.1  # how far from a box its placements are looked for, metres, radians


@part
def nothing_left(left):
    """Begin with a box that holds nothing."""
    left[HU] = -1.0


@part
def spread(left, box):
    """Widen ``left`` to hold one more box of the same anchor."""
    if left[HU] < 0:
        copy_box(box, left)
    else:
        enclose(left, box)


@part
def longest_arm(case):
    """How far the rooms are from the mean of their centres, a metre at least."""
    center, arm = case.seen.center, 1.0
    for r in range(len(center)):
        arm = max(arm, math.hypot(center[r, 0], center[r, 1]))
    return arm


@part
def keep_left(case, left, arm):
    """Keep what is left of a box, for the cover; ``arm`` is that of the room farthest away."""
    if left[HU] >= 0 and len(case.found.cover) > 0:
        _keep(case.found.cover, case.found.count, LEFT, left, arm)


@part
def keep_region(case, box, arm):
    """The same for the region."""
    _keep(case.found.region, case.found.count, HELD, box, arm)


@part
def _keep(boxes, count, which, box, arm):
    """In a kept box beside it, or by itself; where there is no room for it, it is only counted."""
    both = scratch(SIDES)
    count[WORK] += min(count[which], len(boxes)) // 2
    if count[which] >= len(boxes):
        count[which] += 1
        return
    for k in range(count[which]):
        if max(abs(boxes[k, PX] - box[PX]), abs(boxes[k, PY] - box[PY])) > 2 * JOINED:
            continue
        copy_box(boxes[k], both)
        enclose(both, box)
        if max(both[TURN] * arm, both[HU], both[HV]) <= JOINED:
            copy_box(both, boxes[k])
            return
    copy_box(box, boxes[count[which]])
    count[which] += 1


@part
def outside(case, box):
    """Whether no placement in or near a box is in the region; it is anchored at the mean centre."""
    region, sway = case.found.region, radius(box) + STRAY
    case.found.count[WORK] += case.found.count[HELD]
    for k in range(case.found.count[HELD]):
        held = region[k]
        if (
            math.hypot(held[PX] - box[PX], held[PY] - box[PY]) <= radius(held) + sway
            and abs(wrapped(held[YAW] - box[YAW])) <= held[TURN] + box[TURN] + STRAY_TURN
        ):
            return False
    return True


@part
def sight(case, r):
    """Into ``near``, for each box of the region: where it takes room ``r``, and how nearly."""
    region, near, center = case.found.region, case.found.near, case.seen.center
    arm = math.hypot(center[r, 0], center[r, 1])
    for k in range(case.found.count[HELD]):
        held = region[k]
        c, s = math.cos(held[YAW]), math.sin(held[YAW])
        near[k, 0] = held[PX] + c * center[r, 0] - s * center[r, 1]
        near[k, 1] = held[PY] + s * center[r, 0] + c * center[r, 1]
        near[k, 2] = radius(held) + STRAY + (held[TURN] + STRAY_TURN) * arm


@part
def far_off(case, box):
    """Whether a box that is anchored at the room in sight will be ``outside``.

    Whatever is cut from it. Moving its anchor adds placements: those that take the room up to about
    three times its arm, times the half width of the yaw, from the box.
    """
    region, near = case.found.region, case.found.near
    case.found.count[WORK] += case.found.count[HELD] // 2
    sway = 2 * radius(box) + 3 * math.hypot(box[AX], box[AY]) * box[TURN]
    for k in range(case.found.count[HELD]):
        x, y, reach = near[k, 0] - box[PX], near[k, 1] - box[PY], near[k, 2] + sway
        turn = region[k, TURN] + STRAY_TURN + box[TURN]
        if x * x + y * y <= reach * reach and abs(wrapped(region[k, YAW] - box[YAW])) <= turn:
            return False
    return True


@part
def far_room(case, r, a):
    """Whether that is so for all boxes in which plain room ``a`` may explain ``r``."""
    seen, plan, near = case.seen.plain, case.plan.plain, case.found.near
    arm = math.hypot(case.seen.center[r, 0], case.seen.center[r, 1])
    sway = 1.5 * (farthest(case, r, a) + 4 * JOINED) + 1.5 * arm * (seen[r, HIGH] - seen[r, LOW])
    for k in range(case.found.count[HELD]):
        x, y = near[k, 0] - plan[a, CX], near[k, 1] - plan[a, CY]
        reach = near[k, 2] + sway
        if x * x + y * y <= reach * reach:
            return False
    return True


@part
def strayed(box, at):
    """Whether a placement is not near a box that is anchored at the mean centre."""
    away = math.hypot(at[1] - box[PX], at[2] - box[PY])
    return away > radius(box) + STRAY or abs(wrapped(at[0] - box[YAW])) > box[TURN] + STRAY_TURN
