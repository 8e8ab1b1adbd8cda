"""A page with panels at one scale: title, captions, legend, scale bar.

Everything outside the panels is placed in inches, so that a drawing's scale is known before it is
drawn and letters can be left out where they would not be read.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import msgspec

from situgraph.view import palette
from situgraph.view.config import ViewConfig
from situgraph.view.lettering import plain, width

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Bounds = tuple[float, float, float, float]

_MARGIN = 0.42  # inch, around the page
_NARROWEST = 7.5  # inch, a page with its title and legend
_GAP = 0.3  # inch, between panels
_CAPTION = 0.34  # inch, above a panel
_TITLE = 18.0  # point
_TEXT = 8.5  # point
_POINTS = 72.0  # to the inch


class Panel(msgspec.Struct, frozen=True):
    """What stands above a panel: its name, and a note beside it."""

    name: str = ""
    note: str = ""
    color: str = palette.INK


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


class Sheet(msgspec.Struct, frozen=True):
    """A figure, its panels' axes (in metres) and their scale."""

    figure: Figure
    panels: tuple[Axes, ...]
    points_per_metre: float
    page: Axes


def sheet(
    title: str,
    subtitle: str,
    panels: Sequence[Panel],
    bounds: Bounds,
    keys: Sequence[Key],
    notes: Sequence[str],
    config: ViewConfig,
    north: float | None = None,
) -> Sheet:
    """An empty page for ``panels`` that all show ``bounds`` (m).

    ``north`` is the direction of true north in the drawing (radians from x), if known.
    """
    from matplotlib.figure import Figure

    x0, y0, x1, y1 = _roomy(bounds)
    rows, columns, scale = _grid(len(panels), x1 - x0, y1 - y0, config.page_width)
    w, h = (x1 - x0) * scale, (y1 - y0) * scale
    across = columns * w + (columns - 1) * _GAP
    breadth = max(min(_NARROWEST, config.page_width), across + 2.0 * _MARGIN)
    lines = _flow(keys, breadth - 2.0 * _MARGIN)
    words = [w for line in subtitle.splitlines() for w in _wrapped(line, breadth)]
    small = [w for note in notes for w in _wrapped(note, breadth * 1.2)]
    top = _MARGIN + 0.36 + 0.19 * len(words) + 0.16
    bottom = _MARGIN + 0.24 * len(lines) + 0.36 + 0.17 * len(small)
    caption = _CAPTION if any(p.name or p.note for p in panels) else 0.0
    height = top + rows * (h + caption) + (rows - 1) * _GAP + bottom
    figure = Figure(figsize=(breadth, height), facecolor=palette.PAPER)
    page = _page(figure, breadth, height)
    _head(page, title, words, height)
    left = 0.5 * (breadth - across)
    axes = []
    for index, panel in enumerate(panels):
        row, column = divmod(index, columns)
        x = left + column * (w + _GAP)
        y = height - top - (row + 1) * (h + caption) - row * _GAP
        axes.append(_axes(figure, (x, y, w, h), (x0, y0, x1, y1), breadth, height))
        _caption(page, panel, x, y + h + 0.1, w)
    _foot(page, lines, small, scale, breadth, north)
    return Sheet(figure, tuple(axes), scale * _POINTS, page)


def _roomy(bounds: Bounds) -> Bounds:
    x0, y0, x1, y1 = bounds
    margin = 0.03 * max(x1 - x0, y1 - y0, 1.0) + 0.3
    return x0 - margin, y0 - margin, x1 + margin, y1 + margin


def _grid(count: int, w: float, h: float, page_width: float) -> tuple[int, int, float]:
    """Rows, columns and inches a metre: the largest scale on a page of bearable height."""
    across = page_width - 2.0 * _MARGIN
    best = (max(count, 1), 1, 0.0)
    for columns in range(1, max(count, 1) + 1):
        rows = math.ceil(count / columns) or 1
        # A page may be as tall as wide; every further row of panels may make it taller.
        tall = page_width * (0.62 + 0.22 * min(rows, 4))
        tall = max(tall - rows * _CAPTION - (rows - 1) * _GAP, 2.0)
        scale = min((across - (columns - 1) * _GAP) / columns / w, tall / rows / h)
        if scale > best[2] * 1.02:
            best = (rows, columns, scale)
    return best


def _page(figure: Figure, width: float, height: float) -> Axes:
    page = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    page.set_axis_off()
    page.set_xlim(0.0, width)
    page.set_ylim(0.0, height)
    return page


def _axes(
    figure: Figure,
    box: tuple[float, float, float, float],
    view: Bounds,
    width: float,
    height: float,
) -> Axes:
    x, y, w, h = box
    axes = figure.add_axes((x / width, y / height, w / width, h / height))
    axes.set_axis_off()
    axes.set_xlim(view[0], view[2])
    axes.set_ylim(view[1], view[3])
    return axes


def write(axes: Axes, x: float, y: float, text: str, size: float, color: str = palette.INK,
          **options: object) -> None:  # fmt: skip
    """Text that is never read as mathematics, whatever a model calls a room."""
    axes.text(x, y, text, fontsize=size, color=color, parse_math=False, **options)  # type: ignore[arg-type]


