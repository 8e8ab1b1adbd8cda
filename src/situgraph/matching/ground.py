"""Where in the plan each online room may lie: a map of cells for each room and quarter turn.

A box of placements takes a room's centre to a small stretch of the plan. One look at the room's
map tells whether any prior room can explain it there; most hypotheses end with a few such looks.
The maps hold too much, never too little.
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math
from typing import NamedTuple

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
from situgraph.matching.hypotheses import next_pair_box
from situgraph.matching.plain import (
    BASE,
    COS,
    CX,
    CY,
    HIGH,
    LOW,
    QUARTER,
    SIN,
    plain_pair,
    plain_places,
)
from situgraph.matching.records import scratch
from situgraph.matching.slack import SLACK
from situgraph.matching.tables import MAPPED, WORK

REACH = 1.0  # metres by which the centre may lie elsewhere in a box; a cell is as wide or wider
STEP = 0.7  # metres that the farthest room moves, about, in half of a part of the yaws
DEPTH = 8  # of the halving of the yaws, at most
PARTS = 2 * DEPTH
MARKED = 25.0  # cells that a prior room marks in a map, about
MOST_MARKED = 0.5  # of all cells, in a map that tells much
BITS = 64  # cells of a word


class Canvas(NamedTuple):
    """The maps of a room, while they are drawn."""

    x: float  # where they begin, metres
    y: float
    scale: float  # cells a metre
    columns: int
    rows: int
    begin: int  # their first word


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
def draw(case, r):
    """Draw the map of a room."""
    plan, ground = case.plan, case.ground
    storey, slot = case.task.storeys[case.seen.storey[r]], ground.part[0] + r
    words = 4 * plan.cells[0] * plan.cells[1]
    ground.drawn[slot] = 1
    for k in range(slot * words, (slot + 1) * words):
        ground.word[k] = 0
    if storey < 0:
        return
    origin, wide, tall = plan.corner, plan.cells[0], plan.cells[1]
    canvas = Canvas(origin[0], origin[1], origin[2], wide * BITS, tall, slot * words)
    along, kept = case.found.along, scratch(8)
    for k in range(8):  # the search is among the boxes of another pair of rooms
        kept[k] = along[k >> 2, k & 3]
    for a in range(len(plan.storey)):
        if plan.storey[a] == storey and may_be(case, r, a):
            if plain_pair(case, r, a):
                _enter_plain(case, r, a, canvas)
            else:
                _enter(case, r, a, canvas)
    for k in range(8):
        along[k >> 2, k & 3] = kept[k]
    _spread(case, slot)


@part
def tells(case, r, most):
    """Whether about ``most`` of a room's map are marked at most: all marked, it tells nothing."""
    seen, plan = case.seen, case.plan
    if case.task.storeys[seen.storey[r]] < 0:
        return True
    if seen.flat[r] or seen.first[r + 1] - seen.first[r] < 3:
        return False
    cells = plan.cells[0] * plan.cells[1] * BITS
    return case.found.alike[r] * MARKED < cells * most


@part
def _enter_plain(case, r, a, canvas):
    """Mark what ``next_plain_box`` would give, without making boxes: most maps are drawn here."""
    plan, along, word = case.plan.plain, case.found.along, case.ground.word
    low, high = case.seen.plain[r, LOW], case.seen.plain[r, HIGH]
    yaw = plan[a, BASE] - case.seen.plain[r, BASE] + (low + high) / 2
    loose = (high - low) / 2 + case.limits.angle + 2 * SLACK
    first, last = quarter_at(case.ground, yaw - loose), quarter_at(case.ground, yaw + loose)
    ux, uy = plan[a, COS], plan[a, SIN]
    for quarter in range(4):
        if plain_places(case, r, a, quarter):
            for m in range(4):
                i, k = m & 2, (m & 1) << 1
                u, hu, v, hv = along[0, i], along[0, i + 1], along[1, k], along[1, k + 1]
                if hu < 0 or hv < 0:
                    continue
                x, y = plan[a, CX] + u * ux - v * uy, plan[a, CY] + u * uy + v * ux
                wide, tall = abs(ux) * hu + abs(uy) * hv, abs(uy) * hu + abs(ux) * hv
                _mark(word, canvas, x, y, wide, tall, first + quarter, last + quarter)
        ux, uy = -uy, ux


