"""The common look of charts: a quiet frame, a title that says what is shown, room to breathe."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from situgraph.geometry.poses import Array
from situgraph.view import palette
from situgraph.view.lettering import plain, width
from situgraph.view.marginalia import write

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Row = Mapping[str, Any]

_LEFT, _RIGHT, _TOP, _BOTTOM = 0.85, 0.35, 1.05, 0.62  # inch, around a panel
_GAP = 0.55  # inch, between panels
_TEXT = 8.5  # point
# As in the paper's figure: geometry alone is orange, with semantics blue.
_POLICIES = {
    "none": palette.SERIES[1],
    "containment": palette.SERIES[2],
    "likelihood": palette.SERIES[0],
}


def chart(
    title: str, subtitle: str, panels: int = 1, size: tuple[float, float] = (6.4, 3.6),
    columns: int | None = None,
) -> tuple[Figure, list[Axes]]:  # fmt: skip
    """A figure with a title and axes of ``size`` inches each."""
    from matplotlib.figure import Figure

    across = columns or min(panels, 3)
    down = math.ceil(panels / across)
    w, h = size
    step_x, step_y = w + _LEFT + _GAP - 0.3, h + _BOTTOM + _GAP
    page = (_LEFT + w + (across - 1) * step_x + _RIGHT, _TOP + h + (down - 1) * step_y + _BOTTOM)
    figure = Figure(figsize=page, facecolor=palette.PAPER)
    axes = []
    for index in range(panels):
        row, column = divmod(index, across)
        x, y = _LEFT + column * step_x, page[1] - _TOP - h - row * step_y
        axes.append(figure.add_axes((x / page[0], y / page[1], w / page[0], h / page[1])))
        _quiet(axes[-1])
    for text, y, points, color in (
        (title, 0.36, 14.0, palette.INK),
        (subtitle, 0.64, _TEXT, palette.MUTED),
    ):
        figure.text(
            0.35 / page[0], 1.0 - y / page[1], plain(text, 160), fontsize=points, color=color,
            parse_math=False, va="center",
        )  # fmt: skip
    return figure, axes


def _quiet(axes: Axes) -> None:
    axes.set_facecolor(palette.PAPER)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    for side in ("left", "bottom"):
        axes.spines[side].set_color(palette.HAIRLINE)
    axes.tick_params(colors=palette.MUTED, labelsize=8.0, length=3.0, which="both")
    axes.grid(color=palette.HAIRLINE, linewidth=0.5, axis="y")
    axes.set_axisbelow(True)


def name_axes(figure: Figure, axes: Axes, x: str, y: str) -> None:
    """Say what the axes are; ``y`` stands upright above its axis."""
    axes.set_xlabel(plain(x), fontsize=_TEXT, color=palette.MUTED, parse_math=False)
    place, (w, h) = axes.get_position(), figure.get_size_inches()
    figure.text(
        place.x0 - 0.45 / w, place.y1 + 0.1 / h, plain(y), fontsize=_TEXT, color=palette.MUTED,
        va="bottom", parse_math=False,
    )  # fmt: skip


def name_series(figure: Figure, names: Iterable[tuple[str, str]]) -> None:
    """Names in the colours of their lines, at the upper right of the page."""
    w, h = figure.get_size_inches()
    x = w - 0.35
    for name, color in reversed(list(names)):
        text = plain(name, 40)
        figure.text(
            x / w, 1.0 - 0.36 / h, f"● {text}", fontsize=9.0, color=color, ha="right",
            va="center", parse_math=False,
        )  # fmt: skip
        x -= (width(text, 9.0) + 32.0) / 72.0


def column(rows: Sequence[Row], key: str) -> Array:
    """The numbers under ``key``; NaN where a row has none."""
    found = [row.get(key) for row in rows]
    return np.array([math.nan if v is None else float(v) for v in found], dtype=float)


def groups(rows: Sequence[Row], key: str | None) -> dict[str, list[Row]]:
    """Rows by the value under ``key``, in the order of their first appearance."""
    found: dict[str, list[Row]] = {}
    for row in rows:
        found.setdefault("" if key is None else str(row.get(key, "")), []).append(row)
    return found


def color_of(name: str, index: int) -> str:
    """The colour of a series: the policies of semantics have theirs, others go by their index."""
    return _POLICIES.get(name) or palette.SERIES[index % len(palette.SERIES)]


def nothing(axes: Axes) -> None:
    """Say that there is no data."""
    write(axes, 0.5, 0.5, "no rows", 9.0, palette.MUTED, ha="center", transform=axes.transAxes)
