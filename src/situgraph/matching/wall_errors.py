"""Objects of one wall share part of the error of their places (definition, section 6).

Given which online object is which prior one, how much likelier their places are together than one
by one: what tells that objects stand in the planned order, at the planned distances.
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from situgraph.matching.compiled import entry, kernel
from situgraph.matching.grouping import first_of, join
from situgraph.matching.tables import Floats, Ints, Table


class Walls(NamedTuple):
    """Room to work in."""

    wall: Ints  # (n,) of each object: the first one on its wall, itself where it is alone
    first: Ints  # (P,) the first object on each plane row, -1 for none
    off: Table  # (n, 2) from the prior object
    bell: Floats  # (n,) ln of the probability that the error is not of the tail
    sums: Table  # (n, 5) of each wall: objects, their errors x and y, squares, ``bell``


@kernel
def room_for_walls(objects, rows):
    """``Walls``."""
    return Walls(
        np.empty(objects, dtype=np.int64),
        np.full(rows, -1, dtype=np.int64),
        np.empty((objects, 2)),
        np.empty(objects),
        np.empty((objects, 5)),
    )


@kernel
def shared_errors(sighted, planned, rates, prior_plane, row, at, links, walls):
    """Ln of the density of the sights' errors, against that of independent ones."""
    n, total = len(sighted.category), 0.0
    if rates.shared == 0.0:
        return total
    if not _gather(sighted, planned, prior_plane, row, links, walls):
        return total
    _measure(sighted, planned, rates, at, links, walls)
    for o in range(n):
        if walls.wall[o] == o and walls.sums[o, 0] > 1.0:
            total += _together(
                rates.shared, rates.sharpness, walls.wall, walls.off, walls.bell, walls.sums, o
            )
    return total


@kernel
def _gather(sighted, planned, prior_plane, row, links, walls):
    """Put sights on one wall together; whether there is a wall with two."""
    n, several = len(sighted.category), False
    for o in range(n):
        walls.wall[o] = o
        q = _sight(links.claim, links.item, links.second, o)
        if q < 0:
            continue
        for e in range(sighted.row_first[o], sighted.row_first[o + 1]):
            k = sighted.row[e]
            if row[k] < 0:
                continue
            for f in range(planned.plane_first[q], planned.plane_first[q + 1]):
                if planned.plane[f] != prior_plane[row[k]]:
                    continue
                if walls.first[k] < 0:
                    walls.first[k] = o
                    continue
                several = join(walls.wall, o, walls.first[k]) or several
    for e in range(len(sighted.row)):
        walls.first[sighted.row[e]] = -1
    return several


@kernel
def _sight(claim, item, second, o):
    """The prior object that ``o`` is a first or second sight of, -1 for none."""
    return item[claim[o]] if claim[o] >= 0 else second[o]


@kernel
def _measure(sighted, planned, rates, at, links, walls):
    """The errors of the sights, and their sums by wall."""
    c, s = math.cos(at[0]), math.sin(at[0])
    for o in range(len(sighted.category)):
        for e in range(5):
            walls.sums[o, e] = 0.0
        q = _sight(links.claim, links.item, links.second, o)
        if q < 0:
            continue
        root = first_of(walls.wall, o)
        walls.wall[o] = root
        x = at[1] + c * sighted.place[o, 0] - s * sighted.place[o, 1] - planned.place[q, 0]
        y = at[2] + s * sighted.place[o, 0] + c * sighted.place[o, 1] - planned.place[q, 1]
        square = x * x + y * y
        walls.off[o, 0], walls.off[o, 1] = x, y
        walls.bell[o] = _in_bell(rates.bell, rates.sharpness, rates.disc, rates.radius, square)
        walls.sums[root, 0] += 1.0
        walls.sums[root, 1] += x
        walls.sums[root, 2] += y
        walls.sums[root, 3] += square
        walls.sums[root, 4] += walls.bell[o]


@kernel
def _in_bell(bell, sharpness, disc, radius, square):
    """Ln of the probability that an error of this squared length is not of the tail."""
    if square > radius * radius or disc == 0.0:
        return 0.0
    tail = math.log(disc / bell) + square * sharpness
    return -tail if tail > 700.0 else -math.log1p(math.exp(tail))


@kernel
def _together(shared, sharpness, wall, off, bell, sums, root):
    """Ln of the ratio of one wall, over which of its errors are of the tail: at most one counts."""
    count, x, y = sums[root, 0], sums[root, 1], sums[root, 2]
    square, bells = sums[root, 3], sums[root, 4]
    rest = 1.0 - math.exp(bells)  # the probability that more are
    total = bells + _ratio(shared, sharpness, count, x * x + y * y, square)
    for o in range(root, len(wall)):
        if wall[o] != root or bell[o] == 0.0:
            continue
        one = bells - bell[o] + math.log(-math.expm1(bell[o]))
        rest -= math.exp(one)
        dx, dy = off[o, 0], off[o, 1]
        joint, others = (x - dx) ** 2 + (y - dy) ** 2, square - dx * dx - dy * dy
        total = np.logaddexp(total, one + _ratio(shared, sharpness, count - 1.0, joint, others))
    return np.logaddexp(total, math.log(rest)) if rest > 0.0 else total


@kernel
def _ratio(shared, sharpness, count, joint, square):
    """Ln of the bell of ``count`` errors with a common part, against that of independent ones.

    ``joint`` is the squared length of their sum, ``square`` the sum of their squared lengths.
    """
    spread = 1.0 + (count - 1.0) * shared
    within = (square - shared * joint / spread) / (1.0 - shared)
    return most_ratio(count, shared) + sharpness * (square - within)


@kernel
def most_ratio(count, shared):
    """The largest ratio: no errors at all."""
    return -(count - 1.0) * math.log1p(-shared) - math.log1p((count - 1.0) * shared)


@entry
def most_shared(first, row, rows, shared):
    """The largest sum of what all walls can give; ``row`` are the plane rows of each object."""
    n = len(first) - 1
    wall, one, size = np.arange(n), np.full(rows, -1, dtype=np.int64), np.zeros(n)
    for o in range(n):
        for e in range(first[o], first[o + 1]):
            if one[row[e]] < 0:
                one[row[e]] = o
            else:
                join(wall, o, one[row[e]])
    total = 0.0
    for o in range(n):
        size[first_of(wall, o)] += 1.0
    for o in range(n):
        if size[o] > 1.0:
            total += most_ratio(size[o], shared)
    return total
