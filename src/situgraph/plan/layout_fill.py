"""Greedy filling of a grid of cells with rectangles, the paper's way to random rooms."""

from __future__ import annotations

import numpy as np

from situgraph.geometry.poses import Array
from situgraph.plan.contacts import Index

Shapes = tuple[tuple[int, int], ...]

# Columns x rows of the rectangles tried, two to four cells each (FACTS, 'Its synthetic generator').
SMALL: Shapes = ((1, 2), (2, 1), (1, 3), (3, 1), (2, 2))
# Big enough to cut a room out of one corner.
LARGE: Shapes = ((2, 2), (2, 3), (3, 2), (2, 2), (1, 2))


def fill_cells(rooms: int, columns: int, rng: np.random.Generator, shapes: Shapes) -> Index:
    """``rooms`` rectangles (n, 4) of cells ``column row column row``, first inclusive, last not.

    Row by row, each free cell becomes the corner of a random one of ``shapes`` that still fits;
    one of them must be a single column wide. The first row is always filled to both ends,
    so the outline is straight there.
    """
    boxes = np.empty((rooms, 4), dtype=np.int64)
    draws = rng.permuted(np.tile(np.arange(len(shapes)), (rooms, 1)), axis=1).tolist()
    # height[c] is the first free row of column c: rectangles only ever stack up.
    height = [0] * columns
    row, column = 0, 0
    for i in range(rooms):
        while height[column] > row:
            column += 1
            if column == columns:
                column, row = 0, row + 1
        width, depth = _first_fit(height, column, row, [shapes[k] for k in draws[i]])
        boxes[i] = (column, row, column + width, row + depth)
        for c in range(column, column + width):
            height[c] = row + depth
        column += width
        if column == columns:
            column, row = 0, row + 1
    return boxes


def _first_fit(
    height: list[int], column: int, row: int, order: list[tuple[int, int]]
) -> tuple[int, int]:
    free = 1
    while free < 3 and column + free < len(height) and height[column + free] <= row:
        free += 1
    return next(shape for shape in order if shape[0] <= free)


def grid_lines(count: int, low: float, high: float, rng: np.random.Generator) -> Array:
    """``count + 1`` coordinates from 0 upwards, spaced by U(low, high) metres."""
    return np.concatenate([[0.0], np.cumsum(rng.uniform(low, high, count))])
