"""The storeys of a building one above the other, seen from a corner."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from situgraph.geometry.poses import Array
from situgraph.view import palette
from situgraph.view.floors import Floor
from situgraph.view.lettering import plain
from situgraph.view.marginalia import write
from situgraph.view.pen import fill_polygons, fill_rings, strokes
from situgraph.view.sheet import Bounds, Sheet, add_axes

_TURN = math.radians(-28.0)  # of the plan, before it is tilted
_TILT = 0.5  # how much of the depth is left
_APART = 0.46  # of a storey's drawn depth, between storeys
_LABEL = 1.05  # inch, beside the stack


def draw_stack(
    page: Sheet, box: Bounds, floors: Sequence[Floor], colors: Mapping[str, str] | None = None
) -> None:
    """Draw the storeys in ``box`` (x, y, width, height in inches), the lowest at the bottom.

    ``colors`` tints rooms by id.
    """
    flat = [_tilted(f.points()) for f in floors if len(f.points())]
    if not flat:
        return
    low = np.min([p.min(axis=0) for p in flat], axis=0)
    high = np.max([p.max(axis=0) for p in flat], axis=0)
    step = _APART * float(high[1] - low[1])
    size = high - low + np.array([0.0, step * (len(floors) - 1)])
    x, y, w, h = box
    scale = min((w - _LABEL) / size[0], h / size[1])
    place = (x + 0.5 * (w - _LABEL - size[0] * scale), y + 0.5 * (h - size[1] * scale))
    axes = add_axes(
        page.figure,
        (*place, size[0] * scale, size[1] * scale),
        (low[0], low[1], high[0], low[1] + size[1]),
    )
    for index, floor in enumerate(floors):
        lift, order = np.array([0.0, index * step]), 10.0 * index
        rooms = [s for s in floor.rooms if s.outline is not None]
        shapes = [_tilted(s.outline.polygon) + lift for s in rooms if s.outline is not None]
        fill_polygons(axes, shapes, palette.FLOOR, order, palette.FLOOR_EDGE, 0.4)
        tinted = [(p, (colors or {}).get(s.id)) for s, p in zip(rooms, shapes)]
        known = [(p, c) for p, c in tinted if c is not None]
        fill_polygons(axes, [p for p, _ in known], [c for _, c in known], order + 1.0, alpha=0.6)
        for walls, color in (
            (floor.walls.one_face, palette.WALL_ONE),
            (floor.walls.solid, palette.WALL),
        ):
            rings = [tuple(_tilted(r) + lift for r in rings) for rings in walls]
            fill_rings(axes, rings, color, order + 2.0)
        edges = [_tilted(edge) + lift for edge in floor.walls.edges]
        strokes(axes, edges, palette.WALL, 0.4, order + 2.5)
        if len(floor.path):
            strokes(axes, [_tilted(floor.path) + lift], palette.PATH, 1.0, order + 3.0)
        middle = place[1] + (index * step + 0.5 * (high[1] - low[1])) * scale
        label = plain(floor.name, 18)
        write(page.page, place[0] + size[0] * scale + 0.08, middle, label, 7.5, palette.MUTED)


def _tilted(points: Array) -> Array:
    """Plan points (n, 2) as seen from above a corner."""
    c, s = math.cos(_TURN), math.sin(_TURN)
    turned = points @ np.array([[c, s * _TILT], [-s, c * _TILT]])
    return np.asarray(turned, dtype=float)
