"""The drawing of what differs from the plan: walls moved, missing and extra, doors and windows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from situgraph.scenegraph.graph import SceneGraph
from situgraph.view import palette
from situgraph.view.config import USUAL, ViewConfig
from situgraph.view.floors import Building, survey
from situgraph.view.marginalia import Key
from situgraph.view.names import draw_names
from situgraph.view.pen import UNDER, draw_floor, strokes
from situgraph.view.plan import captions, north
from situgraph.view.sheet import Page, blank, sheet

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_BELOW = 0.5  # m; a deviation this far below a floor is still on it
COLORS = {"moved": palette.MOVED, "missing": palette.ADVICE, "extra": palette.PATH}
_AS_BUILT = 1.6  # points, the faces as seen
_TOLD = 2.6  # points, those that differ


def draw_deviations(
    prior: SceneGraph | Building,
    deviations: Sequence[Mapping[str, Any]],
    seen: SceneGraph,
    config: ViewConfig = USUAL,
    *,
    heading: bool = True,
) -> Figure:
    """Draw the plan in grey, the faces as seen over it, and a number at each deviation.

    Args:
        prior: the A-Graph.
        deviations: those of ``situgraph/located``, in the order in which they are numbered.
        seen: the S-Graph in the building frame.
        config: sizes and limits.
        heading: whether the picture carries its title.
    """
    plan = prior if isinstance(prior, Building) else survey(prior, config)
    title = f"{plan.graph.name or 'The building'} as built"
    if not plan.floors:
        return blank(title, "The plan has no floor to draw.", config, heading)
    starts = np.array([f.elevation for f in plan.floors])
    level_of = [_level(starts, d["place"][2]) for d in deviations]
    seen_on = _storeys(plan, seen, starts)
    levels = sorted({*level_of, *seen_on.values()})[: config.max_panels] or [0]
    floors = [plan.floors[i] for i in levels]
    whole = np.concatenate([f.points() for f in floors])
    (x0, y0), (x1, y1) = whole.min(axis=0).tolist(), whole.max(axis=0).tolist()
    kinds = dict.fromkeys(d["kind"].split("-")[0] for d in deviations)
    keys = [
        Key("wall of the plan", patch=palette.WALL_ONE),
        Key("as seen", line=palette.ONLINE),
        *(Key(kind, marker="o", patch=COLORS[kind], edge=COLORS[kind]) for kind in kinds),
    ]
    count = len(deviations)
    told = f"{count} deviation{'' if count == 1 else 's'} from the plan"
    content = Page(title, told, keys=tuple(keys), north=north(plan.graph), heading=heading)
    page = sheet(content, captions(floors, (x0, y0, x1, y1)), config)
    for axes, floor, level in zip(page.panels, floors, levels):
        draw_floor(axes, floor, page.points_per_metre, UNDER)
        draw_names(axes, floor.rooms, page.points_per_metre, config)
        here = [(n, d) for n, d in enumerate(deviations, start=1) if level_of[n - 1] == level]
        _faces(axes, seen, {p for p, on in seen_on.items() if on == level}, here)
        for number, deviation in here:
            _mark(axes, number, deviation)
    return page.figure


def _storeys(plan: Building, seen: SceneGraph, starts: Any) -> dict[str, int]:
    """The storey (by position) of each face that was seen."""
    return {plane: _level(starts, room.center[2]) for room in seen.rooms for plane in room.planes}


def _level(starts: Any, height: float) -> int:
    return max(int(np.searchsorted(starts, height + _BELOW, side="right")) - 1, 0)


def _faces(
    axes: Axes, seen: SceneGraph, planes: set[str], here: Sequence[tuple[int, Mapping[str, Any]]]
) -> None:
    """The faces as seen; those that are told of in the colour of their kind."""
    told = {d.get("online"): d["kind"].split("-")[0] for _, d in here if d["category"] == "wall"}
    known = [p for p in seen.planes if p.id in planes and p.extent is not None]
    usual = [np.asarray(p.extent, dtype=float) for p in known if p.id not in told]
    strokes(axes, usual, palette.ONLINE, _AS_BUILT, 3.0)
    for plane in known:
        if plane.id in told:
            line = [np.asarray(plane.extent, dtype=float)]
            strokes(axes, line, COLORS[told[plane.id]], _TOLD, 3.2)


def _mark(axes: Axes, number: int, deviation: Mapping[str, Any]) -> None:
    """A number in a circle, and the offset beside it."""
    color = COLORS[deviation["kind"].split("-")[0]]
    x, y, _ = deviation["place"]
    axes.scatter([x], [y], s=90.0, color=color, edgecolors=palette.PAPER, zorder=7.0)
    axes.text(
        x, y, str(number), fontsize=6.5, color=palette.PAPER, ha="center", va="center_baseline",
        zorder=7.1, parse_math=False,
    )  # fmt: skip
    offset = deviation.get("offset")
    if offset is not None:
        axes.annotate(
            f"{100.0 * offset:+.0f} cm", (x, y), xytext=(7.0, 5.0), textcoords="offset points",
            fontsize=7.0, color=color, zorder=7.1,
            bbox={"facecolor": palette.PAPER, "edgecolor": "none", "alpha": 0.8, "pad": 0.6},
        )  # fmt: skip
