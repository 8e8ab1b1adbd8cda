"""Looks at the maps of where each online room may lie (``maps``).

A box of placements takes a room's centre to a small stretch of the plan. One look at the room's
map tells whether any prior room can explain it there; most hypotheses end with a few such looks.
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math

from situgraph.matching.boxes import AX, AY, PX, PY, TURN, YAW, radius
from situgraph.matching.compiled import part
from situgraph.matching.maps import (
    BITS,
    REACH,
    begin_of,
    draw,
    is_marked,
    nearest_cell,
    quarter_at,
    slot_of,
    tells,
)
from situgraph.matching.records import scratch
from situgraph.matching.tables import MAPPED, WORK

STEP = 0.7  # metres that the farthest room moves, about, in half of a part of the yaws
DEPTH = 8  # of the halving of the yaws, at most
PARTS = 2 * DEPTH
MOST_MARKED = 0.5  # of all cells, in a map that tells much


@part
def lay(case):
    """Tell which rooms have a map for the present shift of the storeys: drawn when asked for.

    Where so few maps tell much that all of those rooms may be unexplained, no box could be dropped
    by them, as among many equal rooms: then maps that tell less are worth their making, too.
    """
    lost = _choose(case, MOST_MARKED)
    if lost <= case.task.budget:
        _choose(case, 1.0)


@part
def _choose(case, most):
    """Choose the rooms whose maps have up to a share of all cells marked; returns their loss."""
    seen, task, lost = case.seen, case.task, 0.0
    for r in range(len(seen.storey)):
        known = tells(case, r, most)
        case.ground.known[r] = 1 if known else 0
        lost += task.loss[r] if known else 0.0
    return lost


@part
def partners_lie(case, box, g):
    """Whether the other rooms of group ``g`` may lie where they can be explained, all of them."""
    groups, halves = case.groups, _halves(case.ground, box)
    farthest = (REACH - radius(box)) / halves[8]
    for side in range(2):
        c, s, quarter = halves[2 + side], halves[4 + side], int(halves[6 + side])
        k = groups.first[g] + 1
        while k < groups.first[g + 1] and not _lost(
            case, box, groups.member[k], quarter, c, s, farthest
        ):
            k += 1
        if k == groups.first[g + 1]:
            return True
    return False


@part
def _halves(ground, box):
    """The two halves of the yaws of a box: cosines, sines and quarters of their middles.

    From number 2 on, and how far a place at a metre moves within one. Few boxes have yaws of their
    own, so the last of each quarter is kept.
    """
    halves = ground.halves[quarter_at(ground, box[YAW]) & 3]
    if halves[0] != box[YAW] or halves[1] != box[TURN]:
        halves[0], halves[1], half = box[YAW], box[TURN], box[TURN] / 2
        for side in range(2):
            yaw = box[YAW] + (half if side else -half)
            halves[2 + side], halves[4 + side] = math.cos(yaw), math.sin(yaw)
            halves[6 + side] = quarter_at(ground, yaw) & 3
        halves[8] = 2 * math.sin(half / 2) + 1e-12
    return halves


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
def enough_in_middle(case, box, g):
    """The same for the yaw in the middle alone."""
    return _enough_at(case, box, g, box[YAW], 0.0)


@part
def _enough_at(case, box, g, yaw, half):
    """The same for yaws up to ``half`` from ``yaw``."""
    groups, plan, ground, left = case.groups, case.plan, case.ground, case.task.budget
    scale, words, rows = plan.corner[2], plan.cells[0], plan.cells[1]
    c, s = scale * math.cos(yaw), scale * math.sin(yaw)
    x, y = scale * (box[PX] - plan.corner[0]), scale * (box[PY] - plan.corner[1])
    odd = quarter_at(ground, yaw) & 1
    farthest = (REACH - radius(box)) / (2 * math.sin(half / 2) + 1e-12)
    case.found.count[WORK] += 2 * groups.told[MAPPED]
    for k in range(groups.told[MAPPED]):
        if groups.apart[k] > farthest:
            break
        r, gx, gy = groups.order[k], groups.arm[k, 0], groups.arm[k, 1]
        slot = slot_of(case, r)
        if not ground.drawn[slot]:
            draw(case, r)
        column = nearest_cell(x + c * gx - s * gy, words * BITS)
        row = nearest_cell(y + s * gx + c * gy, rows)
        word = ground.marks[((slot * 2 + odd) * words + (column >> 6)) * rows + row]
        if not (word >> (column & (BITS - 1))) & 1:
            left -= case.task.loss[r]
            if left < 0:
                return False
    return True


@part
def _lost(case, box, r, quarter, c, s, farthest):
    """Whether room ``r``, up to ``farthest`` from the box's anchor, can be explained nowhere."""
    seen = case.seen
    gx, gy = seen.center[r, 0] - box[AX], seen.center[r, 1] - box[AY]
    if farthest < 0 or gx * gx + gy * gy > farthest * farthest or not case.ground.known[r]:
        return False
    return _lies_nowhere(case, box, r, quarter, c, s)


@part
def _lies_nowhere(case, box, r, quarter, c, s):
    """The same for a room that has a map and is not too far."""
    seen = case.seen
    gx, gy = seen.center[r, 0] - box[AX], seen.center[r, 1] - box[AY]
    if not case.ground.drawn[slot_of(case, r)]:
        draw(case, r)
    x, y = box[PX] + c * gx - s * gy, box[PY] + s * gx + c * gy
    return not is_marked(case.plan, case.ground.marks, begin_of(case, r, quarter), x, y)
