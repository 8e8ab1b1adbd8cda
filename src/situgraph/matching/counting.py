"""Counts of marked rooms for many cells at once: their binary digits are words of 64 cells.

Of each digit two marks of the same worth are added at a time, so each word that comes in is looked
at about once: the first of two waits for the second.
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import numpy as np

from situgraph.matching.compiled import part
from situgraph.matching.maps import BITS, begin_of
from situgraph.matching.tables import NEEDED

LEFT, RIGHT, LOW, HIGH = 1, 2, 4, 8  # sides of a map
# Rows of ``Sieve.sums``: where enough are marked, two to carry in, and for each digit one for it
# and one for marks of its worth that wait.
ENOUGH, CARRY, DIGITS = 0, 1, 3


@part
def count_marks(case, counted, quarter, x, y0, height):
    """Into the row ``ENOUGH``: at which cells from ``(x, y0)`` on enough rooms are marked."""
    sums, needed = case.sieve.sums, case.sieve.told[NEEDED]
    digits = 0
    while (1 << digits) < needed:
        digits += 1
    for d in range(digits):  # counted from where ``needed`` more carry over the last digit
        _fill(sums[DIGITS + 2 * d], -(((1 << digits) - needed) >> d & 1), height)
    _fill(sums[ENOUGH], 0, height)
    for k in range(counted):
        _bring(case, k, quarter, x, y0, height, _next(sums, 0, digits, k))
        _count(sums, digits, k, height)
    for d in range(digits):
        if (counted >> d) & 1:
            _settle(sums, digits, d, height)


@part
def _next(sums, d, digits, k):
    """Where the ``k``-th marks go that are worth digit ``d``: to wait, or to be carried on."""
    if d < digits and (k >> d) & 1 == 0:
        return sums[DIGITS + 2 * d + 1]
    return sums[CARRY + (d & 1)]


@part
def _count(sums, digits, k, height):
    """Add the ``k``-th marks with those that wait, digit by digit, till they wait themselves."""
    d = 0
    while d < digits and (k >> d) & 1:
        row = DIGITS + 2 * d
        carry, onward = sums[CARRY + (d & 1)], _next(sums, d + 1, digits, k)
        _add(sums[row], sums[row + 1], carry, onward, height)
        d += 1
    if d == digits:
        _join(sums[ENOUGH], sums[CARRY + (d & 1)], height)


@part
def _settle(sums, digits, d, height):
    """Add marks that still wait at a digit to it and to those above."""
    carry = sums[DIGITS + 2 * d + 1]
    for e in range(d, digits):
        digit = sums[DIGITS + 2 * e]
        for y in range(height):
            both = digit[y] & carry[y]
            digit[y] ^= carry[y]
            carry[y] = both
    _join(sums[ENOUGH], carry, height)


@part
def _add(digit, one, two, onward, height):
    """Add two rows of marks to a digit; what is carried over goes ``onward``."""
    for y in range(height):
        a, b, c = digit[y], one[y], two[y]
        odd = a ^ b
        digit[y] = odd ^ c
        onward[y] = (a & b) | (odd & c)


@part
def _join(row, other, height):
    """Add the cells of another row to one."""
    for y in range(height):
        row[y] |= other[y]


@part
def _fill(row, value, height):
    """A row of the same words."""
    for y in range(height):
        row[y] = value


@part
def _bring(case, k, quarter, x, y0, height, out):
    """Into ``out``: where the ``k``-th room is marked."""
    sieve, word, rows = case.sieve, case.ground.marks, case.plan.cells[1]
    sides = sieve.open[k]
    x, down = x + sieve.shift[0, k], y0 + sieve.shift[1, k]
    begin, end = min(max(-down, 0), height), max(min(rows - down, height), 0)
    column, right = x >> 6, x & (BITS - 1)
    top = begin_of(case, sieve.room[k], quarter) + column * rows + down
    outside = -1 if sides & (LEFT if column < 0 else RIGHT) else 0
    if 0 <= column < case.plan.cells[0]:
        for y in range(begin, end):
            out[y] = to_right(word[top + y], right)
    else:
        for y in range(begin, end):
            out[y] = outside
    if right > 0:
        outside = -1 if sides & (LEFT if column + 1 < 0 else RIGHT) else 0
        top += rows
        if 0 <= column + 1 < case.plan.cells[0]:
            for y in range(begin, end):
                out[y] |= (word[top + y] << 1) << (BITS - 1 - right)
        elif outside:
            for y in range(begin, end):
                out[y] |= -1 << (BITS - right)
    below, above = -1 if sides & LOW else 0, -1 if sides & HIGH else 0
    for y in range(begin):
        out[y] = below
    for y in range(end, height):
        out[y] = above


@part
def to_right(bits, by):
    """Shifted to the right, zeros following."""
    return np.int64(np.uint64(bits) >> np.uint64(by))
