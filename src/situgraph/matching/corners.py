"""Prior rooms found by their corners: a hash of cells, each corner entered wherever it may matter.

A room that explains another shares a corner with it, up to the tolerances. So each corner (a
crossing of two planes of a room that are not parallel, adjacent or not) is entered in every cell
within reach, and one look into one cell finds all rooms in question.
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from situgraph.matching.blocks import Block
from situgraph.matching.compiled import entry, part
from situgraph.matching.config import MatchingConfig
from situgraph.matching.records import record_at
from situgraph.matching.tables import Floats, Ints, Short, Table

NEAR_CELL, NEAR_REACH = 1.0, 1.5
FAR_CELL, FAR_REACH = 4.0, 6.0
SECTORS = 16  # directions of a corner's first plane
ROUNDING = math.radians(0.5)
MOST_CORNERS = 600  # of one room; rooms with more are tried everywhere


@part
def bucket(storey, sector, ix, iy):
    """A well mixed number of a cell, below 2^40."""
    h = (
        np.uint64(ix + 1048576) * np.uint64(0x9E3779B97F4A7C15)
        + np.uint64(iy + 1048576) * np.uint64(0xC2B2AE3D27D4EB4F)
        + np.uint64(storey * SECTORS + sector + 1) * np.uint64(0x165667B19E3779F9)
    )
    h ^= h >> np.uint64(29)
    h *= np.uint64(0xBF58476D1CE4E5B9)
    return np.int64(h >> np.uint64(24))


@part
def sector_of(angle):
    """The sector of a direction."""
    return math.floor(angle / (2 * math.pi) * SECTORS) % SECTORS


@part
def corners_of(first, row, a, least_sine, out):
    """Crossings of room ``a``'s planes into ``out`` (k, 3): x, y, direction of the first plane.

    Returns their number, even where there is no room for all.
    """
    count = 0
    for i in range(first[a], first[a + 1]):
        for j in range(first[a], first[a + 1]):
            cross = row[i, 0] * row[j, 1] - row[i, 1] * row[j, 0]
            if cross < least_sine:
                continue
            if count < len(out):
                out[count, 0] = (row[i, 1] * row[j, 2] - row[j, 1] * row[i, 2]) / cross
                out[count, 1] = (row[j, 0] * row[i, 2] - row[i, 0] * row[j, 2]) / cross
                out[count, 2] = row[i, 3]
            count += 1
    return count


class Entering(NamedTuple):
    """The rooms to be entered, and the table."""

    first: Ints  # (M + 1,)
    row: Table  # (Q, 4)
    storey: Ints  # (M,)
    start: Ints  # (2^bits + 1,) counts, then, for the second pass, where each bucket begins
    entry: Short  # (k,) corners; empty when they are only counted
    tag: Short
    begin: Ints  # (M + 1,) each room's place among all corners
    place: Table  # (C, 2) of each corner
    owner: Ints  # (C,) its room
    corner: Table  # (MOST_CORNERS, 3)
    cell: float
    reach: float
    slack: float
    sine: float
    bits: int


@entry
def enter_corners(place):
    """Enter all corners of an ``Entering``; with empty ``entry`` only count them.

    Into ``start[bucket + 1]``.
    """
    table = record_at(place, Entering)
    for a in range(len(table.storey)):
        count = corners_of(table.first, table.row, a, table.sine, table.corner)
        if count <= MOST_CORNERS:
            for c in range(count):
                k = table.begin[a] + c
                table.place[k, 0], table.place[k, 1] = table.corner[c, 0], table.corner[c, 1]
                table.owner[k] = a
                _enter(table, a, k, table.corner[c])


@part
def _enter(table, a, k, corner):
    start, cell, reach = table.start, table.cell, table.reach
    mask = (1 << table.bits) - 1
    low = sector_of(corner[2] - table.slack)
    sectors = (sector_of(corner[2] + table.slack) - low) % SECTORS + 1
    y0, y1 = math.floor((corner[1] - reach) / cell), math.floor((corner[1] + reach) / cell)
    for s in range(sectors):
        for ix in range(
            math.floor((corner[0] - reach) / cell), math.floor((corner[0] + reach) / cell) + 1
        ):
            for iy in range(y0, y1 + 1):
                h = bucket(table.storey[a], (low + s) % SECTORS, ix, iy)
                b = h & mask
                if len(table.entry) == 0:
                    start[b + 1] += 1
                else:
                    table.entry[start[b]] = k
                    table.tag[start[b]] = (h >> 24) & 0xFFFF
                    start[b] += 1


class Corners(NamedTuple):
    """All corners of the rooms that have not too many."""

    begin: Ints  # (M + 1,) each room's, with room to spare
    place: Floats  # (C, 2)
    owner: Ints  # (C,)


def room_for_corners(first: Ints) -> Corners:
    """Room for the corners of all rooms, which the first table fills."""
    planes = np.diff(first)
    most = np.minimum(planes * (planes - 1) // 2, MOST_CORNERS)
    begin = np.concatenate([[0], np.cumsum(most)]).astype(np.int64)
    return Corners(begin, np.zeros((begin[-1], 2)), np.zeros(begin[-1], dtype=np.int64))


def corner_table(
    first: Ints,
    row: Floats,
    storey: Ints,
    corners: Corners,
    cell: float,
    reach: float,
    config: MatchingConfig,
) -> tuple[Ints, Any, Any]:
    """Buckets of corners: ``start`` (2^bits + 1,), corners and tags; fills ``corners``."""
    slack = 2 * config.angle_tolerance + ROUNDING
    least = 0.95 * math.sin(max(math.asin(config.parallel_sine) - 2 * config.angle_tolerance, 0.01))
    cells = (2 * reach / cell + 1) ** 2 * 2
    number = (np.diff(first) ** 2 / 4).sum()
    bits = int(np.clip(math.ceil(math.log2(max(number * cells, 1))), 6, 24))
    start = np.zeros((1 << bits) + 1, dtype=np.int64)
    entry = tag = np.empty(0, dtype=np.int32)
    work = np.empty((MOST_CORNERS, 3))
    tables = (first, row, storey)
    sizes = (*corners, work, cell, reach, slack, least, bits)
    enter_corners(Block.of(Entering, (*tables, start, entry, tag, *sizes)).place)
    np.cumsum(start, out=start)
    entry, tag = (np.empty(int(start[-1]), dtype=np.int32) for _ in range(2))
    at = start.copy()
    enter_corners(Block.of(Entering, (*tables, at, entry, tag, *sizes)).place)
    return start, entry, tag