@part
def _enter(case, r, a, canvas):
    """By the room's probes: the planes of one have counterparts, moved or not."""
    seen, plan, limits, ground = case.seen, case.plan, case.limits, case.ground
    box = scratch(SIDES)
    reach = limits.fit if seen.strict[r] else limits.moved
    for c in range(seen.probe_first[r], seen.probe_first[r + 1]):
        i, k = seen.probe[c, 0], seen.probe[c, 1]
        case.found.count[WORK] += (plan.first[a + 1] - plan.first[a]) ** 2 // 4
        at = next_pair_box(case, r, i, k, a, 0, reach, box)
        while at >= 0:
            wide = abs(box[UX]) * box[HU] + abs(box[UY]) * box[HV]
            tall = abs(box[UY]) * box[HU] + abs(box[UX]) * box[HV]
            loose = box[TURN] + limits.angle + 2 * SLACK
            first, last = quarter_at(ground, box[YAW] - loose), quarter_at(ground, box[YAW] + loose)
            _mark(ground.word, canvas, box[PX], box[PY], wide, tall, first, last)
            at = next_pair_box(case, r, i, k, a, at, reach, box)


@part
def _mark(word, canvas, x, y, wide, tall, first, last):
    """Mark the cells up to so far from ``(x, y)``, in the quarters ``first`` and ``last``.

    ``_spread`` adds a cell on all sides.
    """
    x0 = nearest_cell((x - wide - canvas.x) * canvas.scale, canvas.columns)
    x1 = nearest_cell((x + wide - canvas.x) * canvas.scale, canvas.columns)
    y0 = nearest_cell((y - tall - canvas.y) * canvas.scale, canvas.rows)
    y1 = nearest_cell((y + tall - canvas.y) * canvas.scale, canvas.rows)
    for quarter in (first, last):
        mark_cells(word, canvas, x0, x1, y0, y1, quarter & 3)
        if first == last:
            break


@part
def mark_cells(word, canvas, x0, x1, y0, y1, quarter):
    """Mark the cells of the columns ``x0`` to ``x1`` in the rows ``y0`` to ``y1``."""
    for w in range(x0 >> 6, (x1 >> 6) + 1):
        begin, end = max(x0 - 64 * w, 0), min(x1 - 64 * w, 63)
        run = ((2 << (end - begin)) - 1) << begin
        top = canvas.begin + (quarter * (canvas.columns >> 6) + w) * canvas.rows
        for k in range(top + y0, top + y1 + 1):
            word[k] |= run


@part
def _spread(case, slot):
    """Add to the cells marked in a map those beside them."""
    word, words, rows = case.ground.word, case.plan.cells[0], case.plan.cells[1]
    for quarter in range(4):
        begin = (slot * 4 + quarter) * words * rows
        end = begin + words * rows
        for y in range(begin, begin + rows):
            before, now = 0, word[y]
            for k in range(y, end, rows):
                after = word[k + rows] if k + rows < end else 0
                word[k] = now | (now << 1) | (now >> 1) | (before >> 63) & 1 | (after << 63)
                before, now = now, after
        for column in range(begin, end, rows):
            before = 0
            for k in range(column, column + rows):
                now = word[k]
                word[k] = now | before | (word[k + 1] if k + 1 < column + rows else 0)
                before = now


@part
def begin_of(case, r, quarter):
    """The first word of a room's map of a quarter."""
    return ((case.ground.part[0] + r) * 4 + quarter) * case.plan.cells[0] * case.plan.cells[1]


@part
def nearest_cell(value, count):
    """The cell of ``count`` that is nearest to a place, in cells."""
    return min(max(math.floor(value), 0), count - 1)


@part
def quarter_at(ground, yaw):
    """The quarter turn nearest to a yaw, not reduced to four."""
    return round((yaw - ground.base) / QUARTER)


@part
def is_marked(plan, word, begin, x, y):
    """Whether the cell of a place is marked in the map of a quarter, which begins at a word."""
    column = nearest_cell((x - plan.corner[0]) * plan.corner[2], plan.cells[0] * BITS)
    row = nearest_cell((y - plan.corner[1]) * plan.corner[2], plan.cells[1])
    k = begin + (column // BITS) * plan.cells[1] + row
    return (word[k] >> (column & (BITS - 1))) & 1 == 1


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
    groups, task = case.groups, case.task
    left = task.budget
    c, s = math.cos(yaw), math.sin(yaw)
    quarter = quarter_at(case.ground, yaw) & 3
    farthest = (REACH - radius(box)) / (2 * math.sin(half / 2) + 1e-12)
    for k in range(groups.told[MAPPED]):
        if groups.apart[k] > farthest:
            break
        if _lies_nowhere(case, box, groups.order[k], quarter, c, s):
            left -= task.loss[groups.order[k]]
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
    if not case.ground.drawn[case.ground.part[0] + r]:
        draw(case, r)
    x, y = box[PX] + c * gx - s * gy, box[PY] + s * gx + c * gy
    return not is_marked(case.plan, case.ground.word, begin_of(case, r, quarter), x, y)
