"""Where in the plan each online room may lie: a map of cells for each room and quarter turn.

A box of placements takes a room's centre to a small stretch of the plan. One look at the room's
map tells whether any prior room can explain it there; most hypotheses end with a few such looks.
The maps hold too much, never too little.
"""

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
    radius,
)
from situgraph.matching.compiled import part
from situgraph.matching.containment import may_be
from situgraph.matching.hypotheses import next_pair_box, next_plain_box
from situgraph.matching.plain import QUARTER, plain_pair
from situgraph.matching.records import scratch
from situgraph.matching.slack import SLACK
from situgraph.matching.tables import MAPPED, WORK

REACH = 1.0  # metres by which the centre may lie elsewhere in a box
STEP = 0.7  # metres that the farthest room moves, about, in half of a part of the yaws
DEPTH = 8  # of the halving of the yaws, at most
PARTS = 2 * DEPTH
MARKED = 25.0  # cells that a prior room marks in a map, about
MOST_MARKED = 0.5  # of all cells, in a map that is worth its making
BITS = 64  # cells of a word


@part
def lay(case):
    """Tell which rooms have a map for the present shift of the storeys: drawn when asked for."""
    seen = case.seen
    for r in range(len(seen.storey)):
        tells = case.task.storeys[seen.storey[r]] < 0 or _tells(case, r)
        case.ground.known[r] = 1 if tells else 0


@part
def _draw(case, r):
    """Draw the map of a room."""
    plan, ground = case.plan, case.ground
    storey, slot = case.task.storeys[case.seen.storey[r]], ground.part[0] + r
    words = 4 * plan.cells[0] * plan.cells[1]
    ground.drawn[slot] = 1
    for k in range(slot * words, (slot + 1) * words):
        ground.word[k] = 0
    if storey < 0:
        return
    along, kept = case.found.along, scratch(8)
    for k in range(8):  # the search is among the boxes of another pair of rooms
        kept[k] = along[k >> 2, k & 3]
    for a in range(len(plan.storey)):
        if plan.storey[a] == storey and may_be(case, r, a):
            if plain_pair(case, r, a):
                _enter_plain(case, r, a)
            else:
                _enter(case, r, a)
    for k in range(8):
        along[k >> 2, k & 3] = kept[k]


@part
def _tells(case, r):
    """Whether a map of a room is worth its making: one that may lie anywhere tells nothing."""
    seen, plan = case.seen, case.plan
    if seen.flat[r] or seen.first[r + 1] - seen.first[r] < 3:
        return False
    cells = plan.cells[0] * plan.cells[1] * BITS
    return case.found.alike[r] * MARKED < cells * MOST_MARKED


@part
def _enter_plain(case, r, a):
    box = scratch(SIDES)
    at = next_plain_box(case, r, a, 0, box)
    while at >= 0:
        _mark(case, r, box)
        at = next_plain_box(case, r, a, at, box)


@part
def _enter(case, r, a):
    """By the room's probes: the planes of one have counterparts, moved or not."""
    seen, plan, limits = case.seen, case.plan, case.limits
    box = scratch(SIDES)
    reach = limits.fit if seen.strict[r] else limits.moved
    for c in range(seen.probe_first[r], seen.probe_first[r + 1]):
        i, k = seen.probe[c, 0], seen.probe[c, 1]
        case.found.count[WORK] += (plan.first[a + 1] - plan.first[a]) ** 2 // 4
        at = next_pair_box(case, r, i, k, a, 0, reach, box)
        while at >= 0:
            _mark(case, r, box)
            at = next_pair_box(case, r, i, k, a, at, reach, box)


