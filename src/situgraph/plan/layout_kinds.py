"""The kinds of floors: each function draws one floor plan with a given number of rooms.

Every floor starts at y = 0 with a straight outline, so that its half turn can stand against it;
``stretch`` makes a floor that many times longer in x than in y than it would be.
"""

from __future__ import annotations

import math

import numpy as np

from situgraph.geometry.poses import Array
from situgraph.plan.floor import Floor, from_boxes, from_outlines
from situgraph.plan.layout_config import LayoutConfig
from situgraph.plan.layout_fill import LARGE, SMALL, Shapes, fill_cells, grid_lines

Rng = np.random.Generator

# Cells a room on average, to choose the number of columns.
_CELLS = 2.5


def random_floor(rooms: int, config: LayoutConfig, rng: Rng, stretch: float = 1.0) -> Floor:
    """Random rectangles: cells of random width and depth, two to four cells a room.

    After the paper's 'Synthetic dataset' (the generator of its reference reasoning_v1).
    """
    boxes = _random_boxes(rooms, SMALL, stretch, config, rng)
    return from_boxes(boxes, _thickness(rooms, config, rng))


def lshaped_floor(rooms: int, config: LayoutConfig, rng: Rng, stretch: float = 1.0) -> Floor:
    """Random rooms of which many big ones are L-shaped, with another room in the notch."""
    boxes = _random_boxes(rooms, LARGE, stretch, config, rng)
    side = np.minimum(boxes[:, 2] - boxes[:, 0], boxes[:, 3] - boxes[:, 1])
    cut = (side > 2.0 * config.cell_min) & (rng.random(rooms) < config.lshaped_share)
    # A cut box makes two rooms; the boxes of the last rows are given up for them.
    made = np.cumsum(1 + cut)
    last = int(np.searchsorted(made, rooms))
    cut[last] &= made[last] == rooms
    outlines: list[Array] = []
    for box, is_cut in zip(boxes[: last + 1], cut, strict=False):
        if is_cut:
            outlines.extend(_cut_corner(box, rng))
        else:
            outlines.append(box[[0, 1, 2, 1, 2, 3, 0, 3]].reshape(4, 2))
    return from_outlines(outlines, _thickness(len(outlines), config, rng))


def modular_floor(rooms: int, config: LayoutConfig, rng: Rng, stretch: float = 1.0) -> Floor:
    """Rows of rooms whose widths and depths are a few multiples of one planning module."""
    return _rows(rooms, stretch, (2, 3, 4), (3, 4), config, rng)


def grid_floor(shape: tuple[int, int], config: LayoutConfig, rng: Rng) -> Floor:
    """Identical rooms, ``shape`` = (columns, rows), all walls of one random thickness."""
    columns, rows = shape
    width, depth = config.grid_room
    c, r = np.meshgrid(np.arange(columns), np.arange(rows))
    corner = np.stack([c.ravel() * width, r.ravel() * depth], axis=1)
    boxes = np.concatenate([corner, corner + np.array([width, depth])], axis=1)
    thickness = rng.uniform(config.thickness_min, config.thickness_max)
    return from_boxes(boxes, np.full(len(boxes), thickness))


