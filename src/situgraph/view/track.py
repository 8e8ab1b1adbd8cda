"""Where the robot was and what it knew: its trajectory in the building, its status over time."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import msgspec
import numpy as np
from numpy.typing import ArrayLike, NDArray

from situgraph.geometry.poses import Array
from situgraph.scenegraph.graph import SceneGraph
from situgraph.view import palette
from situgraph.view.charts import chart, name_axes, name_series, nothing
from situgraph.view.config import USUAL, ViewConfig
from situgraph.view.floors import Building, survey
from situgraph.view.lettering import seconds
from situgraph.view.marginalia import Key
from situgraph.view.names import draw_names
from situgraph.view.pen import UNDER, draw_floor, strokes
from situgraph.view.plan import captions, north
from situgraph.view.sheet import Page, blank, sheet

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# From the beginning to the end of a run, readable on light and on dark ground.
_EARLY, _LATE = (0.35, 0.55, 0.85), (0.78, 0.18, 0.55)
_STEPS = 64  # colours along a path
_LABELS = 8  # at most so many times are written along a path
_SPANS = (1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 60.0, 120.0, 300.0, 600.0, 900.0, 1800.0)
_NAME_BELOW = 14.0  # points, room names: paths and their times go through the middle of rooms
_FLOOR = 0.5  # m, a robot may be this far below the floor it drives on


class Status(msgspec.Struct, frozen=True):
    """What was known at a time (s): rooms and objects seen, placements alive, the verdict."""

    stamp: float
    rooms: int
    objects: int
    solutions: int
    verdict: str


def draw_track(
    prior: SceneGraph | Building,
    stamps: ArrayLike,
    positions: ArrayLike,
    config: ViewConfig = USUAL,
    *,
    located: float | None = None,
    heading: bool = True,
) -> Figure:
    """Draw a trajectory in the plan, its colour telling the time.

    Args:
        prior: the A-Graph.
        stamps: times (n,) in seconds, ascending.
        positions: positions (n, 2 or 3) in the building frame, metres.
        config: sizes and limits.
        located: when the robot knew where it was; what lies before is grey, as it was only known
            afterwards.
        heading: whether the picture carries its title.
    """
    plan = prior if isinstance(prior, Building) else survey(prior, config)
    when = np.asarray(stamps, dtype=float)
    where = np.asarray(positions, dtype=float)
    title = f"Where the robot was in {plan.graph.name or 'the plan'}"
    if not len(when) or not plan.floors:
        return blank(title, "There is no trajectory to draw.", config, heading)
    level = _levels(plan, where)
    levels = sorted(set(level.tolist()))[: config.max_panels]
    floors = [plan.floors[i] for i in levels]
    path = where[:, :2]
    whole = np.concatenate([path, *(f.points() for f in floors)])
    (x0, y0), (x1, y1) = whole.min(axis=0).tolist(), whole.max(axis=0).tolist()
    length = float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())
    subtitle = f"{length:.0f} m in {seconds(when[-1] - when[0])}"
    keys = [Key("wall of the plan", patch=palette.WALL_ONE), Key("early", line=_hex(0.0)),
            Key("late", line=_hex(1.0))]  # fmt: skip
    if located is not None:
        keys.append(Key("not yet located", line=palette.UNEXPLAINED))
        keys.append(Key("located here", marker="*", patch=palette.GOOD, edge=palette.GOOD))
        subtitle += f"; located after {seconds(max(located - when[0], 0.0))}"
    content = Page(title, subtitle, keys=tuple(keys), north=north(plan.graph), heading=heading)
    page = sheet(content, captions(floors, (x0, y0, x1, y1)), config)
    for axes, floor, i in zip(page.panels, floors, levels):
        draw_floor(axes, floor, page.points_per_metre, UNDER)
        draw_names(axes, floor.rooms, page.points_per_metre, config, below=_NAME_BELOW)
        _path(axes, when, path, level == i, located)
    return page.figure


def _levels(plan: Building, where: Array) -> NDArray[np.int_]:
    """The storey (by position) each point (n, 2 or 3) is on."""
    if where.shape[1] < 3 or len(plan.floors) == 1:
        return np.zeros(len(where), dtype=int)
    starts = np.array([f.elevation for f in plan.floors])
    found = np.searchsorted(starts, where[:, 2] + _FLOOR, side="right") - 1
    return np.asarray(np.maximum(found, 0), dtype=int)


def _path(
    axes: Axes, when: Array, path: Array, here: NDArray[np.bool_], located: float | None
) -> None:
    """The part of a path on one storey: pieces coloured by time, and the times beside it."""
    segments = np.stack([path[:-1], path[1:]], axis=1)
    on = here[:-1] & here[1:]
    span = max(float(when[-1] - when[0]), 1e-9)
    share = (0.5 * (when[:-1] + when[1:]) - when[0]) / span
    known = np.ones(len(on), dtype=bool) if located is None else when[:-1] >= located
    strokes(axes, segments[on & ~known], palette.UNEXPLAINED, 1.6, 6.2)
    bins = np.minimum((share * _STEPS).astype(int), _STEPS - 1)
    for step in np.unique(bins[on & known]).tolist():
        chosen = on & known & (bins == step)
        strokes(axes, segments[chosen], _hex((step + 0.5) / _STEPS), 1.8, 6.3)
    if located is not None:
        at = int(np.clip(np.searchsorted(when, located), 0, len(when) - 1))
        if here[at]:
            axes.scatter(path[at, :1], path[at, 1:], marker="*", s=130.0, color=palette.GOOD,
                         edgecolors=palette.PAPER, linewidths=0.8, zorder=6.6)  # fmt: skip
    every = _round_time(span / _LABELS)
    for time in np.arange(0.0, span + 1e-9, every):
        at = int(np.clip(np.searchsorted(when, when[0] + time), 0, len(when) - 1))
        if here[at]:
            x, y = path[at]
            axes.scatter([x], [y], s=10.0, color=palette.INK, linewidths=0.0, zorder=6.5)
            axes.annotate(
                _clock(time), (x, y), xytext=(4.0, 4.0), textcoords="offset points", fontsize=6.5,
                color=palette.INK, zorder=6.7, annotation_clip=True,
                bbox={"facecolor": palette.PAPER, "edgecolor": "none", "alpha": 0.7, "pad": 0.5},
            )  # fmt: skip


def _hex(share: float) -> str:
    parts = [a + (b - a) * share for a, b in zip(_EARLY, _LATE)]
    return "#" + "".join(f"{round(255 * p):02x}" for p in parts)


def _round_time(wanted: float) -> float:
    """The shortest span that people count in and that is no shorter than ``wanted`` seconds."""
    hours = 3600.0 * math.ceil(wanted / 3600.0)
    return next((t for t in _SPANS if t >= wanted), hours)


def _clock(time: float) -> str:
    whole = round(time)
    return f"{whole // 60}:{whole % 60:02d}"


def draw_history(history: Sequence[Status], *, title: str = "What it knew, over time") -> Figure:
    """Rooms and objects seen and placements still alive, over the seconds of a run.

    The ground tells the verdict: green unique, amber ambiguous, red none.
    """
    from matplotlib.ticker import LogLocator, NullLocator

    figure, (counts, alive) = chart(title, f"{len(history)} updates", 2, (6.4, 1.9), columns=1)
    if not history:
        nothing(counts)
        return figure
    time = np.array([s.stamp for s in history])
    time = time - time[0]
    names = (("rooms", palette.MATCH[0]), ("objects", palette.DOOR))
    for name, color in names:
        values = [getattr(s, name) for s in history]
        counts.step(time, values, where="post", color=color, linewidth=1.5)
    alive.step(time, [max(s.solutions, 0.5) for s in history], where="post", color=palette.INK,
               linewidth=1.5)  # fmt: skip
    alive.set_yscale("log")
    alive.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    alive.yaxis.set_minor_locator(NullLocator())
    alive.yaxis.set_major_formatter(lambda value, _: f"{value:g}" if value >= 1.0 else "0")
    alive.set_ylim(0.45, 1.3 * max(2.0, *(s.solutions for s in history), 0.0))
    ends = [*time[1:].tolist(), float(time[-1])]
    for start, end, status in zip(time.tolist(), ends, history):
        ground = palette.VERDICTS.get(status.verdict, palette.HAIRLINE)
        for axes in (counts, alive):
            axes.axvspan(start, end, color=ground, alpha=0.12, linewidth=0.0)
    name_axes(figure, counts, "", "seen so far")
    name_axes(figure, alive, "seconds", "placements that fit")
    name_series(figure, names)
    return figure
