"""The drawing of a match: the online graph over its plan."""

from __future__ import annotations

from typing import TYPE_CHECKING

from situgraph.scenegraph.graph import SceneGraph
from situgraph.view import palette
from situgraph.view.config import USUAL, ViewConfig
from situgraph.view.floors import Building, survey
from situgraph.view.keyplan import CORNER, draw_key_plan, wants_key_plan
from situgraph.view.legend import match_legend
from situgraph.view.lettering import number, plain
from situgraph.view.names import draw_names
from situgraph.view.overlay import draw_overlay, lay_over
from situgraph.view.pen import draw_floor
from situgraph.view.plan import north
from situgraph.view.record import Match, MatchRecord, read_record
from situgraph.view.rivals import draw_rivals
from situgraph.view.sheet import Page, Panel, blank, sheet
from situgraph.view.wording import figures

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["draw_match", "draw_rivals"]


def draw_match(
    match: Match,
    online: SceneGraph,
    prior: SceneGraph | Building,
    config: ViewConfig = USUAL,
    *,
    solution: int = 0,
    heading: bool = True,
) -> Figure:
    """Draw one solution of a match: both graphs in the building frame.

    Matched rooms have one colour in both graphs, seen planes lie over the plan's walls, moved walls
    are red with their offset, unexplained rooms hatched. Without a solution both graphs stand side
    by side, each in its own frame.

    Args:
        match: a match result or its JSON as a dict.
        online: the S-Graph in its map frame.
        prior: the A-Graph.
        config: sizes and limits.
        solution: which solution, best first.
        heading: whether the picture carries its title and the reason.

    Raises:
        InputError: ``match`` is no match JSON.
    """
    record = read_record(match)
    plan = prior if isinstance(prior, Building) else survey(prior, config)
    title = f"{online.name or 'Online graph'} in {plan.graph.name or 'the plan'}: {record.verdict}"
    color = palette.VERDICTS[record.verdict]
    if not solution < len(record.solutions):
        content = Page(title, record.reason, color, heading=heading)
        return _apart(content, online, plan, config)
    chosen = record.solutions[solution]
    over = lay_over(plan, online, chosen, config)
    if not over.levels or not plan.floors:
        return blank(title, f"{record.reason} Nothing of it can be drawn.", config, heading)
    levels = sorted(over.levels)[: config.max_panels]
    bounds = over.focus(levels)
    storey, frames = plan.floors[over.busiest()], [("", bounds)]
    content = Page(
        title,
        f"{record.reason}\n{figures(chosen, len(online.rooms))}",
        color,
        match_legend([over]),
        _notes(record, solution),
        north(plan.graph),
        CORNER if wants_key_plan(storey, frames) else 0.0,
        heading,
    )
    named = len(plan.floors) > 1
    panels = [Panel(bounds, plan.floors[i].name if named else "") for i in levels]
    page = sheet(content, panels, config)
    for axes, level in zip(page.panels, levels):
        draw_overlay(axes, over, level, bounds, page.points_per_metre, config)
    draw_key_plan(page, storey, frames, color)
    return page.figure


def _apart(content: Page, online: SceneGraph, plan: Building, config: ViewConfig) -> Figure:
    """Both graphs side by side, where no placement explains the one by the other."""
    seen = survey(online, config)
    sides = [(seen, "what was seen"), (plan, "the plan")]
    shown = [(b.floors[0], b.bounds(b.floors[:1]), name) for b, name in sides if b.floors]
    panels = [Panel(box, name, floor.name) for floor, box, name in shown if box is not None]
    if not panels:
        return blank(content.title, content.subtitle, config, content.heading)
    page = sheet(content, panels, config)
    for axes, (floor, _, _) in zip(page.panels, shown):
        draw_floor(axes, floor, page.points_per_metre)
        draw_names(axes, floor.rooms, page.points_per_metre, config)
    return page.figure


def _notes(record: MatchRecord, solution: int) -> tuple[str, ...]:
    notes = []
    if record.count > 1:
        notes.append(f"Solution {solution + 1} of {number(record.count)}.")
    model = record.stats.get("model")
    if model:
        notes.append(
            f"{'Certified' if record.certified else 'Not certified'} under: {plain(model, 300)}"
        )
    return tuple(notes)
