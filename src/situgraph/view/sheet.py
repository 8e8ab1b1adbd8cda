"""A page with panels at one scale.

Everything outside the panels is placed in inches, so that a drawing's scale is known before it is
drawn and letters can be left out where they would not be read.
"""

from __future__ import annotations

import math
import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING

import msgspec

from situgraph.view import palette
from situgraph.view.config import ViewConfig
from situgraph.view.lettering import plain, width
from situgraph.view.marginalia import (
    LEGEND_LINE,
    NOTE_LINE,
    Key,
    flow,
    legend_line,
    north_arrow,
    scale_bar,
    write,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Bounds = tuple[float, float, float, float]

MARGIN = 0.42  # inch, around the page
_NARROWEST = 7.5  # inch, a page with its title and legend
_GAP = 0.3  # inch, between panels
_CAPTION = 0.34  # inch, above a panel
_SUBTITLE_LINE = 0.19  # inch
_TITLE = 18.0  # point
_LEAST_TITLE = 11.0
_SUBTITLE = 9.0
_NAME = 10.5
_NOTE = 8.0
_SMALL = 7.5
_WORTH_A_ROW = 1.5  # panels stand side by side, unless so much larger one below the other
_POINTS = 72.0  # to the inch


class Panel(msgspec.Struct, frozen=True):
    """What a panel shows (m), its name, and a note beside it."""

    bounds: Bounds
    name: str = ""
    note: str = ""
    color: str = palette.INK


class Page(msgspec.Struct, frozen=True):
    """What stands around the panels.

    ``north`` is the direction of true north in the drawing (radians from x); ``corner`` the inches
    left free at the upper right. Without ``heading`` title and subtitle are left out.
    """

    title: str
    subtitle: str = ""
    color: str = palette.INK
    keys: tuple[Key, ...] = ()
    notes: tuple[str, ...] = ()
    north: float | None = None
    corner: float = 0.0
    heading: bool = True


class Sheet(msgspec.Struct, frozen=True):
    """A figure, the axes of its panels (in metres) and of the page (in inches), and the scale.

    ``spare`` is a place left over in the grid of panels: x, y, width and height in inches.
    """

    figure: Figure
    panels: tuple[Axes, ...]
    page: Axes
    points_per_metre: float
    spare: Bounds | None = None


def sheet(content: Page, panels: Sequence[Panel], config: ViewConfig) -> Sheet:
    """An empty page; every panel shows as much as the largest needs, around its own middle."""
    from matplotlib.figure import Figure

    views = _views([p.bounds for p in panels])
    x0, y0, x1, y1 = views[0]
    rows, columns, scale = _grid(len(panels), x1 - x0, y1 - y0, config.page_width)
    w, h = (x1 - x0) * scale, (y1 - y0) * scale
    across = columns * w + (columns - 1) * _GAP
    breadth = max(min(_NARROWEST, config.page_width), across + 2.0 * MARGIN)
    free = breadth - 2.0 * MARGIN
    legend = flow(content.keys, free)
    words = [
        s
        for line in content.subtitle.splitlines()
        for s in _wrapped(line, free - content.corner, _SUBTITLE)
    ]
    notes = [s for note in content.notes for s in _wrapped(note, free - 2.2, _SMALL)]
    top = _top(content, len(words))
    bottom = MARGIN + LEGEND_LINE * len(legend) + 0.36 + NOTE_LINE * len(notes)
    below = [_below(p, w) for p in panels]
    caption = _CAPTION if any(p.name or p.note for p in panels) else 0.0
    caption += 0.16 * max(len(lines) for lines in below)
    height = top + rows * (h + caption) + (rows - 1) * _GAP + bottom
    figure = Figure(figsize=(breadth, height), facecolor=palette.PAPER)
    page = _page(figure, breadth, height)
    if content.heading:
        _head(page, content, words, height)
    places = [
        (
            0.5 * (breadth - across) + column * (w + _GAP),
            height - top - (row + 1) * (h + caption) - row * _GAP,
        )
        for row in range(rows)
        for column in range(columns)
    ]
    axes = []
    for panel, view, remarks, (x, y) in zip(panels, views, below, places):
        axes.append(add_axes(figure, (x, y, w, h), view))
        _caption(page, panel, x, y + h + caption, remarks)
    _foot(page, content, legend, notes, scale)
    spare = (*places[-1], w, h) if len(panels) < len(places) else None
    return Sheet(figure, tuple(axes), page, scale * _POINTS, spare)


def drawing_scale(panels: Sequence[Panel], config: ViewConfig) -> float:
    """The points a metre that ``sheet`` will give these panels."""
    x0, y0, x1, y1 = _views([p.bounds for p in panels])[0]
    return _grid(len(panels), x1 - x0, y1 - y0, config.page_width)[2] * _POINTS


def add_axes(figure: Figure, box: tuple[float, float, float, float], view: Bounds) -> Axes:
    """Frameless axes at ``box`` (x, y, width, height in inches) that show ``view``."""
    x, y, w, h = box
    width, height = figure.get_size_inches()
    axes = figure.add_axes((x / width, y / height, w / width, h / height))
    axes.set_axis_off()
    axes.set_xlim(view[0], view[2])
    axes.set_ylim(view[1], view[3])
    return axes


def blank(title: str, sentence: str, config: ViewConfig, heading: bool = True) -> Figure:
    """A small page that says why there is no drawing."""
    from matplotlib.figure import Figure

    lines = _wrapped(sentence, config.page_width - 2.0 * MARGIN, _SUBTITLE)
    height = 1.2 + _SUBTITLE_LINE * len(lines)
    title = title if heading else ""
    figure = Figure(figsize=(config.page_width, height), facecolor=palette.PAPER)
    _head(_page(figure, config.page_width, height), Page(title), lines, height)
    return figure


def _views(bounds: Sequence[Bounds]) -> list[Bounds]:
    """Equally large views around the middles of ``bounds``, with a margin."""
    w = max(b[2] - b[0] for b in bounds)
    h = max(b[3] - b[1] for b in bounds)
    margin = 0.03 * max(w, h, 1.0) + 0.3
    w, h = 0.5 * w + margin, 0.5 * h + margin
    middles = [(0.5 * (b[0] + b[2]), 0.5 * (b[1] + b[3])) for b in bounds]
    return [(x - w, y - h, x + w, y + h) for x, y in middles]


def _grid(count: int, w: float, h: float, page_width: float) -> tuple[int, int, float]:
    """Rows, columns and inches a metre: the largest scale on a page of bearable height."""
    across = page_width - 2.0 * MARGIN
    best = (1, max(count, 1), 0.0)
    for columns in range(max(count, 1), 0, -1):
        rows = math.ceil(count / columns) or 1
        # A page may be as tall as wide; every further row of panels may make it taller.
        tall = page_width * (0.62 + 0.22 * min(rows, 4))
        tall = max(tall - rows * _CAPTION - (rows - 1) * _GAP, 2.0)
        scale = min((across - (columns - 1) * _GAP) / columns / w, tall / rows / h)
        if scale > _WORTH_A_ROW * best[2]:
            best = (rows, columns, scale)
    return best


def _top(content: Page, lines: int) -> float:
    """The height of everything above the panels."""
    corner = MARGIN + 1.05 if content.corner else 0.0
    if not content.heading:
        return max(corner, 0.15 if content.north is None else MARGIN + 0.5)
    return max(corner, MARGIN + 0.6 + _SUBTITLE_LINE * lines)


def _page(figure: Figure, width: float, height: float) -> Axes:
    return add_axes(figure, (0.0, 0.0, width, height), (0.0, 0.0, width, height))


def _head(page: Axes, content: Page, words: Sequence[str], height: float) -> None:
    y = height - MARGIN - 0.18
    title, room = plain(content.title, 70), (page.get_xlim()[1] - 2.0 * MARGIN) * _POINTS
    size = min(_TITLE, max(_LEAST_TITLE, _TITLE * room / max(width(title, _TITLE), 1e-9)))
    write(page, MARGIN, y, title, size, content.color)
    for i, line in enumerate(words):
        write(page, MARGIN, y - 0.36 - _SUBTITLE_LINE * i, line, _SUBTITLE, palette.MUTED)


def _wrapped(text: str, room: float, size: float) -> list[str]:
    """``text`` on lines that fit ``room`` (inches)."""
    line = plain(text, 900)
    mean = width(line, size) / max(len(line), 1)
    return textwrap.wrap(line, max(int(room * _POINTS / max(mean, 1e-9) * 0.97), 12))


def _beside(panel: Panel) -> float:
    """Where a note starts on the line of its panel's name."""
    return width(plain(panel.name, 48), _NAME) * 1.13 / _POINTS + 0.14 if panel.name else 0.0


def _below(panel: Panel, w: float) -> list[str]:
    """The lines of a note that does not fit beside its panel's name."""
    fits = _beside(panel) + width(panel.note, _NOTE) / _POINTS <= w
    return [] if fits else _wrapped(panel.note, w, _NOTE)[:3]


def _caption(page: Axes, panel: Panel, x: float, top: float, below: Sequence[str]) -> None:
    y = top - 0.16
    write(page, x, y, plain(panel.name, 48), _NAME, panel.color, fontweight="bold")
    if panel.note and not below:
        write(page, x + _beside(panel), y, plain(panel.note, 200), _NOTE, palette.MUTED)
    for i, line in enumerate(below):
        write(page, x, y - 0.21 - 0.16 * i, line, _NOTE, palette.MUTED)


def _foot(
    page: Axes, content: Page, legend: list[list[tuple[float, Key]]], notes: Sequence[str],
    scale: float,
) -> None:  # fmt: skip
    right = page.get_xlim()[1] - MARGIN
    scale_bar(page, right, MARGIN - 0.06, scale)
    if content.north is not None:
        top = page.get_ylim()[1] - MARGIN - 0.25
        north_arrow(page, right - content.corner - 0.15, top, content.north)
    y = MARGIN - 0.08
    for note in reversed(notes):
        write(page, MARGIN, y, note, _SMALL, palette.MUTED)
        y += NOTE_LINE
    y = max(y, MARGIN) + 0.22
    for line in reversed(legend):
        legend_line(page, line, MARGIN, y)
        y += LEGEND_LINE
