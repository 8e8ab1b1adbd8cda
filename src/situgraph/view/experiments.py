"""Charts of experiments, from their rows (a list of dicts).

Every chart says how many rows it stands on. Rows without a number under a key are left out of it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import msgspec
import numpy as np

from situgraph.geometry.poses import Array
from situgraph.view import palette
from situgraph.view.charts import (
    Row,
    chart,
    color_of,
    column,
    groups,
    name_axes,
    name_series,
    nothing,
)
from situgraph.view.lettering import number, percent, plain, width

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LONGEST_NAME, NAME_SIZE = 64, 8.5  # letters, points: of a case beside its bar
_OUTCOMES = {
    "right": palette.GOOD, "unique": palette.GOOD, "ambiguous": palette.MATCH[1],
    "none": palette.UNEXPLAINED, "never": palette.UNEXPLAINED, "wrong": palette.MOVED,
}  # fmt: skip
_Z95 = 1.96  # standard normal quantile of a 95 % interval


class Fit(msgspec.Struct, frozen=True):
    """``y = factor * x ** exponent``, fitted by least squares in logarithms."""

    factor: float
    exponent: float


def power_law(x: Array, y: Array) -> Fit | None:
    """The power law through positive points, or None where they do not span one."""
    good = np.isfinite(x) & np.isfinite(y) & (x > 0.0) & (y > 0.0)
    if np.unique(x[good]).size < 2:
        return None
    exponent, intercept = np.polyfit(np.log(x[good]), np.log(y[good]), 1)
    return Fit(float(np.exp(intercept)), float(exponent))


def draw_lines(
    rows: Sequence[Row],
    x: str,
    y: str,
    series: str | None = None,
    *,
    title: str,
    x_name: str,
    y_name: str,
    band: tuple[float, float] = (0.25, 0.75),
    log_x: bool = False,
    log_y: bool = False,
) -> Figure:
    """Medians of ``y`` over ``x`` with a band of quantiles, a line for each value of ``series``."""
    share = f"{round(100 * (band[1] - band[0]))} %"
    subtitle = f"median and the middle {share} of {number(len(rows))} runs"
    figure, (axes,) = chart(title, subtitle)
    names = []
    for i, (name, group) in enumerate(groups(rows, series).items()):
        at, low, middle, high = _quantiles(column(group, x), column(group, y), band)
        if not len(at):
            continue
        color = color_of(name, i)
        axes.fill_between(at, low, high, color=color, alpha=0.15, linewidth=0.0)
        marker = "o" if len(at) <= 30 else None
        axes.plot(at, middle, color=color, linewidth=1.6, marker=marker, markersize=3.5)
        names.append((name, color))
    return _finished(figure, axes, names, x_name, y_name, log_x, log_y)


def draw_scale(
    rows: Sequence[Row], x: str, y: str, series: str | None = None, *, title: str, x_name: str,
    y_name: str,
) -> Figure:  # fmt: skip
    """``y`` over ``x`` on logarithmic axes, with the power law fitted to the medians."""
    subtitle = f"each point one of {number(len(rows))} runs; lines fitted to the medians"
    figure, (axes,) = chart(title, subtitle)
    names = []
    for i, (name, group) in enumerate(groups(rows, series).items()):
        xs, ys = column(group, x), column(group, y)
        good = np.isfinite(xs) & np.isfinite(ys) & (xs > 0.0) & (ys > 0.0)
        if not good.any():
            continue
        color = color_of(name, i)
        axes.scatter(xs[good], ys[good], s=9.0, color=color, alpha=0.35, linewidths=0.0)
        at, _, middle, _ = _quantiles(xs[good], ys[good], (0.5, 0.5))
        axes.scatter(at, middle, s=26.0, color=color, edgecolors=palette.PAPER, linewidths=0.8)
        fit = power_law(at, middle)
        if fit is not None:
            ends = np.array([at.min(), at.max()])
            axes.plot(ends, fit.factor * ends**fit.exponent, color=color, linewidth=1.1)
        law = "" if fit is None else f"{'  ' if name else ''}∝ n^{fit.exponent:.2f}"
        names.append((f"{name}{law}", color))
    return _finished(figure, axes, names, x_name, y_name, True, True)


def draw_reliability(
    rows: Sequence[Row], probability: str, right: str, *, title: str, bins: int = 10
) -> Figure:
    """How often what was said with a probability was right, with 95 % intervals (Wilson, 1927)."""
    said, was = column(rows, probability), column(rows, right)
    good = np.isfinite(said) & np.isfinite(was)
    said, was = said[good], was[good]
    subtitle = f"{number(len(said))} statements; bars: 95 % intervals, circles as large as the bin"
    figure, (axes,) = chart(title, subtitle, size=(4.4, 4.4))
    axes.plot([0.0, 1.0], [0.0, 1.0], color=palette.HAIRLINE, linewidth=1.0, zorder=1.0)
    place = np.clip((said * bins).astype(int), 0, bins - 1)
    for i in range(bins):
        inside = place == i
        count = int(inside.sum())
        if not count:
            continue
        mean = float(said[inside].mean())
        low, high = wilson(float(was[inside].sum()), count)
        axes.plot([mean, mean], [low, high], color=palette.MATCH[0], linewidth=1.2)
        size = 14.0 + 220.0 * count / len(said)
        axes.scatter([mean], [was[inside].mean()], s=size, color=palette.MATCH[0], zorder=3.0,
                     edgecolors=palette.PAPER, linewidths=0.8)  # fmt: skip
    axes.set_xlim(-0.02, 1.02)
    axes.set_ylim(-0.02, 1.04)
    return _finished(figure, axes, [], "probability stated", "share that was right", False, False)


def wilson(right: float, count: int) -> tuple[float, float]:
    """The 95 % interval of a share."""
    share, z2 = right / count, _Z95**2
    middle = (share + z2 / (2 * count)) / (1.0 + z2 / count)
    half = _Z95 / (1.0 + z2 / count)
    half *= float(np.sqrt(share * (1.0 - share) / count + z2 / (4.0 * count**2)))
    return middle - half, middle + half


def draw_outcomes(cases: Mapping[str, Mapping[str, float]], *, title: str) -> Figure:
    """Shares of outcomes (``right``, ``ambiguous``, ``none``, ``wrong`` ...) as bars, by case."""
    kinds = [k for k in _OUTCOMES if any(k in counts for counts in cases.values())]
    total = sum(v for counts in cases.values() for k, v in counts.items() if k in kinds)
    height = max(0.34 * len(cases), 0.5)
    names = [plain(case, LONGEST_NAME) for case in cases]
    margin = max((width(name, NAME_SIZE) for name in names), default=0.0) / 72 + 0.2  # inches
    figure, (axes,) = chart(title, f"{number(total)} runs", size=(3.6 + margin, height))
    for i, (name, counts) in enumerate(zip(names, cases.values())):
        every = sum(counts.get(k, 0.0) for k in kinds) or 1.0
        start = 0.0
        for kind in kinds:
            share = counts.get(kind, 0.0) / every
            axes.barh(i, share, left=start, color=_OUTCOMES[kind], height=0.66, linewidth=0.0)
            if share >= 0.07:
                axes.text(start + 0.5 * share, i, percent(round(share, 3)), ha="center",
                          va="center", fontsize=7.5, color=palette.PAPER)  # fmt: skip
            start += share
        axes.text(-0.01, i, name, ha="right", va="center", fontsize=NAME_SIZE,
                  color=palette.INK, parse_math=False)  # fmt: skip
    axes.set_xlim(0.0, 1.0)
    axes.set_ylim(max(len(cases), 1) - 0.5, -0.5)
    axes.set_axis_off()
    place = axes.get_position()
    left = margin / figure.get_figwidth()
    axes.set_position((left, place.y0, place.x1 - left, place.height))
    name_series(figure, [(k, _OUTCOMES[k]) for k in kinds])
    return figure


def _quantiles(x: Array, y: Array, band: tuple[float, float]) -> tuple[Array, Array, Array, Array]:
    """At each value of ``x``: the lower quantile, the median and the upper quantile of ``y``."""
    good = np.isfinite(x) & np.isfinite(y)
    at = np.unique(x[good])
    points = (band[0], 0.5, band[1])
    found = [np.quantile(y[good & (x == v)], points) for v in at]
    low, middle, high = np.array(found).reshape(-1, 3).T
    return at, low, middle, high


def _finished(
    figure: Figure, axes: Axes, names: Sequence[tuple[str, str]], x_name: str, y_name: str,
    log_x: bool, log_y: bool,
) -> Figure:  # fmt: skip
    if not axes.has_data():
        nothing(axes)
        log_x = log_y = False
    if log_x:
        axes.set_xscale("log")
    if log_y:
        axes.set_yscale("log")
    name_axes(figure, axes, x_name, y_name)
    if len(names) > 1 or (names and names[0][0]):
        name_series(figure, names)
    return figure
