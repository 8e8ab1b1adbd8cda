"""Prior rooms found by their corners: a hash of cells, each corner entered wherever it may matter.

A room that explains another shares a corner with it, up to the tolerances. So each corner (a
crossing of two planes of a room that are not parallel, adjacent or not) is entered in every cell
within reach, and one look into one cell finds all rooms in question.
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math

import numpy as np

from situgraph.matching.compiled import entry, kernel

NEAR_CELL, NEAR_REACH = 1.0, 1.5
FAR_CELL, FAR_REACH = 4.0, 6.0
SECTORS = 16  # directions of a corner's first plane
ROUNDING = math.radians(0.5)
MOST_CORNERS = 600  # of one room; rooms with more are tried everywhere


@kernel
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


@kernel
def sector_of(angle):
    """The sector of a direction."""
    return math.floor(angle / (2 * math.pi) * SECTORS) % SECTORS


@kernel
def corners_of(first, row, a, least_sine, out):
    """Crossings of room ``a``'s planes into ``out`` (k, 3): x, y, direction of the first plane."""
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


@entry
def enter_corners(first, row, storey, cell, reach, slack, least_sine, bits, start, room, tag):
    """Enter all corners; with empty ``room`` only count them (into ``start[bucket + 1]``).

    ``start`` must hold counts, then, for the second pass, where each bucket begins.
    """
    mask = (1 << bits) - 1
    found = np.empty((MOST_CORNERS, 3))
    fill = len(room) > 0
    for a in range(len(storey)):
        count = corners_of(first, row, a, least_sine, found)
        if count > MOST_CORNERS:
            continue
        for c in range(count):
            low = sector_of(found[c, 2] - slack)
            high = sector_of(found[c, 2] + slack)
            x0 = math.floor((found[c, 0] - reach) / cell)
            x1 = math.floor((found[c, 0] + reach) / cell)
            y0 = math.floor((found[c, 1] - reach) / cell)
            y1 = math.floor((found[c, 1] + reach) / cell)
            for s in range((high - low) % SECTORS + 1):
                for ix in range(x0, x1 + 1):
                    for iy in range(y0, y1 + 1):
                        h = bucket(storey[a], (low + s) % SECTORS, ix, iy)
                        b = h & mask
                        if fill:
                            room[start[b]] = a
                            tag[start[b]] = (h >> 24) & 0xFFFF
                            start[b] += 1
                        else:
                            start[b + 1] += 1


def corner_table(first, row, storey, cell, reach, config):
    """Buckets of corners: ``start`` (2^bits + 1,), rooms and tags."""
    slack = 2 * config.angle_tolerance + ROUNDING
    least = 0.95 * math.sin(max(math.asin(config.parallel_sine) - 2 * config.angle_tolerance, 0.01))
    corners = np.diff(first) ** 2 / 4
    cells = (2 * reach / cell + 1) ** 2 * 2
    bits = int(np.clip(math.ceil(math.log2(max(corners.sum() * cells, 1))), 6, 24))
    start = np.zeros((1 << bits) + 1, dtype=np.int64)
    nothing = np.empty(0, dtype=np.int32)
    enter_corners(first, row, storey, cell, reach, slack, least, bits, start, nothing, nothing)
    np.cumsum(start, out=start)
    room = np.empty(start[-1], dtype=np.int32)
    tag = np.empty(start[-1], dtype=np.int32)
    filled = start.copy()
    enter_corners(first, row, storey, cell, reach, slack, least, bits, filled, room, tag)
    return start, room, tag
