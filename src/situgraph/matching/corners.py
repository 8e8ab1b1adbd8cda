"""Prior rooms found by their corners, sorted by direction and cells of the plan.

A room that explains another shares a corner with it, up to the tolerances: a crossing of two planes
of a room that are not parallel, adjacent or not. Cells are as many as corners, about, so both stay
in the processor's cache, and a look at a few metres of the plan reads one row or two.
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from situgraph.matching.blocks import Block
from situgraph.matching.compiled import entry, part
from situgraph.matching.config import MatchingConfig
from situgraph.matching.plain import QUARTER
from situgraph.matching.records import record_at
from situgraph.matching.tables import Floats, Ints, Shorts, Single, Singles, Table

MOST_PLANES = 34  # of a room; those with more have too many corners and are tried everywhere
LEAST_CELL = 1.0  # metres
ROUNDED = 1e-6  # of a length, by which single precision may be off, and more


class Entering(NamedTuple):
    """The rooms whose corners are listed, and the list."""

    first: Ints  # (M + 1,)
    row: Table  # (Q, 4)
    sine: float  # of two planes that cross, at least
    corner: Table  # (C, 4) x, y, direction of the first plane, room; with room to spare
    count: Ints  # type: ignore[assignment]  # (1,)


@entry
def list_corners(place):
    """List all corners of an ``Entering``, the second plane counter-clockwise of the first."""
    table = record_at(place, Entering)
    row, corner, k = table.row, table.corner, 0
    for a in range(len(table.first) - 1):
        if table.first[a + 1] - table.first[a] > MOST_PLANES:
            continue
        for i in range(table.first[a], table.first[a + 1]):
            for j in range(table.first[a], table.first[a + 1]):
                cross = row[i, 0] * row[j, 1] - row[i, 1] * row[j, 0]
                if cross < table.sine:
                    continue
                corner[k, 0] = (row[i, 1] * row[j, 2] - row[j, 1] * row[i, 2]) / cross
                corner[k, 1] = (row[j, 0] * row[i, 2] - row[i, 0] * row[j, 2]) / cross
                corner[k, 2], corner[k, 3] = row[i, 3], a
                k += 1
    table.count[0] = k


class Corners(NamedTuple):
    """The corners of a plan, by storey, quarter of the first plane's direction, and cell."""

    begin: Shorts  # (storeys * 4 * rows * columns + 1,) where each cell's corners begin
    place: Singles  # (C, 2)
    angle: Single  # (C,) direction of the first plane
    room: Shorts  # (C,)
    cells: Ints  # (2,) columns, rows
    origin: Floats  # (4,) x, y in metres, how many cells a metre has; middle of the first quarter


def corners_of(first: Ints, row: Floats, storey: Ints, config: MatchingConfig) -> Corners:
    """The corners of all rooms that have not too many planes."""
    least = 0.95 * math.sin(max(math.asin(config.parallel_sine) - 2 * config.angle_tolerance, 0.01))
    planes = np.diff(first)
    planes = planes[planes <= MOST_PLANES]
    corner, count = np.empty((int((planes * (planes - 1) // 2).sum()), 4)), np.zeros(1, np.int64)
    list_corners(Block.of(Entering, (first, row, least, corner, count)).place)
    corner = corner[: count[0]]
    room, place = corner[:, 3].astype(np.int32), corner[:, :3].astype(np.float32)
    parts = 4 * int(storey.max(initial=0)) + 4
    low = place[:, :2].min(axis=0).astype(float) if len(place) else np.zeros(2)
    size = place[:, :2].max(axis=0) - low if len(place) else np.zeros(2)
    cell = max(LEAST_CELL, math.sqrt(float(np.prod(size)) * parts / max(len(place), 1)))
    cell = max(cell, float(size.sum()) * parts / (len(place) + 1))
    column, line = np.floor((place[:, :2] - low) * (1.0 / cell)).astype(np.int64).T
    wide, tall = int(column.max(initial=0)) + 1, int(line.max(initial=0)) + 1
    base = float(row[0, 3]) if len(row) else 0.0
    quarter = np.rint((place[:, 2].astype(float) - base) / QUARTER).astype(np.int64) & 3
    at = ((4 * storey[room] + quarter) * tall + line) * wide + column
    order = np.argsort(at, kind="stable")
    begin = np.zeros(parts * wide * tall + 1, dtype=np.int32)
    np.cumsum(np.bincount(at, minlength=parts * wide * tall), out=begin[1:])
    cells, origin = np.array([wide, tall]), np.array([*low, 1.0 / cell, base])
    place = place[order]
    return Corners(begin, place[:, :2].copy(), place[:, 2].copy(), room[order], cells, origin)


@part
def cell_of(plan, side, value):
    """The column (``side`` 0) or row (1) of a place, the nearest there is."""
    cell = math.floor((value - plan.corner_origin[side]) * plan.corner_origin[2])
    return min(max(cell, 0), plan.corner_cells[side] - 1)


@part
def quarter_of(plan, angle):
    """The quarter of directions that holds one, not reduced to four."""
    return round((angle - plan.corner_origin[3]) / QUARTER)
