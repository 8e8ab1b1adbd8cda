"""The plain rooms of a plan, tabled; and which of them are the only ones near by.

A room seen with four walls that all fit a prior room of four walls is explained by no other one,
unless a corner of that comes as near to the same corner of this as two residuals. How near corners
come is measured once a plan, and a look at the cell of a room's centre finds the prior room there.
So it is in plans whose walls are all parallel or at right angles; in others rooms are looked up.
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from situgraph.matching.blocks import Block
from situgraph.matching.compiled import entry, part
from situgraph.matching.corners import Corners, cell_of, quarter_of
from situgraph.matching.pairing import add_option
from situgraph.matching.plain import (
    BASE,
    CLEAR,
    COS,
    CX,
    CY,
    EXACT,
    PLAN_COLUMNS,
    QUARTER,
    ROW,
    SIDE,
    SIN,
    has_four,
    square,
)
from situgraph.matching.records import record_at, scratch
from situgraph.matching.slack import SLACK, give, residuals
from situgraph.matching.tables import FIT, Floats, Ints, Shorts, Singles, Table

FARTHEST = 6.0  # metres; beyond that it is not measured how near a corner comes
ROUNDED = 1e-3  # metres, and more than single precision and walls not quite parallel take
AROUND = 0.3  # metres around a room's centre where it is looked for
WORDS = 32  # cells of homes a word of a map: each is as wide as two cells of that, and as tall


class Squaring(NamedTuple):
    """The rooms of a plan, its corners as ``Plan`` has them, and the table to be made of them."""

    first: Ints  # (M + 1,)
    angle: Floats  # (Q,) of the planes' normals
    distance: Floats  # (Q,) of the room's centre
    center: Table  # (M, 2)
    storey: Ints  # (M,)
    straight: int  # whether all walls are parallel or at right angles, and all corners are listed
    corner_first: Shorts
    corner_place: Singles
    corner_room: Shorts
    corner_cells: Ints
    corner_origin: Floats
    table: Table  # (M, PLAN_COLUMNS)


def plain_rooms(
    first: Ints,
    row: Floats,
    distance: Floats,
    center: Floats,
    storey: Ints,
    corners: Corners,
    *,
    straight: bool,
) -> Floats:
    """The table of a plan's plain rooms (M, PLAN_COLUMNS); lengths from the origin of ``center``.

    ``first`` (M + 1,), ``row`` (Q, 4), ``distance`` (Q,), ``center`` (M, 2), ``storey`` (M,);
    ``straight`` when all walls are parallel or at right angles, and all corners are listed.
    """
    table = np.empty((len(center), PLAN_COLUMNS))
    angle, distance, center = (np.ascontiguousarray(v) for v in (row[:, 3], distance, center))
    listed = corners.begin, corners.place, corners.room, corners.cells, corners.origin
    given = first, angle, distance, center, storey, int(straight), *listed, table
    draw_plain(Block.of(Squaring, given).place)
    return table


def homes_of(table: Floats, storey: Ints, cells: Ints, corner: Floats) -> Shorts:
    """The plain room that is at home in each cell, by storey, row and column; -1 for none.

    ``table`` is that of ``plain_rooms``, ``cells`` and ``corner`` are those of the maps.
    """
    wide, tall = WORDS * int(cells[0]), int(cells[1]) // 2 + 1
    home = np.full(tall * wide * (int(storey.max(initial=0)) + 1), -1, dtype=np.int32)
    room = np.flatnonzero(table[:, CLEAR] > 0)
    level = storey[room] * tall
    for x, y in ((-1, -1), (-1, 1), (1, -1), (1, 1), (0, 0)):
        place = table[room, CX : CY + 1] + (x * AROUND, y * AROUND)
        column, line = np.floor((place - corner[:2]) * (corner[2] / 2)).astype(np.int64).T
        home[(level + line) * wide + column] = room
    return home


@entry
def draw_plain(place):
    """Fill the table of a ``Squaring``."""
    t = record_at(place, Squaring)
    for a in range(len(t.first) - 1):
        row = t.table[a]
        square(t, a, EXACT, 0.0, row)
        row[COS], row[SIN] = math.cos(row[BASE]), math.sin(row[BASE])
        row[CX], row[CY] = t.center[a, 0], t.center[a, 1]
        row[CLEAR] = _clear(t, a, row) if t.straight and has_four(row) else 0.0


@part
def _clear(t, a, row):
    """How near a corner of another room comes to the same corner of ``a``.

    Along the walls: the larger of both distances counts.
    """
    nearest, nx, ny = FARTHEST, row[COS], row[SIN]
    reach = FARTHEST * (abs(nx) + abs(ny))
    for k in range(4):
        one, two = row[SIDE + k], row[SIDE + ((k + 1) & 3)]
        x, y = row[CX] - one * nx + two * ny, row[CY] - one * ny - two * nx
        x0, x1 = cell_of(t, 0, x - reach), cell_of(t, 0, x + reach)
        y0, y1 = cell_of(t, 1, y - reach), cell_of(t, 1, y + reach)
        quarter = quarter_of(t, row[BASE] + k * QUARTER) & 3
        top = (4 * t.storey[a] + quarter) * t.corner_cells[1]
        for line in range(top + y0, top + y1 + 1):
            first = line * t.corner_cells[0]
            for c in range(t.corner_first[first + x0], t.corner_first[first + x1 + 1]):
                dx, dy = t.corner_place[c, 0] - x, t.corner_place[c, 1] - y
                apart = max(abs(nx * dx + ny * dy), abs(nx * dy - ny * dx))
                if t.corner_room[c] != a:
                    nearest = min(nearest, apart)
        nx, ny = -ny, nx
    return max(nearest - ROUNDED, 0.0)


@part
def _home(plan, storey, x, y):
    """The prior room at home at a place, -1 for none."""
    scale, wide = plan.corner[2] / 2, WORDS * plan.cells[0]
    column = math.floor((x - plan.corner[0]) * scale)
    line, tall = math.floor((y - plan.corner[1]) * scale), plan.cells[1] // 2 + 1
    if column < 0 or column >= wide or line < 0 or line >= tall:
        return -1
    return plan.home[(storey * tall + line) * wide + column]


@part
def _reach(limits, turn):
    """How near a corner comes with which another room explains one all of whose walls fit.

    Each is off by a residual. Yaws may be ``turn`` apart; walls face the same way then.
    """
    crossing = limits.sine > limits.angle and 2 * limits.angle + turn < 1.0
    return 2 * (limits.fit + SLACK) if crossing else math.inf


@part
def explain_at_home(case, spot, r, storey, yaw, x, y):
    """Explain room ``r`` by the prior room at home where it lies, if no other can.

    Its option and its planes are those ``explain`` gives it. False, and nothing said, when some
    wall does not fit, or another room comes near.
    """
    seen, plan, limits, content = case.seen, case.plan, case.limits, case.content
    mine, a = seen.plain[r], _home(plan, storey, x, y)
    if a < 0 or not has_four(mine) or len(content.room_need) + len(content.row_need) > 0:
        return False
    its, score = plan.plain[a], 0.0
    if its[CLEAR] <= _reach(limits, 0.0):
        return False
    quarter, found = round((yaw + mine[BASE] - its[BASE]) / QUARTER), scratch(8)
    for k in range(4):
        i, j = int(mine[ROW + k]), int(its[ROW + ((k + quarter) & 3)])
        bend, off = residuals(case, i, j, yaw, x, y)
        found[k], found[k + 4] = bend, off
        value = limits.fit_peak - off * off * limits.plane_weight
        value -= bend * bend * limits.angle_weight
        fits = abs(bend) <= limits.angle + SLACK and abs(off) <= limits.fit + SLACK
        if not fits or value < limits.missing:
            return False
        score += value
    for k in range(4):
        i = int(mine[ROW + k])
        spot.row[i], spot.state[i] = int(its[ROW + ((k + quarter) & 3)]), FIT
        spot.bend[i], spot.offset[i] = found[k], found[k + 4]
    add_option(case, r, a, score)
    return True


@part
def stays_alone(case, r, slack):
    """Whether no other prior room explains ``r`` at placements with this slack around a view's.

    ``case.one`` is the view, in which all walls of ``r`` fit.
    """
    a = case.one.room[r]
    if a < 0 or not has_four(case.seen.plain[r]):
        return False
    row = case.plan.plain[a]
    c, s = row[COS], row[SIN]
    away = max(give(slack, c, s), give(slack, -s, c))
    return away + _reach(case.limits, slack.turn) < row[CLEAR]
