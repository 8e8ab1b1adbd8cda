"""Where the anchor of a group may lie, by what the sieve has left (``sieve``)."""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math

from situgraph.matching.boxes import HU, HV, PX, PY, TURN, UX, UY, YAW, radius
from situgraph.matching.compiled import part
from situgraph.matching.counting import to_right
from situgraph.matching.maps import BITS, REACH, begin_of, is_marked, quarter_at
from situgraph.matching.plain import CX, CY, JOINED, farthest
from situgraph.matching.sieve import shift_rooms
from situgraph.matching.tables import KEPT, PARTED, SIFTED

AROUND = 1  # cells by which the anchor may be off, for the yaw and rounding


@part
def sift_for(case, g):
    """Mark where the anchor of group ``g`` is when all of the group lie where they can."""
    sieve, groups = case.sieve, case.groups
    if not sieve.told[SIFTED]:
        return
    for k in range(len(sieve.word)):
        sieve.word[k] = 0
    for k in range(len(sieve.block)):
        sieve.block[k] = 0
    count = 0
    for m in range(groups.first[g], groups.first[g + 1]):
        r = groups.member[m]
        if m == groups.first[g] or sieve.counted[r]:
            sieve.room[count] = r
            count += 1
    part = -1
    for m in range(sieve.told[KEPT]):
        if part != sieve.left[m, 0]:
            part = sieve.left[m, 0]
            quarter = part // sieve.told[PARTED]
            shift_rooms(case, count, quarter, part % sieve.told[PARTED])
        x, y, bits = sieve.left[m, 1], sieve.left[m, 2], sieve.left[m, 3]
        for k in range(count):
            if bits != 0 and sieve.counted[sieve.room[k]]:
                begin = begin_of(case, sieve.room[k], quarter)
                bits &= _cells(case, begin, x + sieve.shift[0, k], y + sieve.shift[1, k])
        if bits != 0:
            _mark(case, quarter, x + sieve.shift[0, 0], y + sieve.shift[1, 0], bits)
    _mark_blocks(case)


@part
def _mark(case, quarter, x, y, bits):
    """Mark 64 cells from ``(x, y)`` on, and those beside them."""
    for along in range(x - AROUND, x + AROUND + 1):
        column, right = along >> 6, along & (BITS - 1)
        _mark_word(case, quarter, column, y, bits << right)
        _mark_word(case, quarter, column + 1, y, to_right(to_right(bits, 1), BITS - 1 - right))


@part
def _mark_word(case, quarter, column, y, bits):
    """Mark cells of a column of words, in row ``y`` and beside it; beyond a side the nearest."""
    word, words, rows = case.sieve.word, case.plan.cells[0], case.plan.cells[1]
    if bits == 0:
        return
    if column < 0:
        bits = 1
    elif column >= words:
        bits = -1 << (BITS - 1)
    top = (quarter * words + _inside(column, words)) * rows
    for k in range(top + _inside(y - AROUND, rows), top + _inside(y + AROUND, rows) + 1):
        word[k] |= bits


@part
def _mark_blocks(case):
    """Mark the blocks in which a cell is marked, at any quarter."""
    word, block = case.sieve.word, case.sieve.block
    words, rows = case.plan.cells[0], case.plan.cells[1]
    for column in range(words):
        top = (column >> 3) * ((rows >> 3) + 1)
        for y in range(rows):
            bits = 0
            for k in range(column * rows + y, len(word), words * rows):
                bits |= word[k]
            if bits == 0:
                continue
            run = 0
            for b in range(8):
                run |= int(bits >> (8 * b) & 255 != 0) << (8 * (column & 7) + b)
            block[top + (y >> 3)] |= run


@part
def _cells(case, begin, x, y):
    """The 64 cells of a map from ``(x, y)`` on, beyond a side those nearest to it."""
    word, words, rows = case.ground.marks, case.plan.cells[0], case.plan.cells[1]
    begin += _inside(y, rows)
    column, right = x >> 6, x & (BITS - 1)
    one = two = word[begin] << 63 >> 63
    if column >= 0:
        one = word[begin + min(column, words - 1) * rows]
        one = one if column < words else one >> 63
    if right == 0:
        return one
    if column >= -1:
        two = word[begin + min(column + 1, words - 1) * rows]
        two = two if column + 1 < words else two >> 63
    return to_right(one, right) | two << (BITS - right)


@part
def may_lie(case, box):
    """Whether the anchor of the group may lie where a box takes it."""
    sieve, plan = case.sieve, case.plan
    wide = 2 * radius(box) > REACH or box[TURN] > 2 * case.limits.angle
    if not sieve.told[SIFTED] or wide:
        return True
    begin = (quarter_at(case.ground, box[YAW]) & 3) * plan.cells[0] * plan.cells[1]
    x = abs(box[UX]) * box[HU] + abs(box[UY]) * box[HV]
    y = abs(box[UY]) * box[HU] + abs(box[UX]) * box[HV]
    for k in range(4):  # no cell lies between
        x, y = (x, -y) if k & 1 else (-x, y)
        if is_marked(plan, sieve.word, begin, box[PX] + x, box[PY] + y):
            return True
    return False


@part
def may_lie_by(case, r, a):
    """Whether the anchor of the group, ``r``, may lie where ``a`` takes it; both are plain."""
    sieve, plan = case.sieve, case.plan
    if not sieve.told[SIFTED] or 2 * max(case.limits.fit, JOINED) > REACH:
        return True
    x, y = plan.plain[a, CX] - plan.corner[0], plan.plain[a, CY] - plan.corner[1]
    reach, scale = 1.5 * farthest(case, r, a), plan.corner[2]
    x0 = _inside(math.floor((x - reach) * scale), plan.cells[0] * BITS) >> 3
    x1 = _inside(math.floor((x + reach) * scale), plan.cells[0] * BITS) >> 3
    y0 = _inside(math.floor((y - reach) * scale), plan.cells[1]) >> 3
    y1 = _inside(math.floor((y + reach) * scale), plan.cells[1]) >> 3
    rows = (plan.cells[1] >> 3) + 1
    for w in range(x0 >> 6, (x1 >> 6) + 1):
        begin, end = max(x0 - 64 * w, 0), min(x1 - 64 * w, 63)
        run = ((2 << (end - begin)) - 1) << begin
        for k in range(w * rows + y0, w * rows + y1 + 1):
            if sieve.block[k] & run:
                return True
    return False


@part
def _inside(cell, count):
    """The nearest cell of a map."""
    return min(max(cell, 0), count - 1)
