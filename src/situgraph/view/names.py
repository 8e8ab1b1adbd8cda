"""Room names, set where they fit and left out where they would not be read."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from situgraph.geometry.poses import Array
from situgraph.view import palette
from situgraph.view.config import ViewConfig
from situgraph.view.floors import Shape
from situgraph.view.lettering import fitted, plain

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_LARGEST = 8.0  # point
_USED = 0.9  # of the space across a room


def draw_names(
    axes: Axes, shapes: Sequence[Shape], scale: float, config: ViewConfig,
    color: str = palette.INK, below: float = 0.0,
) -> int:  # fmt: skip
    """Write the names of rooms where they fit; returns how many had no space.

    ``below`` (points) sets them that much lower, off what is drawn in the middle of rooms, where
    there is space for it.
    """
    left_out = 0
    for shape, (x, y), (across, up) in zip(shapes, *_spaces(shapes, scale, config)):
        name = plain(shape.name, 60)
        fit = fitted(name, _USED * across, _USED * up, config.smallest_text, _LARGEST)
        if fit is None:
            left_out += 1
            continue
        text, size = fit
        lower = below / scale if up > 4.0 * below else 0.0
        axes.text(
            x, y - lower, text, fontsize=round(size, 1), color=color, ha="center", va="center",
            zorder=6.0, parse_math=False, linespacing=1.15, clip_on=True,
            bbox={"facecolor": palette.FLOOR, "edgecolor": "none", "alpha": 0.75, "pad": 0.6},
        )  # fmt: skip
    return left_out


def _spaces(shapes: Sequence[Shape], scale: float, config: ViewConfig) -> tuple[Array, Array]:
    """Where each name stands (m) and the space across and up (points) there."""
    import shapely

    at = np.array([s.center for s in shapes], dtype=float).reshape(-1, 2)
    space = np.full((len(shapes), 2), 40.0)
    for i, shape in enumerate(shapes):
        if shape.outline is None:  # the name stands below the dot
            at[i, 1] -= 12.0 / scale
            continue
        size = np.ptp(shape.outline.polygon, axis=0) * scale
        space[i] = size
        if size[0] < 2.0 * config.smallest_text or size[1] < 1.2 * config.smallest_text:
            continue
        room = shapely.polygons(shape.outline.polygon)
        if not room.is_valid:
            continue
        at[i] = _place(room)
        space[i] = [_chord(room, at[i], axis) * scale for axis in (0, 1)]
    return at, space


def _place(room: object) -> Array:
    """The centroid where it lies well inside, else the middle of the largest circle."""
    import shapely

    centroid = shapely.centroid(room)
    inside = shapely.contains(room, centroid)
    depth = shapely.distance(centroid, shapely.boundary(room)) if inside else 0.0
    if depth > 0.3 * np.sqrt(shapely.area(room)):
        return shapely.get_coordinates(centroid)[0]  # type: ignore[no-any-return]
    circle = shapely.maximum_inscribed_circle(room, tolerance=0.1)
    middle = shapely.get_coordinates(circle)[0]
    near = inside and depth > 0.7 * shapely.length(circle)
    return shapely.get_coordinates(centroid)[0] if near else middle  # type: ignore[no-any-return]


def _chord(room: object, at: Array, axis: int) -> float:
    """How far the room reaches to the nearer side of a point along x or y, twice."""
    import shapely

    reach = np.zeros(2)
    reach[axis] = 1e4
    cut = shapely.intersection(room, shapely.linestrings([at - reach, at + reach]))
    for part in shapely.get_parts(cut):
        along = shapely.get_coordinates(part)[:, axis]
        if along.min() <= at[axis] <= along.max():
            return 2.0 * float(min(at[axis] - along.min(), along.max() - at[axis]))
    return 0.0