@part
def _mark(case, r, box):
    """Mark the cells in which the room's centre may lie, in all quarters the yaws belong to."""
    ground, plan = case.ground, case.plan
    wide = abs(box[UX]) * box[HU] + abs(box[UY]) * box[HV] + REACH
    tall = abs(box[UY]) * box[HU] + abs(box[UX]) * box[HV] + REACH
    x0, x1 = _column(plan, box[PX] - wide), _column(plan, box[PX] + wide)
    y0, y1 = _row(plan, box[PY] - tall), _row(plan, box[PY] + tall)
    loose = box[TURN] + case.limits.angle + 2 * SLACK
    first = _quarter(ground, box[YAW] - loose)
    last = _quarter(ground, box[YAW] + loose)
    words = plan.cells[0]
    for q in (first, last):
        at = ((ground.part[0] + r) * 4 + q) * words * plan.cells[1]
        for y in range(y0, y1 + 1):
            for w in range(x0 // BITS, x1 // BITS + 1):
                low, high = max(x0 - w * BITS, 0), min(x1 - w * BITS, BITS - 1)
                run = -1 if high - low == BITS - 1 else ((1 << (high - low + 1)) - 1) << low
                ground.word[at + y * words + w] |= run
        if first == last:
            break


@part
def _column(plan, x):
    column = math.floor((x - plan.corner[0]) * plan.corner[2])
    return min(max(column, 0), plan.cells[0] * BITS - 1)


@part
def _row(plan, y):
    row = math.floor((y - plan.corner[1]) * plan.corner[2])
    return min(max(row, 0), plan.cells[1] - 1)


@part
def _quarter(ground, yaw):
    return round((yaw - ground.base) / QUARTER) & 3


@part
def _lies(case, r, quarter, x, y):
    """Whether the centre of ``r`` may lie within ``REACH`` of a place in the plan."""
    plan, column = case.plan, _column(case.plan, x)
    at = ((case.ground.part[0] + r) * 4 + quarter) * plan.cells[1] + _row(plan, y)
    at = at * plan.cells[0] + column // BITS
    return (case.ground.word[at] >> (column & (BITS - 1))) & 1 == 1


@part
def partners_lie(case, box, g):
    """Whether the other rooms of group ``g`` may lie where they can be explained, all of them."""
    groups, half = case.groups, box[TURN] / 2
    farthest = (REACH - radius(box)) / (2 * math.sin(half / 2) + 1e-12)
    for side in range(2):
        yaw = box[YAW] + (half if side else -half)
        c, s = math.cos(yaw), math.sin(yaw)
        quarter, k = _quarter(case.ground, yaw), groups.first[g] + 1
        while k < groups.first[g + 1] and not _lost(
            case, box, groups.member[k], quarter, c, s, farthest
        ):
            k += 1
        if k == groups.first[g + 1]:
            return True
    return False


@part
def enough(case, box, g):
    """Cut from the yaws of a box those at which too few rooms lie where they can be explained.

    The box must be anchored at the anchor of group ``g``, whose rooms all have to be explained.
    False when nothing is left.
    """
    groups = case.groups
    far = groups.apart[groups.told[MAPPED] - 1] if groups.told[MAPPED] else 0.0
    parts = scratch(PARTS)
    half = box[TURN] / 2
    parts[0], parts[1], parts[2], parts[3] = -half, half, half, half
    low, high, depth = math.inf, -math.inf, 2
    while depth > 0:
        depth -= 1
        middle, half = parts[2 * depth], parts[2 * depth + 1]
        if middle - half >= low and middle + half <= high:
            continue
        if not _enough_at(case, box, g, box[YAW] + middle, half):
            continue
        if half * far <= STEP or depth + 2 > DEPTH:
            low, high = min(low, middle - half), max(high, middle + half)
            continue
        half /= 2
        parts[2 * depth], parts[2 * depth + 1] = middle - half, half
        parts[2 * depth + 2], parts[2 * depth + 3] = middle + half, half
        depth += 2
    if low > high:
        return False
    box[YAW] += (low + high) / 2
    box[TURN] = min((high - low) / 2, box[TURN])
    return True


@part
def _enough_at(case, box, g, yaw, half):
    """The same for yaws up to ``half`` from ``yaw``."""
    groups, task = case.groups, case.task
    left = task.budget
    c, s = math.cos(yaw), math.sin(yaw)
    quarter = _quarter(case.ground, yaw)
    farthest = (REACH - radius(box)) / (2 * math.sin(half / 2) + 1e-12)
    for k in range(groups.told[MAPPED]):
        if groups.apart[k] > farthest:
            break
        if _lost(case, box, groups.order[k], quarter, c, s, farthest):
            left -= task.loss[groups.order[k]]
            if left < 0:
                return False
    return True


@part
def _lost(case, box, r, quarter, c, s, farthest):
    """Whether room ``r``, up to ``farthest`` from the box's anchor, can be explained nowhere."""
    seen = case.seen
    gx, gy = seen.center[r, 0] - box[AX], seen.center[r, 1] - box[AY]
    if not case.ground.known[r] or math.sqrt(gx * gx + gy * gy) > farthest:
        return False
    if not case.ground.drawn[case.ground.part[0] + r]:
        _draw(case, r)
    x, y = box[PX] + c * gx - s * gy, box[PY] + s * gx + c * gy
    return not _lies(case, r, quarter, x, y)