def _head(page: Axes, title: str, words: Sequence[str], height: float) -> None:
    y = height - _MARGIN - 0.18
    write(page, _MARGIN, y, plain(title, 80), _TITLE, va="center")
    for i, line in enumerate(words):
        write(page, _MARGIN, y - 0.36 - 0.19 * i, line, 9.0, palette.MUTED, va="center")


def _wrapped(line: str, page_width: float) -> list[str]:
    import textwrap

    letters = int((page_width - 2.0 * _MARGIN) * _POINTS / width("n", 9.0) * 1.08)
    return textwrap.wrap(plain(line, 600), letters) or [""]


def _caption(page: Axes, panel: Panel, x: float, y: float, w: float) -> None:
    write(page, x, y, plain(panel.name, 60), 10.5, panel.color, va="center", fontweight="bold")
    if panel.note:
        start = x + (width(panel.name, 10.5) * 1.15 / _POINTS + 0.12 if panel.name else 0.0)
        letters = int((x + w - start) * _POINTS / width("n", 8.0) * 1.1)
        if letters > 6:
            write(page, start, y, plain(panel.note, letters), 8.0, palette.MUTED, va="center")


def _flow(keys: Sequence[Key], room: float) -> list[list[tuple[float, Key]]]:
    """Legend entries on lines, each with its x in inches."""
    lines: list[list[tuple[float, Key]]] = []
    x = math.inf
    for key in keys:
        length = 0.34 + width(key.text, _TEXT) / _POINTS + 0.22
        if x + length > room:
            lines.append([])
            x = 0.0
        lines[-1].append((x, key))
        x += length
    return lines


def _foot(
    page: Axes,
    lines: list[list[tuple[float, Key]]],
    notes: Sequence[str],
    scale: float,
    page_width: float,
    north: float | None,
) -> None:
    y = _MARGIN - 0.08
    for note in reversed(notes):
        write(page, _MARGIN, y, note, 7.5, palette.MUTED, va="center")
        y += 0.17
    y += 0.08 if notes else 0.0
    _scale_bar(page, page_width - _MARGIN, y + 0.02, scale)
    for line in reversed(lines):
        for x, key in line:
            _swatch(page, _MARGIN + x, y + 0.36, key)
            write(page, _MARGIN + x + 0.34, y + 0.36, key.text, _TEXT, va="center")
        y += 0.24
    if north is not None:
        _north(page, page_width - _MARGIN - 0.2, page.get_ylim()[1] - _MARGIN - 0.3, north)


def _swatch(page: Axes, x: float, y: float, key: Key) -> None:
    if key.marker is None and (key.patch is not None or key.hatch is not None):
        from matplotlib.patches import Rectangle

        page.add_patch(
            Rectangle(
                (x, y - 0.06), 0.24, 0.12, facecolor=key.patch or "none", alpha=key.alpha,
                edgecolor=key.edge or "none", hatch=key.hatch, linewidth=0.8,
            )
        )  # fmt: skip
    if key.line is not None:
        style = "-" if key.dashes is None else (0, key.dashes)
        page.plot([x, x + 0.24], [y, y], color=key.line, linewidth=key.width, linestyle=style,
                  solid_capstyle="butt")  # fmt: skip
    if key.marker is not None:
        page.plot([x + 0.12], [y], marker=key.marker, markersize=5.5, linestyle="none",
                  markerfacecolor=key.patch or palette.PAPER,
                  markeredgecolor=key.edge or palette.OBJECT, markeredgewidth=0.9)  # fmt: skip


def _scale_bar(page: Axes, right: float, y: float, scale: float) -> None:
    """A bar of a round length, about an inch and a half long, in two halves."""
    length = _round_length(1.6 / scale)
    step = 0.5 * length * scale
    start = right - 2.0 * step
    from matplotlib.patches import Rectangle

    for i, fill in enumerate((palette.INK, palette.PAPER)):
        page.add_patch(
            Rectangle(
                (start + i * step, y),
                step,
                0.05,
                facecolor=fill,
                edgecolor=palette.INK,
                linewidth=0.7,
            )
        )
    for i, value in enumerate((0.0, 0.5 * length, length)):
        text = f"{value:g} m" if i == 2 else f"{value:g}"
        write(page, start + i * step, y + 0.12, text, 7.0, palette.MUTED, ha="center", va="center")


def _round_length(wanted: float) -> float:
    power = 10.0 ** math.floor(math.log10(wanted))
    return max(f * power for f in (1.0, 2.0, 5.0) if f * power <= wanted)


def _north(page: Axes, x: float, y: float, north: float) -> None:
    dx, dy = 0.2 * math.cos(north), 0.2 * math.sin(north)
    page.annotate(
        "", (x + dx, y + dy), (x - dx, y - dy),
        arrowprops={"arrowstyle": "-|>", "color": palette.INK, "linewidth": 0.9},
    )  # fmt: skip
    write(page, x + 1.55 * dx, y + 1.55 * dy, "N", 8.5, ha="center", va="center")
