"""What to look for next, drawn where it is: the advice that comes with an ambiguous match."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import msgspec
import numpy as np

from situgraph.geometry.poses import Array
from situgraph.scenegraph.graph import SceneGraph
from situgraph.view import palette
from situgraph.view.config import USUAL, ViewConfig
from situgraph.view.floors import Building, survey
from situgraph.view.lettering import plain
from situgraph.view.marginalia import Key
from situgraph.view.overlay import draw_overlay, lay_over
from situgraph.view.pen import fill_polygons, strokes
from situgraph.view.plan import north
from situgraph.view.record import Advice, Match, Solution, read_record
from situgraph.view.sheet import Bounds, Page, Panel, blank, sheet

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_SIDES = ("right", "upper", "left", "lower")
_MOST = 8  # pieces of advice in one picture


class Spot(msgspec.Struct, frozen=True):
    """A piece of advice in the plan: its storey (by position), where it is, and a sentence."""

    number: int
    level: int
    at: Array
    wall: Array | None
    room: Array | None
    sentence: str


def spots(advice: Sequence[Advice], plan: Building) -> list[Spot]:
    """Where each piece of advice is, but for those whose wall and room the plan does not know."""
    found = []
    for number, item in enumerate(advice[:_MOST], 1):
        for level, floor in enumerate(plan.floors):
            shape = next((s for s in floor.rooms if s.id == item.in_room), None)
            walls = [s for i, s in zip(floor.faces.ids, floor.faces.segments) if i == item.on_plane]
            if shape is None and not walls:
                continue
            # A plane may have a segment in each of its rooms: the one nearest to this room.
            wall = min(walls, key=lambda s: _far(s, shape), default=None) if walls else None
            room = None if shape is None or shape.outline is None else shape.outline.polygon
            at = wall.mean(axis=0) if wall is not None else shape.center if shape else np.zeros(2)
            sentence = _sentence(item, None if shape is None else shape.name, _side(plan, item))
            found.append(Spot(number, level, at, wall, room, sentence))
            break
    return found


def _far(segment: Array, shape: object) -> float:
    center = getattr(shape, "center", None)
    return 0.0 if center is None else float(np.linalg.norm(segment.mean(axis=0) - center))


def _side(plan: Building, item: Advice) -> str | None:
    plane = plan.graph.plane_by_id.get(item.on_plane or "")
    if plane is None:
        return None
    out = np.arctan2(-plane.normal[1], -plane.normal[0])
    return _SIDES[round(float(out) / (0.5 * np.pi)) % 4]


def _sentence(item: Advice, room: str | None, side: str | None) -> str:
    thing = plain(item.look_for.replace("_", " "), 40)
    wall = f"the {side} wall" if side else ""
    where = " of ".join(filter(None, (wall, f"room {plain(room, 40)}" if room else "")))
    groups = [", ".join(str(i + 1) for i in group[:6]) for group in item.splits if group]
    tells = f": tells {' from '.join(groups)}" if len(groups) > 1 else ""
    return f"{thing} {'on' if wall else 'in'} {where}{tells}" if where else f"{thing}{tells}"


def draw_advice(
    match: Match, online: SceneGraph, prior: SceneGraph | Building, config: ViewConfig = USUAL,
    *, heading: bool = True,
) -> Figure:  # fmt: skip
    """Draw what to look for, and on which wall, over the most probable placement.

    Raises:
        InputError: ``match`` is no match JSON.
    """
    record = read_record(match)
    plan = prior if isinstance(prior, Building) else survey(prior, config)
    found = spots(record.disambiguation, plan)
    title = "What to look for next"
    if not found:
        return blank(
            title, "Nothing that would tell the solutions apart is known.", config, heading
        )
    best = record.solutions[0] if record.solutions else None
    levels = sorted({s.level for s in found})[: config.max_panels]
    panels = [
        Panel(_around(plan, best, online, found, level, config), _name(plan, level))
        for level in levels
    ]
    keys = (
        Key("look here", line=palette.ADVICE, width=4.0),
        Key("where the most probable solution has the robot", patch=palette.MATCH[0], alpha=0.45),
    )
    subtitle = "\n".join(f"{s.number}.  {s.sentence}" for s in found)
    content = Page(title, subtitle, palette.ADVICE, keys, north=north(plan.graph), heading=heading)
    page = sheet(content, panels, config)
    over = None if best is None else lay_over(plan, online, best, config)
    for axes, level, panel in zip(page.panels, levels, panels):
        if over is not None:
            draw_overlay(axes, over, level, panel.bounds, page.points_per_metre, config)
        for spot in found:
            if spot.level == level:
                _mark(axes, spot, page.points_per_metre)
    return page.figure


def _name(plan: Building, level: int) -> str:
    return plan.floors[level].name if len(plan.floors) > 1 else ""


def _around(
    plan: Building, best: Solution | None, online: SceneGraph, found: Sequence[Spot], level: int,
    config: ViewConfig,
) -> Bounds:  # fmt: skip
    """The spots of a storey and, if it is there, what was seen."""
    points = [s.at[None] + d for s in found if s.level == level for d in (-3.0, 3.0)]
    over = None if best is None else lay_over(plan, online, best, config)
    if over is not None and level in over.levels:
        points.append(np.reshape(over.focus([level]), (2, 2)))
    every = np.concatenate(points)
    (x0, y0), (x1, y1) = every.min(axis=0).tolist(), every.max(axis=0).tolist()
    return x0, y0, x1, y1


def _mark(axes: Axes, spot: Spot, scale: float) -> None:
    """A glow along the wall, or around the room, and a number beside it."""
    at = spot.at
    if spot.wall is not None:
        strokes(axes, [spot.wall], palette.ADVICE, 6.0, 7.0, alpha=0.75)
    elif spot.room is not None:
        fill_polygons(axes, [spot.room], "none", 7.0, palette.ADVICE, 3.0)
    axes.scatter(at[:1], at[1:], s=150.0, color=palette.ADVICE, edgecolors=palette.PAPER,
                 linewidths=1.2, zorder=7.1)  # fmt: skip
    axes.text(at[0], at[1], str(spot.number), fontsize=8.0, color=palette.PAPER, ha="center",
              va="center_baseline", fontweight="bold", zorder=7.2, clip_on=True)  # fmt: skip
