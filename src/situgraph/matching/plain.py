"""Plain rooms: at most one plane in each of four directions a quarter turn apart.

Most rooms are rectangles, seen whole or in part. Where a plain room is explained by another, each
plane has one counterpart at most, the one that faces the same way, and the two directions can be
looked at one by one: sections 2 and 7 of ``docs/matching.md`` without any assignment.

A row of a table of plain rooms holds the direction of the first plane, the lowest and highest yaw
against the one that turns first plane onto first plane, and the signed distances of the planes a
quarter turn after another, and their rows; of the plan also the cosine and sine of the direction,
the centre, and how far the room is from others like it (``homes``).
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math

import numpy as np

from situgraph.matching.compiled import part
from situgraph.matching.slack import SLACK
from situgraph.matching.tables import Floats

BASE, LOW, HIGH, SIDE, ROW, COS, SIN, CX, CY, CLEAR = 0, 1, 2, 3, 7, 11, 12, 13, 14, 15
PLAN_COLUMNS = 16  # a room seen has the first eleven
EXACT = 1e-6  # rad; of a plan's room, that is plain when its planes are as square as this
QUARTER = math.pi / 2
SHARP = 0.7  # rad; less than half a quarter turn
JOINED = 0.3  # half width of an interval that is put together of two, at most, metres


def widths_of(table: Floats) -> Floats:
    """Both widths (2, M) of the rooms of such a table that have four planes; NaN of the others."""
    width = table[:, SIDE : SIDE + 2] + table[:, SIDE + 2 : SIDE + 4]
    width[np.isnan(width).any(axis=1) | np.isnan(table[:, BASE])] = math.nan
    return np.ascontiguousarray(width.T)


@part
def square(t, r, spread, turn, row):
    """Fill the row of one room, the direction with NaN when the room is not plain.

    ``t`` has ``first``, ``angle``, ``distance``; directions may be ``spread`` off a quarter turn,
    and a plane's own direction ``turn`` off its counterpart's.
    """
    begin, end = t.first[r], t.first[r + 1]
    base = t.angle[begin]
    low = last = -math.inf
    high = first = math.inf
    row[BASE] = math.nan
    for k in range(4):
        row[SIDE + k] = math.nan
    for i in range(begin, end):
        quarter = round((t.angle[i] - base) / QUARTER)
        off = base + quarter * QUARTER - t.angle[i]
        k = quarter & 3
        if abs(off) > spread or not math.isnan(row[SIDE + k]):
            return
        row[SIDE + k], row[ROW + k] = t.distance[i], i
        low, last = max(low, min(last, off)), max(last, off)
        high, first = min(high, max(first, off)), min(first, off)
    both = (math.isnan(row[SIDE]) and math.isnan(row[SIDE + 2])) or (
        math.isnan(row[SIDE + 1]) and math.isnan(row[SIDE + 3])
    )
    if both:  # all planes are parallel
        return
    if end - begin < 3:  # none can be missing
        low, high = last, first
    row[BASE] = base
    row[LOW], row[HIGH] = low - turn - SLACK - EXACT, high + turn + SLACK + EXACT


@part
def has_four(row):
    """Whether a room of this row of a table is plain and has four planes."""
    return not math.isnan(row[BASE] + row[SIDE] + row[SIDE + 1] + row[SIDE + 2] + row[SIDE + 3])


@part
def is_plain(case, r):
    """Whether online room ``r`` is plain."""
    return not math.isnan(case.seen.plain[r, BASE])


@part
def plain_pair(case, r, a):
    """Whether both rooms are plain."""
    return is_plain(case, r) and not math.isnan(case.plan.plain[a, BASE])


@part
def facing(case, r, a, k, yaw):
    """The plane of plain room ``r`` on side ``k``, and the row of ``a`` that it faces; -1 for none.

    Of planes whose directions may differ by less than ``SHARP`` there is no other.
    """
    mine, its = case.seen.plain[r], case.plan.plain[a]
    m = (k + round((yaw + mine[BASE] - its[BASE]) / QUARTER)) & 3
    i = -1 if math.isnan(mine[SIDE + k]) else int(mine[ROW + k])
    return i, -1 if math.isnan(its[SIDE + m]) else int(its[ROW + m])


@part
def plain_alike(case, r, a):
    """Whether plain room ``a`` explains plain room ``r`` in isolation, at any placement."""
    for quarter in range(4):  # noqa: SIM110
        if plain_places(case, r, a, quarter):
            return True
    return False


@part
def mark_whole(case, r):
    """Mark in ``like`` the plain rooms of four planes that explain plain room ``r`` in isolation.

    Where three planes of ``r`` were seen they all do, as one of them may be missing. Where all four
    were, one of its widths must be a width of theirs. Returns how many there are.
    """
    side, width, like = case.seen.plain[r], case.plan.width, case.found.like[r]
    one, two = side[SIDE] + side[SIDE + 2], side[SIDE + 1] + side[SIDE + 3]
    off = case.limits.fit + case.limits.moved + 2 * SLACK
    if math.isnan(one) or math.isnan(two):
        one, off = 0.0, math.inf
    count, rooms = 0, len(case.plan.storey)
    for word in range(len(like)):
        bits, begin = 0, word * 64
        for a in range(begin, min(begin + 64, rooms)):
            w, v = width[0, a], width[1, a]
            fits = (abs(w - one) <= off) | (abs(v - one) <= off)
            fits |= (abs(w - two) <= off) | (abs(v - two) <= off)
            bits |= int(fits) << (a - begin)
            count += int(fits)
        like[word] = bits
    return count


@part
def whole(case, a):
    """Whether prior room ``a`` is plain and has four planes."""
    return not math.isnan(case.plan.width[0, a])


@part
def _along(case, r, a, k, quarter, out):
    """Where along one direction planes ``k`` and ``k + 2`` of ``r`` let its centre lie.

    Turned by so many quarters, along the normal that plane ``k`` then has, from the centre of
    ``a``. Into ``out`` go two places, one at a plane that fits; equal when one plane decides.
    Returns how many planes are missing then, -1 when there is no such place.
    """
    seen, plan, limits = case.seen.plain, case.plan.plain, case.limits
    m = (k + quarter) & 3
    one = seen[r, SIDE + k] - plan[a, SIDE + m]
    two = plan[a, SIDE + (m ^ 2)] - seen[r, SIDE + k + 2]
    if math.isnan(one) or math.isnan(two):
        # Of the planes that were seen, one has no counterpart.
        lost = not math.isnan(seen[r, SIDE + k]) and not math.isnan(seen[r, SIDE + k + 2])
        if math.isnan(one) and math.isnan(two):
            return -1
        out[0] = out[1] = two if math.isnan(one) else one
        return 1 if lost else 0
    out[0], out[1] = one, two
    return 0 if abs(one - two) <= limits.fit + limits.moved + 2 * SLACK else 1


@part
def farthest(case, r, a):
    """How far apart the centres of plain rooms are along a direction, at most, where walls meet."""
    mine_low = its_low = math.inf
    mine_high = its_high = -math.inf
    for k in range(SIDE, SIDE + 4):
        mine, its = case.seen.plain[r, k], case.plan.plain[a, k]
        if not math.isnan(mine):
            mine_low, mine_high = min(mine_low, mine), max(mine_high, mine)
        if not math.isnan(its):
            its_low, its_high = min(its_low, its), max(its_high, its)
    return max(mine_high - its_low, its_high - mine_low)


@part
def plain_places(case, r, a, quarter):
    """Where ``a`` can explain ``r``, turned by so many quarters; False when it cannot.

    Into ``found.along``, for each of two directions: the middle and half width of an interval from
    the centre of ``a``, and of a second one, whose half width is negative when there is only one.
    """
    limits, lost = case.limits, 0
    for k in range(2):
        out = case.found.along[k]
        missing = _along(case, r, a, k, quarter, out)
        if missing < 0:
            return False
        lost += missing
        one, two = out[0], out[1]
        half = limits.fit + SLACK + EXACT * (abs(one) + abs(two))
        out[1], out[2], out[3] = half, two, half
        apart = abs(one - two) / 2
        if apart + half <= JOINED:
            out[0], out[1], out[3] = (one + two) / 2, half + apart, -1.0
    return lost <= (0 if case.seen.strict[r] else 1)


@part
def may_plain(case, r, a, yaw, turn, x, y, along, across):
    """A quick necessary test for plain rooms, for the placements of a box.

    They turn by ``yaw`` up to ``turn`` more or less, and take the centre of ``r`` to ``(x, y)``, up
    to ``along`` and ``across`` the direction of ``a`` more or less.
    """
    seen, plan, limits = case.seen.plain, case.plan.plain, case.limits
    against = yaw - plan[a, BASE] + seen[r, BASE]
    quarter = round(against / QUARTER)
    off = against - quarter * QUARTER
    if off < seen[r, LOW] - turn or off > seen[r, HIGH] + turn:
        return False
    dx, dy, c, s = x - plan[a, CX], y - plan[a, CY], plan[a, COS], plan[a, SIN]
    u, v = c * dx + s * dy, c * dy - s * dx
    inexact = SLACK + EXACT * (abs(u) + abs(v))
    lost = 0
    for k in range(2):
        m = (k + quarter) & 3
        t, give = (v, across) if m & 1 else (u, along)
        if m & 2:
            t = -t
        give += inexact
        one = abs(seen[r, SIDE + k] - plan[a, SIDE + m] - t) - give
        two = abs(plan[a, SIDE + (m ^ 2)] - seen[r, SIDE + k + 2] - t) - give
        if not (one <= limits.fit or two <= limits.fit):
            return False
        lost += not (one <= limits.moved or math.isnan(seen[r, SIDE + k]))
        lost += not (two <= limits.moved or math.isnan(seen[r, SIDE + k + 2]))
    return lost <= 1
