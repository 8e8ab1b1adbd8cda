"""Objects of one wall share part of the error of their places (definition, section 6).

Given which online object is which prior one, how much likelier their places are together than one
by one: what tells that objects stand in the planned order, at the planned distances.
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from situgraph.matching.compiled import part
from situgraph.matching.grouping import first_of, join
from situgraph.matching.tables import Floats, Ints


class Walls(NamedTuple):
    """Room to work in."""

    wall: Annotated[Ints, "objects"]  # of each: the first on its wall, itself where it is alone
    first: Annotated[Ints, "P"]  # the first object on each plane row, -1 for none
    off: Annotated[Floats, "objects", 2]  # from the prior object
    bell: Annotated[Floats, "objects"]  # ln of the probability that the error is not of the tail
    # Of each wall: objects, their errors x and y, squares, ``bell``.
    sums: Annotated[Floats, "objects", 5]


@part
def shared_errors(t, view, at):
    """Ln of the density of the errors of an ``Evidence``'s sights, against independent ones."""
    total, walls = 0.0, t.walls
    if t.rates.shared == 0.0 or not _gather(t, view):
        return total
    _measure(t, at)
    for o in range(len(walls.wall)):
        if walls.wall[o] == o and walls.sums[o, 0] > 1.0:
            total += _together(t.rates, walls, o)
    return total


@part
def _gather(t, view):
    """Put sights on one wall together; whether there is a wall with two."""
    sighted, planned, walls = t.sighted, t.planned, t.walls
    several = False
    for o in range(len(walls.wall)):
        walls.wall[o] = o
        q = _sight(t.links, o)
        if q < 0:
            continue
        for e in range(sighted.row_first[o], sighted.row_first[o + 1]):
            k = sighted.row[e]
            if view.row[k] < 0:
                continue
            for f in range(planned.plane_first[q], planned.plane_first[q + 1]):
                if planned.plane[f] != planned.row_plane[view.row[k]]:
                    continue
                if walls.first[k] < 0:
                    walls.first[k] = o
                    continue
                several = join(walls.wall, o, walls.first[k]) or several
    for e in range(len(sighted.row)):
        walls.first[sighted.row[e]] = -1
    return several


@part
def _sight(links, o):
    """The prior object that ``o`` is a first or second sight of, -1 for none."""
    return links.item[links.claim[o]] if links.claim[o] >= 0 else links.second[o]


@part
def _measure(t, at):
    """The errors of the sights, and their sums by wall."""
    sighted, planned, walls = t.sighted, t.planned, t.walls
    c, s = math.cos(at[0]), math.sin(at[0])
    for o in range(len(walls.wall)):
        for e in range(5):
            walls.sums[o, e] = 0.0
        q = _sight(t.links, o)
        if q < 0:
            continue
        root = first_of(walls.wall, o)
        walls.wall[o] = root
        x, y = t.side * sighted.place[o, 0], sighted.place[o, 1]
        dx = at[1] + c * x - s * y - planned.place[q, 0]
        dy = at[2] + s * x + c * y - planned.place[q, 1]
        square = dx * dx + dy * dy
        walls.off[o, 0], walls.off[o, 1] = dx, dy
        walls.bell[o] = _in_bell(t.rates, square)
        walls.sums[root, 0] += 1.0
        walls.sums[root, 1] += dx
        walls.sums[root, 2] += dy
        walls.sums[root, 3] += square
        walls.sums[root, 4] += walls.bell[o]


@part
def _in_bell(rates, square):
    """Ln of the probability that an error of this squared length is not of the tail."""
    if square > rates.radius * rates.radius or rates.disc == 0.0:
        return 0.0
    tail = math.log(rates.disc / rates.bell) + square * rates.sharpness
    return -tail if tail > 700.0 else -math.log1p(math.exp(tail))


@part
def _together(rates, walls, root):
    """Ln of the ratio of one wall, over which of its errors are of the tail: at most one counts."""
    shared, sharpness, sums = rates.shared, rates.sharpness, walls.sums
    count, x, y = sums[root, 0], sums[root, 1], sums[root, 2]
    square, bells = sums[root, 3], sums[root, 4]
    rest = 1.0 - math.exp(bells)  # the probability that more are
    total = bells + _ratio(shared, sharpness, count, x * x + y * y, square)
    for o in range(root, len(walls.wall)):
        if walls.wall[o] != root or walls.bell[o] == 0.0:
            continue
        one = bells - walls.bell[o] + math.log(-math.expm1(walls.bell[o]))
        rest -= math.exp(one)
        dx, dy = walls.off[o, 0], walls.off[o, 1]
        joint, others = (x - dx) ** 2 + (y - dy) ** 2, square - dx * dx - dy * dy
        total = _log_sum(total, one + _ratio(shared, sharpness, count - 1.0, joint, others))
    return _log_sum(total, math.log(rest)) if rest > 0.0 else total


@part
def _log_sum(one, two):
    """Ln of the sum of two numbers by their logarithms."""
    return max(one, two) + math.log1p(math.exp(-abs(one - two)))


@part
def _ratio(shared, sharpness, count, joint, square):
    """Ln of the bell of ``count`` errors with a common part, against that of independent ones.

    ``joint`` is the squared length of their sum, ``square`` the sum of their squared lengths.
    """
    spread = 1.0 + (count - 1.0) * shared
    within = (square - shared * joint / spread) / (1.0 - shared)
    return most_ratio(count, shared) + sharpness * (square - within)


@part
def most_ratio(count, shared):
    """The largest ratio: no errors at all."""
    return -(count - 1.0) * math.log1p(-shared) - math.log1p((count - 1.0) * shared)


@part
def most_shared(t):
    """The largest sum of what all walls of a ``Drafting`` can give."""
    sighted, wall, size, shared = t.sighted, t.wall, t.size, t.rates.shared
    for i in range(len(t.hanger)):
        t.hanger[i] = -1
    for o in range(len(wall)):
        wall[o], size[o] = o, 0.0
    for o in range(len(wall)):
        for e in range(sighted.row_first[o], sighted.row_first[o + 1]):
            i = sighted.row[e]
            if t.hanger[i] < 0:
                t.hanger[i] = o
            else:
                join(wall, o, t.hanger[i])
    total = 0.0
    for o in range(len(wall)):
        size[first_of(wall, o)] += 1.0
    for o in range(len(wall)):
        if size[o] > 1.0:
            total += most_ratio(size[o], shared)
    return total
