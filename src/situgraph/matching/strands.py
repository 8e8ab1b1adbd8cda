"""The walls of a room that has many, by direction and offset.

A plane can correspond to few of a corridor's hundreds of walls: of those of its direction, the ones
near its line. A strand are the walls of nearly one direction, sorted by offset; a room's strands
are sorted by direction.
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math

import numpy as np

from situgraph.matching.compiled import part
from situgraph.matching.plain import CX, CY
from situgraph.matching.slack import SLACK, give, wrapped
from situgraph.matching.tables import WORK, Floats, Ints

MANY = 16  # walls of a room, from which on they are sorted
BIN = math.radians(0.25)  # walls whose directions differ less may be in one strand
SPREAD = BIN / 2 + 1e-9  # by which a wall's direction differs from its strand's, at most
ROUNDING = 1e-6  # metres
LOOKUP = 8  # comparisons of planes that a look for the first strand is worth, about


def strands_of(first: Ints, row: Floats, distance: Floats) -> tuple[Ints | Floats, ...]:
    """The strands of all rooms with many walls: the fields of ``Plan`` from ``strand_first`` on.

    ``first`` (M + 1,), ``row`` (Q, 4), ``distance`` (Q,) of the rooms' centres.
    """
    counts = np.diff(first)
    room = np.repeat(np.arange(len(counts)), counts)
    rows = np.flatnonzero(counts[room] >= MANY)
    bins = np.floor((row[rows, 3] + math.pi) / BIN).astype(np.int64)
    order = np.lexsort((distance[rows], bins, room[rows]))
    rows, bins = rows[order], bins[order]
    key = room[rows] * (10 + round(2 * math.pi / BIN)) + bins
    begins = np.flatnonzero(np.diff(key, prepend=-1)) if len(key) else np.zeros(0, dtype=np.int64)
    angle = (bins[begins] + 0.5) * BIN - math.pi
    return (
        np.searchsorted(room[rows][begins], np.arange(len(first))).astype(np.int64),
        np.stack([np.cos(angle), np.sin(angle)], axis=1),
        angle,
        np.append(begins, len(key)).astype(np.int64),
        distance[rows].copy(),
        rows.astype(np.int64),
    )


@part
def rows_near(case, a, i, yaw, x, y, far, slack):
    """The rows of prior room ``a`` to hold plane ``i`` against: where they begin, and how many.

    All of the room; of one that has strands those only whose direction can be that of the plane,
    turned by ``yaw``, and whose offset, seen from ``(x, y)``, can differ by no more than ``far``,
    and a few more. Those are listed apart, and begin at -1 (``row_at``). Their comparisons are
    counted here.
    """
    plan, limits = case.plan, case.limits
    if plan.strand_first[a + 1] == plan.strand_first[a]:
        rows = plan.first[a + 1] - plan.first[a]
        case.found.count[WORK] += rows
        return plan.first[a], rows
    turn = limits.angle + slack.turn + SLACK
    return -1, _list_rows(case, a, i, yaw, x, y, turn, far + SLACK, slack)


@part
def row_at(case, begin, c):
    """The ``c``-th of those rows."""
    return begin + c if begin >= 0 else case.bench.close[c]


@part
def _list_rows(case, a, i, yaw, x, y, turn, reach, slack):
    """List such rows of a room that has strands in ``bench.close``; returns how many."""
    seen, plan, close = case.seen, case.plan, case.bench.close
    begin, end = plan.strand_first[a], plan.strand_first[a + 1]
    low = wrapped(seen.angle[i] + yaw - turn - SPREAD)
    width = 2 * (turn + SPREAD)
    dx, dy = x - plan.plain[a, CX], y - plan.plain[a, CY]
    arm = abs(slack.wx) + abs(slack.wy)
    bent = SPREAD * (abs(dx) + abs(dy) + slack.hu + slack.hv + arm * (slack.bend + slack.swing))
    k, count = first_from(plan.strand_angle, begin, end, low), 0
    for _ in range(begin, end):
        if k == end:
            k = begin
        ahead = plan.strand_angle[k] - low
        if ahead < 0:
            ahead += 2 * math.pi
        if ahead > width:
            break
        nx, ny = plan.strand_normal[k, 0], plan.strand_normal[k, 1]
        want = seen.distance[i] - (nx * dx + ny * dy)
        far = reach + give(slack, nx, ny) + bent + ROUNDING
        last = plan.strand_line[k + 1]
        at = first_from(plan.strand_offset, plan.strand_line[k], last, want - far)
        while at < last and plan.strand_offset[at] <= want + far:
            close[count] = plan.strand_row[at]
            count += 1
            at += 1
        k += 1
        case.found.count[WORK] += 2
    case.found.count[WORK] += count + LOOKUP
    return count


@part
def first_from(values, begin, end, least):
    """The first place from ``begin`` on where ``values``, ascending, are not below ``least``."""
    while begin < end:
        middle = (begin + end) // 2
        if values[middle] < least:
            begin = middle + 1
        else:
            end = middle
    return begin
