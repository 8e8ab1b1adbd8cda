"""The map of a room: the cells of the plan in which its centre may lie, for two quarter turns.

Half a turn takes most rooms nearly onto themselves, so one map holds for both turns. The maps hold
too much, never too little.
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math
from typing import NamedTuple

from situgraph.matching.boxes import HU, HV, PX, PY, SIDES, TURN, UX, UY, YAW
from situgraph.matching.compiled import part
from situgraph.matching.containment import may_be
from situgraph.matching.hypotheses import next_pair_box
from situgraph.matching.plain import (
    BASE,
    COS,
    CX,
    CY,
    EXACT,
    HIGH,
    LOW,
    QUARTER,
    SIDE,
    SIN,
    is_plain,
    plain_pair,
    plain_places,
    whole,
)
from situgraph.matching.records import scratch
from situgraph.matching.slack import SLACK
from situgraph.matching.tables import WORK

REACH = 1.0  # metres by which the centre may lie elsewhere in a box; a cell is as wide or wider
MARKED = 25.0  # cells that a prior room marks in a map, about
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
def draw(case, r):
    """Draw the map of a room."""
    plan, ground = case.plan, case.ground
    storey, slot = case.task.storeys[case.seen.storey[r]], slot_of(case, r)
    words = 2 * plan.cells[0] * plan.cells[1]
    ground.drawn[slot] = 1
    for k in range(slot * words, (slot + 1) * words):
        ground.marks[k] = 0
    if storey < 0:
        return
    origin, wide, tall = plan.corner, plan.cells[0], plan.cells[1]
    canvas = Canvas(origin[0], origin[1], origin[2], wide * BITS, tall, slot * words)
    along, kept = case.found.along, scratch(8)
    for k in range(8):  # the search is among the boxes of another pair of rooms
        kept[k] = along[k >> 2, k & 3]
    by_width = is_plain(case, r)
    if by_width:
        _draw_whole(case, r, storey, canvas)
    for a in range(len(plan.storey)):
        if by_width and whole(case, a):
            continue
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
    planes = seen.first[r + 1] - seen.first[r]
    if seen.flat[r] or planes < 3:
        return False
    marked = MARKED if planes > 3 else 2 * MARKED  # half turns find other places without a wall
    cells = plan.cells[0] * plan.cells[1] * BITS
    return case.found.alike[r] * marked < cells * most


@part
def _draw_whole(case, r, storey, canvas):
    """Mark what ``_enter_plain`` would of all rooms of four planes, or recall it.

    It is the same for the mirror image: planes that face each other change places at most, as they
    do with half a turn, for which the map holds as well.
    """
    ground, words = case.ground, 2 * case.plan.cells[0] * case.plan.cells[1]
    former, shared, at = ground.former, ground.shared, len(case.seen.storey) + r * words
    if len(former) > 0 and former[r] == 1:
        for k in range(words):
            ground.marks[canvas.begin + k] = former[at + k]
        return
    for odd in range(2):
        _enter_whole(case, r, storey, odd, canvas)
    if len(shared) > 0 and _is_upright(case, r):
        shared[r] = 1
        for k in range(words):
            shared[at + k] = ground.marks[canvas.begin + k]


@part
def _is_upright(case, r):
    """Whether each plane of plain room ``r`` can be parallel to the plan's at one quarter only.

    Else the mirror image could be marked at the other one.
    """
    side, turns = case.seen.plain[r], case.plan.turns
    off = side[BASE] - case.seen.angle[0]
    off -= round(off / QUARTER) * QUARTER
    most = max(abs(turns[0]), abs(turns[1])) + abs(off - (side[LOW] + side[HIGH]) / 2)
    return most + (side[HIGH] - side[LOW]) / 2 + case.limits.angle + 4 * SLACK < QUARTER / 2


@part
def _enter_whole(case, r, storey, odd, canvas):
    """The marks of ``_draw_whole`` for the half of the quarters.

    Most marks are made here, so there is little to be decided.
    """
    plan, limits, side = case.plan, case.limits, case.seen.plain[r]
    one, two = side[SIDE] + side[SIDE + 2], side[SIDE + 1] + side[SIDE + 3]
    off, lost = limits.fit + limits.moved + 2 * SLACK, 0 if case.seen.strict[r] else 1
    fitting, count = case.finder.room, 0
    for a in range(len(plan.storey)):
        w, v = plan.width[odd, a], plan.width[1 - odd, a]
        fits = int(abs(w - one) > off) + int(abs(v - two) > off) <= lost
        fitting[count] = a
        count += int(fits & (w == w) & (plan.storey[a] == storey) & may_be(case, r, a))
    span = scratch(6)
    for k in range(count):
        row = plan.plain[fitting[k]]
        yaw = row[BASE] - side[BASE] + (side[LOW] + side[HIGH]) / 2 + odd * QUARTER
        loose = (side[HIGH] - side[LOW]) / 2 + limits.angle + 2 * SLACK
        first, last = quarter_at(case.ground, yaw - loose), quarter_at(case.ground, yaw + loose)
        ux, uy = (-row[SIN], row[COS]) if odd else (row[COS], row[SIN])
        along = _span(limits.fit, side, row, 0, odd, off, span)
        across = _span(limits.fit, side, row, 1, odd + 1, off, span)
        wide, tall = abs(ux) * span[2] + abs(uy) * span[5], abs(uy) * span[2] + abs(ux) * span[5]
        for i in range(along):
            for m in range(across):
                u, v = span[i], span[3 + m]
                x, y = row[CX] + u * ux - v * uy, row[CY] + u * uy + v * ux
                _mark(case.ground.marks, canvas, x, y, wide, tall, first, last)


@part
def _span(fit, side, row, k, m, most, span):
    """Where a room lies when a wall of it, ``k`` or the opposite one, meets ``m`` or its opposite.

    Two places and the half width, which are those of both half turns; of walls that meet both at
    once (``most`` is by how much widths may differ) they are one. Returns how many there are.
    """
    one, two = side[SIDE + k], side[SIDE + k + 2]
    one = two if one != one else one
    two = one if two != two else two
    middle, off = (one + two) / 2, abs(one - two) / 2
    one, two = middle - row[SIDE + m], row[SIDE + (m ^ 2)] - middle
    half = fit + SLACK + EXACT * (abs(one) + abs(two) + off) + off
    apart = abs(one - two) / 2
    joined = 2.0 * apart <= most
    span[3 * k] = (one + two) / 2 if joined else one
    span[3 * k + 1] = two
    span[3 * k + 2] = half + apart if joined else half
    return 1 if joined else 2


@part
def _enter_plain(case, r, a, canvas):
    """Mark what ``next_plain_box`` would give, without making boxes: most maps are drawn here."""
    plan, along, word = case.plan.plain, case.found.along, case.ground.marks
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
            _mark(ground.marks, canvas, box[PX], box[PY], wide, tall, first, last)
            at = next_pair_box(case, r, i, k, a, at, reach, box)


@part
def _mark(word, canvas, x, y, wide, tall, first, last):
    """Mark the cells up to so far from ``(x, y)``, at the quarter turns ``first`` and ``last``.

    ``_spread`` adds a cell on all sides.
    """
    x0 = nearest_cell((x - wide - canvas.x) * canvas.scale, canvas.columns)
    x1 = nearest_cell((x + wide - canvas.x) * canvas.scale, canvas.columns)
    y0 = nearest_cell((y - tall - canvas.y) * canvas.scale, canvas.rows)
    y1 = nearest_cell((y + tall - canvas.y) * canvas.scale, canvas.rows)
    for quarter in (first, last):
        mark_cells(word, canvas, x0, x1, y0, y1, quarter & 1)
        if first == last:
            break


@part
def mark_cells(word, canvas, x0, x1, y0, y1, part):
    """Mark the cells of the columns ``x0`` to ``x1`` and rows ``y0`` to ``y1`` of one map."""
    for w in range(x0 >> 6, (x1 >> 6) + 1):
        begin, end = max(x0 - 64 * w, 0), min(x1 - 64 * w, 63)
        run = ((2 << (end - begin)) - 1) << begin
        top = canvas.begin + (part * (canvas.columns >> 6) + w) * canvas.rows
        word[top + y0] |= run
        word[top + y1] |= run
        for k in range(top + y0 + 1, top + y1):
            word[k] |= run


@part
def _spread(case, slot):
    """Add to the cells marked in a map those beside them."""
    word, words, rows = case.ground.marks, case.plan.cells[0], case.plan.cells[1]
    for odd in range(2):
        begin = (slot * 2 + odd) * words * rows
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
def nearest_cell(value, count):
    """The cell of ``count`` that is nearest to a place, in cells."""
    return min(max(math.floor(value), 0), count - 1)


@part
def quarter_at(ground, yaw):
    """The quarter turn nearest to a yaw, not reduced to four."""
    return round((yaw - ground.base) / QUARTER)


@part
def slot_of(case, r):
    """Which of the maps is that of a room, for the present shift of the storeys."""
    return r * case.ground.layers + case.ground.part[0]


@part
def begin_of(case, r, quarter):
    """The first word of a room's map of a quarter."""
    return (slot_of(case, r) * 2 + (quarter & 1)) * case.plan.cells[0] * case.plan.cells[1]


@part
def is_marked(plan, word, begin, x, y):
    """Whether the cell of a place is marked in the map of a quarter, which begins at a word."""
    column = nearest_cell((x - plan.corner[0]) * plan.corner[2], plan.cells[0] * BITS)
    row = nearest_cell((y - plan.corner[1]) * plan.corner[2], plan.cells[1])
    k = begin + (column >> 6) * plan.cells[1] + row
    return (word[k] >> (column & (BITS - 1))) & 1 == 1
