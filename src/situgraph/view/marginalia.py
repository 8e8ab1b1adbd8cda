"""What stands around a drawing: legend, scale bar, north arrow, letters. Places are in inches."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import msgspec

from situgraph.view import palette
from situgraph.view.lettering import width

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LEGEND_LINE = 0.24  # inch
NOTE_LINE = 0.17  # inch
_TEXT = 8.5  # point
_SWATCH = 0.34  # inch
_POINTS = 72.0  # to the inch


class Key(msgspec.Struct, frozen=True):
    """An entry of the legend: what it looks like and what it means."""

    text: str
    patch: str | None = None
    line: str | None = None
    marker: str | None = None
    edge: str | None = None
    dashes: tuple[float, float] | None = None
    hatch: str | None = None
    alpha: float = 1.0
    width: float = 1.4


def write(
    axes: Axes, x: float, y: float, text: str, size: float, color: str = palette.INK,
    **options: object,
) -> None:  # fmt: skip
    """Text that is never read as mathematics, whatever a model calls a room."""
    options.setdefault("va", "center")
    axes.text(x, y, text, fontsize=size, color=color, parse_math=False, **options)  # type: ignore[arg-type]


def flow(keys: Sequence[Key], room: float) -> list[list[tuple[float, Key]]]:
    """Legend entries on lines no longer than ``room``, each with its place on its line."""
    lines: list[list[tuple[float, Key]]] = []
    x = math.inf
    for key in keys:
        length = _SWATCH + width(key.text, _TEXT) / _POINTS + 0.22
        if x + length > room:
            lines.append([])
            x = 0.0
        lines[-1].append((x, key))
        x += length
    return lines


def legend_line(page: Axes, line: Sequence[tuple[float, Key]], x: float, y: float) -> None:
    """One line of a legend."""
    for start, key in line:
        _swatch(page, x + start, y, key)
        write(page, x + start + _SWATCH, y, key.text, _TEXT)


def _swatch(page: Axes, x: float, y: float, key: Key) -> None:
    from matplotlib.patches import Rectangle

    if key.marker is not None:
        page.plot(
            [x + 0.12], [y], marker=key.marker, markersize=5.5, linestyle="none",
            markerfacecolor=key.patch or palette.PAPER, markeredgecolor=key.edge or palette.OBJECT,
            markeredgewidth=0.9,
        )  # fmt: skip
    elif key.patch is not None or key.hatch is not None:
        page.add_patch(
            Rectangle(
                (x, y - 0.06), 0.24, 0.12, facecolor=key.patch or "none", alpha=key.alpha,
                edgecolor=key.edge or "none", hatch=key.hatch, linewidth=0.8,
            )
        )  # fmt: skip
    if key.line is not None:
        style = "-" if key.dashes is None else (0, key.dashes)
        page.plot(
            [x, x + 0.24], [y, y], color=key.line, linewidth=key.width, linestyle=style,
            solid_capstyle="butt",
        )  # fmt: skip


def scale_bar(page: Axes, right: float, y: float, scale: float) -> None:
    """A bar of a round length, about an inch and a half long, in two halves."""
    from matplotlib.patches import Rectangle

    length = round_length(1.6 / scale)
    step = 0.5 * length * scale
    start = right - 2.0 * step - 0.1
    for i, fill in enumerate((palette.INK, palette.PAPER)):
        half = (start + i * step, y)
        page.add_patch(
            Rectangle(half, step, 0.05, facecolor=fill, edgecolor=palette.INK, linewidth=0.7)
        )
    for i, value in enumerate((0.0, 0.5 * length, length)):
        text = f"{value:g} m" if i == 2 else f"{value:g}"
        write(page, start + i * step, y + 0.13, text, 7.0, palette.MUTED, ha="center")


def round_length(wanted: float) -> float:
    """The longest of 1, 2, 5, 10, ... that is no longer than ``wanted``."""
    power = 10.0 ** math.floor(math.log10(wanted))
    return max(f * power for f in (1.0, 2.0, 5.0) if f * power <= wanted * (1.0 + 1e-9))


def north_arrow(page: Axes, x: float, y: float, north: float) -> None:
    """An arrow to true north, ``north`` in radians from the drawing's x."""
    dx, dy = 0.17 * math.cos(north), 0.17 * math.sin(north)
    page.annotate(
        "", (x + dx, y + dy), (x - dx, y - dy),
        arrowprops={"arrowstyle": "-|>", "color": palette.INK, "linewidth": 0.9},
    )  # fmt: skip
    write(page, x + 1.75 * dx, y + 1.75 * dy, "N", 8.0, ha="center")