def corridor_floor(rooms: int, config: LayoutConfig, rng: Rng, stretch: float = 1.0) -> Floor:
    """Corridors with offices on both sides, side by side along a cross corridor.

    About one room in nine is a corridor.
    """
    corridors = max(1, round(rooms / (9.0 * stretch))) if rooms > 1 else 0
    spine = 1 if corridors > 1 else 0
    offices = rooms - corridors - spine
    per_side = np.full(2 * corridors, offices // max(1, 2 * corridors))
    per_side[: offices - int(per_side.sum())] += 1
    boxes: list[tuple[float, float, float, float]] = []
    y = 0.0
    hall = config.corridor_width
    left = hall if spine else 0.0
    for k in range(corridors):
        south, north = rng.choice((3, 4, 5), 2) * config.module
        low = _along(per_side[2 * k], left, y, float(south), config, rng)
        high = _along(per_side[2 * k + 1], left, y + south + hall, float(north), config, rng)
        end = max([left + 2.0 * config.module] + [b[2] for b in low + high])
        boxes += [(left, y + south, end, y + south + hall), *low, *high]
        y += float(south + hall + north)
    if spine:
        boxes.append((0.0, 0.0, hall, y))
    if not boxes:
        boxes = _along(1, 0.0, 0.0, 4.0 * config.module, config, rng)
    return from_boxes(np.array(boxes), _thickness(rooms, config, rng))


def grid_shape(rooms: int) -> tuple[int, int]:
    """The most nearly square (columns, rows) with exactly ``rooms`` cells."""
    rows = next(r for r in range(math.isqrt(rooms), 0, -1) if rooms % r == 0)
    return rooms // rows, rows


def _random_boxes(
    rooms: int, shapes: Shapes, stretch: float, config: LayoutConfig, rng: Rng
) -> Array:
    aspect = stretch * rng.uniform(0.6, 1.7)
    columns = min(rooms, max(1, round(math.sqrt(_CELLS * rooms * aspect))))
    cells = fill_cells(rooms, columns, rng, shapes)
    x = grid_lines(columns, config.cell_min, config.cell_max, rng)
    y = grid_lines(int(cells[:, 3].max()), config.cell_min, config.cell_max, rng)
    return np.stack([x[cells[:, 0]], y[cells[:, 1]], x[cells[:, 2]], y[cells[:, 3]]], axis=1)


def _thickness(rooms: int, config: LayoutConfig, rng: Rng) -> Array:
    return rng.uniform(config.thickness_min, config.thickness_max, rooms)


def _cut_corner(box: Array, rng: Rng) -> list[Array]:
    """An L-shaped outline and the rectangle cut out of one of its corners."""
    x0, y0, x1, y1 = box
    u, v = rng.uniform(0.4, 0.6, 2)
    xn, yn = x0 + u * (x1 - x0), y0 + v * (y1 - y0)
    around = np.array([(x0, y0), (x1, y0), (x1, yn), (xn, yn), (xn, y1), (x0, y1)])
    notch = np.array([(xn, yn), (x1, yn), (x1, y1), (xn, y1)])
    flip = rng.integers(2, size=2).astype(bool)
    outlines = []
    for outline in (around, notch):
        placed = np.where(flip, box[:2] + box[2:] - outline, outline)
        outlines.append(placed[::-1] if flip.sum() == 1 else placed)
    return outlines


def _rows(
    rooms: int,
    stretch: float,
    widths: tuple[int, ...],
    depths: tuple[int, ...],
    config: LayoutConfig,
    rng: Rng,
) -> Floor:
    per_row = max(1, round(math.sqrt(stretch * rooms * rng.uniform(0.7, 1.6))))
    boxes: list[tuple[float, float, float, float]] = []
    y, length = 0.0, 0.0
    while len(boxes) < rooms:
        depth = float(rng.choice(depths)) * config.module
        steps = rng.choice(widths, per_row) * config.module
        ends = np.cumsum(steps)
        if boxes:
            ends = ends[: max(1, int(np.searchsorted(ends, length + 1e-9, side="right")))]
        else:
            length = float(ends[-1])
        start = 0.0
        for end in ends[: rooms - len(boxes)].tolist():
            boxes.append((start, y, end, y + depth))
            start = end
        y += depth
    return from_boxes(np.array(boxes), _thickness(rooms, config, rng))


def _along(
    count: int, x: float, y: float, depth: float, config: LayoutConfig, rng: Rng
) -> list[tuple[float, float, float, float]]:
    """``count`` offices side by side from (x, y), their widths multiples of half a module."""
    ends = x + np.cumsum(rng.integers(5, 9, count)) * 0.5 * config.module
    starts = np.concatenate([[x], ends])[:-1]
    return [(float(s), y, float(e), y + depth) for s, e in zip(starts, ends, strict=True)]
