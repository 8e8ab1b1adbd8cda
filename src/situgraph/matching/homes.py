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
from itertools import product
from typing import NamedTuple

import numpy as np

from situgraph.matching.blocks import Block
from situgraph.matching.compiled import entry, part
from situgraph.matching.corners import Corners, cell_of, quarter_of
from situgraph.matching.pairing import add_option, astray
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
    plain_pair,
    square,
)
from situgraph.matching.records import record_at
from situgraph.matching.slack import SLACK, wrapped
from situgraph.matching.tables import FIT, MISSING, MOVED, Floats, Ints, Shorts, Singles, Table

FARTHEST = 6.0  # metres; beyond that it is not measured how near a corner comes
ROUNDED = 1e-3  # metres, and more than single precision and walls not quite parallel take
# Where in a room its cells are looked for, of half its length and width from the middle.
WITHIN = tuple(product((0.75, -0.75, 0.0), repeat=2))
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

    Where two are, one of them.

    ``table`` is that of ``plain_rooms``, ``cells`` and ``corner`` are those of the maps.
    """
    wide, tall = WORDS * int(cells[0]), int(cells[1]) // 2 + 1
    home = np.full(tall * wide * (int(storey.max(initial=0)) + 1), -1, dtype=np.int32)
    room = np.flatnonzero(table[:, CLEAR] > 0)
    level = storey[room] * tall
    row = table[room]
    low, high, c, s = (
        -row[:, SIDE : SIDE + 2],
        row[:, SIDE + 2 : SIDE + 4],
        row[:, COS],
        row[:, SIN],
    )
    for share in WITHIN:  # what is in the middle comes last and stays
        u, v = ((low + high) / 2 + (high - low) / 2 * share).T
        place = row[:, CX : CY + 1] + np.stack([c * u - s * v, s * u + c * v], axis=1)
        cell = np.floor((place - corner[:2]) * (corner[2] / 2)).astype(np.int64)
        column, line = cell.clip(0, (wide - 1, tall - 1)).T  # a large room may reach farther
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
    for k in range(4):
        reach = nearest * (abs(nx) + abs(ny))
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
def sole_room(case, r, storey, yaw, turn, x, y, away):
    """The only prior room that can explain plain room ``r`` at some placements, -1 if not known.

    They turn by ``yaw`` up to ``turn`` more or less, and take its centre up to ``away`` from
    ``(x, y)``, along walls. Of the walls that fit two cross: for another room to do, a corner of it
    would have to come as near as the walls are off, and a residual.
    """
    plan, limits, mine = case.plan, case.limits, case.seen.plain[r]
    a = _home(plan, storey, x, y)
    if a < 0 or math.isnan(mine[BASE]) or limits.sine <= limits.angle:
        return -1
    its = plan.plain[a]
    most = its[CLEAR] - away - limits.fit - SLACK
    if most <= 0.0:
        return -1
    against = yaw - its[BASE] + mine[BASE]
    quarter = round(against / QUARTER)
    # Walls of other rooms that a wall can fit face the same way.
    if abs(against - quarter * QUARTER) + turn + 2 * limits.angle > 1.0:
        return -1
    dx, dy, c, s = x - its[CX], y - its[CY], its[COS], its[SIN]
    u, v = c * dx + s * dy, c * dy - s * dx
    for k in range(4):
        m = (k + quarter) & 3
        t = v if m & 1 else u
        off = mine[SIDE + k] - its[SIDE + m] - (-t if m & 2 else t)
        if abs(off) > most:
            return -1
    return a


@part
def explain_plain(case, spot, r, a, yaw, x, y):
    """Explain plain room ``r`` by plain room ``a``: each plane has one counterpart at most.

    Its option and its planes are those that ``explain`` gives it. False where more than one plane
    is missing or none that fit cross: then it takes other choices.
    """
    limits, content = case.limits, case.content
    if not plain_pair(case, r, a) or len(content.room_need) + len(content.row_need) > 0:
        return False
    mine, its, row, state = case.seen.plain[r], case.plan.plain[a], spot.row, spot.state
    bend, offset, least = spot.bend, spot.offset, limits.missing
    planned, angle, distance = case.plan.row, case.seen.angle, case.seen.distance
    quarter, score = round((yaw + mine[BASE] - its[BASE]) / QUARTER), 0.0
    missing, along, across = 0, 0, 0
    for k in range(4):
        m = (k + quarter) & 3
        if math.isnan(mine[SIDE + k]):
            continue
        i, value = int(mine[ROW + k]), -math.inf
        if not math.isnan(its[SIDE + m]):
            j = int(its[ROW + m])
            turn = wrapped(angle[i] + yaw - planned[j, 3])
            off = distance[i] - (planned[j, 0] * x + planned[j, 1] * y + planned[j, 2])
            bend[i], offset[i], row[i] = turn, off, j
            value, state[i] = _value(limits, turn, off)
        if value < least:
            value, row[i], state[i] = least, -1, MISSING
            missing += 1
        elif state[i] != FIT:
            if case.seen.strict[r]:
                return False
        elif k & 1:
            across += 1
        else:
            along += 1
        score += value
    if missing > 1 or (missing == 1 and case.seen.strict[r]) or along == 0 or across == 0:
        return False
    add_option(case, r, a, score - astray(case, a, x, y))
    return True


@part
def _value(limits, bend, off):
    """What a plane with these residuals says as a counterpart, and its state."""
    if abs(bend) > limits.angle + SLACK or abs(off) - SLACK > limits.moved:
        return -math.inf, MISSING
    tilt = bend * bend * limits.angle_weight
    if abs(off) - SLACK > limits.fit:
        return limits.moved_base - tilt, MOVED
    return limits.fit_peak - off * off * limits.plane_weight - tilt, FIT
