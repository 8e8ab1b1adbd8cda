"""Where all rooms together may lie, told for all cells of the plan at once, 64 of them a word.

A feasible placement takes nearly all rooms to marked cells of their maps (``ground``). The mean
room centre runs over all cells of the plan, the yaw over parts so narrow that no room moves by
more than half a cell from where the middle of the part takes it. Then each map is shifted by whole
cells, and how many rooms are marked is counted with binary digits that are words themselves.

The cell of a room is that of the mean plus the rounded shift, or one beside it: half a cell for
the yaw, half for the rounding, and less than one for where in its cell the mean lies leave three
columns and three rows, and the maps are spread by a cell. Section 7 of ``docs/matching.md``.
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math

from situgraph.matching.compiled import part
from situgraph.matching.counting import ENOUGH, HIGH, LEFT, LOW, RIGHT, count_marks
from situgraph.matching.ground import MOST_MARKED
from situgraph.matching.maps import (
    BITS,
    begin_of,
    draw,
    slot_of,
    tells,
)
from situgraph.matching.plain import QUARTER
from situgraph.matching.slack import SLACK
from situgraph.matching.tables import KEPT, MADE, NEEDED, PARTED, SIFTED, STAGE, WITHIN

FAR = 1.0e6  # cells
MOST_COUNTED = 0.9  # share of all cells, about, that are marked in the map of one that is counted
SPARE = 8  # rooms that are counted beyond twice as many as may be lost
WORTH = 256  # words counted for one hypothesis, at most


@part
def sift(case):
    """Tell where the mean room centre can be, where that is worth it.

    Not where a region tells: there only maps are left out, or what was told for it stays.
    """
    counted = _choose(case)
    if case.sieve.told[NEEDED] <= 0 or not _part(case, counted):
        return
    if case.found.count[STAGE] != WITHIN and not _sift_all(case, counted):
        return
    if tells(case, case.sieve.room[counted - 1], MOST_MARKED):  # no others need be drawn then
        for r in range(len(case.sieve.counted)):
            case.ground.known[r] = case.sieve.counted[r]


@part
def _sift_all(case, counted):
    """For all yaws; False where what is left cannot be told or is too much."""
    told = case.sieve.told
    told[SIFTED] = told[KEPT] = 0
    for k in range(counted):
        r = case.sieve.room[k]
        if not case.ground.drawn[slot_of(case, r)]:
            draw(case, r)
    for quarter in range(4):
        for k in range(counted):
            case.sieve.open[k] = _open(case, begin_of(case, case.sieve.room[k], quarter))
        for p in range(told[PARTED]):
            if not _sift(case, counted, quarter, p):
                return False
    told[SIFTED] = 1
    return True


@part
def _choose(case):
    """Choose the rooms that are counted, those of the fewest cells; returns how many."""
    sieve, alike = case.sieve, case.found.alike
    room, count = sieve.room, 0
    for r in range(len(room)):
        if tells(case, r, MOST_COUNTED):
            k = count
            while k > 0 and alike[room[k - 1]] > alike[r]:
                room[k] = room[k - 1]
                k -= 1
            room[k] = r
            count += 1
    count = min(count, 2 * _spared(case, count) + SPARE)
    for r in range(len(room)):
        sieve.counted[r] = 0
    for k in range(count):
        sieve.counted[room[k]] = 1
    sieve.told[NEEDED] = count - _spared(case, count)
    return count


@part
def _spared(case, count):
    """How many of the first ``count`` rooms may be unexplained, at most."""
    loss, ranked, room = case.task.loss, case.spans.sorted, case.sieve.room
    for k in range(count):
        value, m = loss[room[k]], k
        while m > 0 and ranked[m - 1] > value:
            ranked[m] = ranked[m - 1]
            m -= 1
        ranked[m] = value
    left, k = case.task.budget, 0
    while k < count and ranked[k] <= left:
        left -= ranked[k]
        k += 1
    return min(k, len(loss) - case.task.least)


@part
def _part(case, counted):
    """Cut the yaws at which rooms can be explained into parts; False when they are too many.

    They are told from the quarter's, of which none may be so far that a box could lie in two.
    """
    seen, plan, sieve, groups = case.seen, case.plan, case.sieve, case.groups
    low, high, far, wanted = math.inf, -math.inf, 0.0, 0
    for k in range(counted):
        r = sieve.room[k]
        for i in range(seen.first[r], seen.first[r + 1]):
            turn = seen.angle[i] - seen.angle[0]
            turn -= round(turn / QUARTER) * QUARTER
            low, high = min(low, turn), max(high, turn)
    for r in range(len(seen.storey)):
        far = max(far, math.sqrt(seen.center[r, 0] ** 2 + seen.center[r, 1] ** 2))
    for g in range(groups.told[MADE]):
        wanted += 4 * case.found.alike[groups.anchor[g]]
    most = case.limits.angle + SLACK
    low, high = plan.turns[0] - high - most, plan.turns[1] - low + most
    half = min(0.4999 / (far * plan.corner[2] + 1e-9), most)
    parts = math.ceil((high - low) / (2 * half))
    sieve.turn[0], sieve.turn[1], sieve.told[PARTED] = low, half, parts
    words = 4 * parts * counted * plan.cells[0] * plan.cells[1]
    limit = QUARTER / 2 - 3 * case.limits.angle
    return low >= -limit and high <= limit and words <= WORTH * wanted


@part
def _open(case, begin):
    """The sides of a map at which a room may lie outside of it: it is marked there."""
    word, words, rows = case.ground.marks, case.plan.cells[0], case.plan.cells[1]
    last = begin + (words - 1) * rows
    left = right = low = high = 0
    for y in range(rows):
        left |= word[begin + y]
        right |= word[last + y]
    for top in range(begin, last + 1, rows):
        low |= word[top]
        high |= word[top + rows - 1]
    sides = LEFT if left & 1 else 0
    sides |= RIGHT if right < 0 else 0
    sides |= LOW if low != 0 else 0
    return sides | (HIGH if high != 0 else 0)


@part
def _sift(case, counted, quarter, p):
    """For one part of the yaws; False where what is left cannot be told or is too much."""
    sieve, words, rows = case.sieve, case.plan.cells[0], case.plan.cells[1]
    shift_rooms(case, counted, quarter, p)
    left, right = _reach(case, counted, 0, 1, LEFT), _reach(case, counted, 0, -1, RIGHT)
    low, high = _reach(case, counted, 1, 1, LOW), _reach(case, counted, 1, -1, HIGH)
    if max(left, right, low, high) >= FAR:
        return False
    x0, x1, y0, height = -left, words * BITS + right, -low, rows + high + low
    if height > len(sieve.sums[0]):
        return False
    if height <= 0:
        return True
    for x in range(x0, x1, BITS):
        count_marks(case, counted, quarter, x, y0, height)
        for y in range(height):
            if sieve.sums[ENOUGH, y] != 0:
                k = sieve.told[KEPT]
                if k == len(sieve.left):
                    return False
                sieve.left[k, 0], sieve.left[k, 1] = quarter * sieve.told[PARTED] + p, x
                sieve.left[k, 2], sieve.left[k, 3] = y0 + y, sieve.sums[ENOUGH, y]
                sieve.told[KEPT] += 1
    return True


@part
def shift_rooms(case, counted, quarter, p):
    """By how many cells each room is from the mean, for one part of the yaws."""
    sieve, center = case.sieve, case.seen.center
    yaw = _yaw(case, quarter, p)
    c, s = math.cos(yaw) * case.plan.corner[2], math.sin(yaw) * case.plan.corner[2]
    for k in range(counted):
        x, y = center[sieve.room[k], 0], center[sieve.room[k], 1]
        sieve.shift[0, k] = math.floor(c * x - s * y + 0.5)
        sieve.shift[1, k] = math.floor(s * x + c * y + 0.5)


@part
def _yaw(case, quarter, p):
    """The middle of a part of the yaws."""
    low, half = case.sieve.turn[0], case.sieve.turn[1]
    return case.ground.base + quarter * QUARTER + low + (2 * p + 1) * half


@part
def _reach(case, counted, axis, sign, side):
    """How far beyond a side of the map the mean can be, so that enough rooms are on this one.

    ``FAR`` when so many may lie outside that there is no telling.
    """
    sieve, ranked = case.sieve, case.spans.sorted
    for k in range(counted):
        value = FAR if sieve.open[k] & side else sign * sieve.shift[axis, k]
        m = k
        while m > 0 and ranked[m - 1] < value:
            ranked[m] = ranked[m - 1]
            m -= 1
        ranked[m] = value
    return int(ranked[sieve.told[NEEDED] - 1])
