"""A key plan in the corner of a page: where in the building the large drawing is."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from situgraph.view import palette
from situgraph.view.floors import Floor
from situgraph.view.marginalia import write
from situgraph.view.pen import fill_polygons
from situgraph.view.sheet import MARGIN, Bounds, Sheet, add_axes

CORNER = 2.0  # inch, to leave free for it
_WIDE, _TALL = 1.8, 0.95  # inch
_SEPARABLE = 400  # rooms; more are drawn without gaps
_NEARLY_ALL = 0.7  # a drawing that shows so much of the storey needs no key plan


def wants_key_plan(floor: Floor, frames: Sequence[tuple[str, Bounds]]) -> bool:
    """Whether the panels show only a small part of the storey."""
    points = floor.points()
    if not len(points):
        return False
    low, high = points.min(axis=0), points.max(axis=0)
    shown = max((_overlap(box, (*low, *high)) for _, box in frames), default=np.inf)
    return bool(shown < _NEARLY_ALL * np.prod(high - low))


def draw_key_plan(
    page: Sheet, floor: Floor, frames: Sequence[tuple[str, Bounds]], color: str
) -> None:
    """Draw the storey small, if it is wanted, with a frame and its number where each panel is."""
    from matplotlib.patches import Rectangle

    if not wants_key_plan(floor, frames):
        return
    points = floor.points()
    (x0, y0), (x1, y1) = points.min(axis=0).tolist(), points.max(axis=0).tolist()
    width, height = page.figure.get_size_inches()
    scale = min(_WIDE / (x1 - x0), _TALL / (y1 - y0))
    w, h = (x1 - x0) * scale, (y1 - y0) * scale
    box = (width - MARGIN - w, height - MARGIN - h, w, h)
    axes = add_axes(page.figure, box, (x0, y0, x1, y1))
    polygons = [s.outline.polygon for s in floor.rooms if s.outline is not None]
    gaps = 0.2 if len(polygons) <= _SEPARABLE else 0.0
    fill_polygons(axes, polygons, palette.HAIRLINE, 1.0, palette.PAPER, gaps)
    for name, (a, b, c, d) in frames:
        for fill, edge, alpha in ((color, "none", 0.25), ("none", color, 1.0)):
            axes.add_patch(
                Rectangle(
                    (a, b), c - a, d - b, facecolor=fill, edgecolor=edge, alpha=alpha,
                    linewidth=1.0, zorder=2.0,
                )
            )  # fmt: skip
        write(axes, 0.5 * (a + c), 0.5 * (b + d), name, 6.5, zorder=4.0, ha="center")


def _overlap(a: Bounds, b: Bounds) -> float:
    low, high = np.maximum(a[:2], b[:2]), np.minimum(a[2:], b[2:])
    return float(np.prod(np.maximum(high - low, 0.0)))
