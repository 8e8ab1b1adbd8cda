"""Surfaces as in the paper's figure: averaged over the vertical, splined over the horizontal."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np

from situgraph.geometry.poses import Array
from situgraph.view import palette
from situgraph.view.charts import Row, color_of, column, groups
from situgraph.view.lettering import number, plain

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_BINS = 6  # along an axis that is not made of a few whole numbers
_FINE = 28  # samples of the spline along each axis
_PANEL = (3.6, 3.1)  # inch
_HEAD = 1.0  # inch


class Surface(msgspec.Struct, frozen=True):
    """What a row of panels shows: ``z`` over ``x`` and ``y``, by keys of the rows and names."""

    x: str
    y: str
    z: str
    x_name: str
    y_name: str
    z_name: str
    log_z: bool = False


def draw_surfaces(
    rows: Sequence[Row], surfaces: Sequence[Surface], series: str, columns: str, *, title: str
) -> Figure:
    """A row of panels for each surface, a column for each value of ``columns``.

    In a panel each value of ``series`` (the semantics, say) is one surface: the mean of ``z`` over
    all rows of the same ``x`` and ``y`` (binned where they are continuous; the mean of logarithms
    with ``log_z``), between them a cubic spline over the triangulated means.
    """
    from matplotlib.figure import Figure

    kinds = groups(rows, columns)
    names = list(groups(rows, series))
    width, height = _PANEL[0] * len(kinds) + 0.3, _PANEL[1] * len(surfaces) + _HEAD
    figure = Figure(figsize=(width, height), facecolor=palette.PAPER)
    _head(figure, title, f"means of {number(len(rows))} runs", names)
    for i, surface in enumerate(surfaces):
        parts = [p for group in kinds.values() for p in groups(group, series).values()]
        limits = _limits(parts, surface)
        for j, (kind, group) in enumerate(kinds.items()):
            place = (
                (_PANEL[0] * j + 0.1) / width,
                (height - _HEAD - _PANEL[1] * (i + 1)) / height,
                (_PANEL[0] - 0.1) / width,
                (_PANEL[1] - 0.05) / height,
            )
            axes = figure.add_axes(place, projection="3d")
            for name, part in groups(group, series).items():
                _surface(axes, part, surface, color_of(name, names.index(name)))
            _dress(axes, surface, limits)
            if i == 0:
                figure.text(
                    place[0] + 0.5 * place[2], 1.0 - 0.88 / height, plain(kind, 40), ha="center",
                    fontsize=10.0, color=palette.INK, fontweight="bold", parse_math=False,
                )  # fmt: skip
    return figure


def averaged(rows: Sequence[Row], surface: Surface) -> tuple[Array, Array, Array]:
    """The places (n,), (n,) of a surface's cells and the mean of ``z`` in each (n,)."""
    x, y, z = (column(rows, key) for key in (surface.x, surface.y, surface.z))
    good = np.isfinite(x) & np.isfinite(y) & np.isfinite(z) & ((z > 0.0) | (not surface.log_z))
    x, y, z = _binned(x[good]), _binned(y[good]), z[good]
    if surface.log_z:
        z = np.log10(z)
    cells, index = np.unique(np.stack([x, y], axis=1), axis=0, return_inverse=True)
    sums = np.bincount(index.ravel(), weights=z, minlength=len(cells))
    counts = np.bincount(index.ravel(), minlength=len(cells))
    return cells[:, 0], cells[:, 1], sums / np.maximum(counts, 1)


def _binned(values: Array) -> Array:
    """Values moved to the middles of bins, unless they are few different ones."""
    if np.unique(values).size <= 2 * _BINS:
        return values
    edges = np.linspace(values.min(), values.max(), _BINS + 1)
    place = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, _BINS - 1)
    middles: Array = 0.5 * (edges[place] + edges[place + 1])
    return middles


def _surface(axes: Any, rows: Sequence[Row], surface: Surface, color: str) -> None:
    from scipy.interpolate import CloughTocher2DInterpolator
    from scipy.spatial import QhullError

    x, y, z = averaged(rows, surface)
    if not len(x):
        return
    axes.scatter(x, y, z, s=5.0, color=color, linewidths=0.0, depthshade=False)
    try:
        spline = CloughTocher2DInterpolator(np.stack([x, y], axis=1), z, rescale=True)
    except (QhullError, ValueError):  # all cells on one line: the points say it
        return
    fine_x, fine_y = np.meshgrid(
        np.linspace(x.min(), x.max(), _FINE), np.linspace(y.min(), y.max(), _FINE)
    )
    height = np.clip(spline(fine_x, fine_y), z.min(), z.max())
    axes.plot_surface(
        fine_x, fine_y, height, color=color, alpha=0.5, linewidth=0.15, edgecolor=color,
        rstride=1, cstride=1, shade=False,
    )  # fmt: skip


def _limits(parts: Sequence[Sequence[Row]], surface: Surface) -> tuple[float, float]:
    """The limits of z that all panels of a row share."""
    z = np.concatenate([averaged(part, surface)[2] for part in parts] or [np.zeros(0)])
    if not len(z):
        return 0.0, 1.0
    low = float(z.min()) if surface.log_z else min(0.0, float(z.min()))
    return low, max(float(z.max()), low + 1e-9)


def _dress(axes: Any, surface: Surface, limits: tuple[float, float]) -> None:
    quiet = {"fontsize": 7.5, "color": palette.MUTED, "labelpad": -4.0, "parse_math": False}
    axes.set_xlabel(plain(surface.x_name), **quiet)
    axes.set_ylabel(plain(surface.y_name), **quiet)
    axes.set_zlabel(plain(surface.z_name), **quiet)
    axes.tick_params(labelsize=6.5, colors=palette.MUTED, pad=-2.0)
    axes.set_facecolor(palette.PAPER)
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        axis.pane.set_visible(False)
        axis.line.set_color(palette.HAIRLINE)
        axis._axinfo["grid"].update(color=palette.HAIRLINE, linewidth=0.4)
    axes.view_init(elev=24.0, azim=-128.0)
    axes.set_box_aspect((1.0, 1.0, 0.72), zoom=0.92)
    if limits[1] > limits[0]:
        axes.set_zlim(*limits)
    if surface.log_z:
        powers = np.arange(np.floor(limits[0]), np.ceil(limits[1]) + 1.0)
        ticks = [p for p in powers if limits[0] - 0.2 <= p <= limits[1] + 0.2]
        axes.set_zticks(ticks, labels=[f"{10.0**p:g}" for p in ticks])


def _head(figure: Figure, title: str, subtitle: str, names: Sequence[str]) -> None:
    width, height = figure.get_size_inches()
    for text, y, size, color in (
        (title, 0.34, 14.0, palette.INK),
        (subtitle, 0.6, 8.5, palette.MUTED),
    ):
        figure.text(0.35 / width, 1.0 - y / height, plain(text, 160), fontsize=size, color=color,
                    va="center", parse_math=False)  # fmt: skip
    for i, name in enumerate(reversed(names)):
        figure.text(
            1.0 - 0.35 / width, 1.0 - (0.34 + 0.2 * i) / height, f"● {plain(name, 30)}",
            fontsize=9.0, color=color_of(name, len(names) - 1 - i), ha="right", va="center",
            parse_math=False,
        )  # fmt: skip
