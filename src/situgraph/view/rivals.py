"""Rival placements side by side."""

from __future__ import annotations

from typing import TYPE_CHECKING

from situgraph.scenegraph.graph import SceneGraph
from situgraph.view import palette
from situgraph.view.config import USUAL, ViewConfig
from situgraph.view.floors import Building, survey
from situgraph.view.keyplan import CORNER, draw_key_plan, wants_key_plan
from situgraph.view.legend import match_legend
from situgraph.view.lettering import number, percent
from situgraph.view.overlay import draw_overlay, lay_over
from situgraph.view.plan import north
from situgraph.view.record import Match, Solution, read_record
from situgraph.view.sheet import Page, Panel, blank, sheet
from situgraph.view.wording import difference, figures

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def draw_rivals(
    match: Match, online: SceneGraph, prior: SceneGraph | Building, config: ViewConfig = USUAL,
    *, heading: bool = True,
) -> Figure:  # fmt: skip
    """Draw the solutions of a match side by side, best first, each with what sets it apart.

    Of a solution on several storeys the one with most rooms is drawn.

    Raises:
        InputError: ``match`` is no match JSON.
    """
    record = read_record(match)
    plan = prior if isinstance(prior, Building) else survey(prior, config)
    name = f"{online.name or 'Online graph'} in {plan.graph.name or 'the plan'}"
    shown = record.solutions[: config.max_rivals]
    overs = [lay_over(plan, online, s, config) for s in shown]
    if not overs or not plan.floors or not all(o.levels for o in overs):
        return blank(f"{name}: {record.verdict}", record.reason, config, heading)
    levels = [o.busiest() for o in overs]
    bounds = [o.focus([level]) for o, level in zip(overs, levels)]
    panels = []
    for i, (solution, level, box) in enumerate(zip(shown, levels, bounds)):
        words = [plan.floors[level].name if len(plan.floors) > 1 else ""]
        words.append(
            difference(shown[0], solution, online) if i else figures(solution, len(online.rooms))
        )
        panels.append(Panel(box, _rank(i, solution), "  ·  ".join(w for w in words if w)))
    here = [(str(i + 1), b) for i, (b, n) in enumerate(zip(bounds, levels)) if n == levels[0]]
    storey, color = plan.floors[levels[0]], palette.VERDICTS[record.verdict]
    fit = f"{number(record.count)} placements fit" if record.count > 1 else "one placement fits"
    rest = f"\nThe {len(shown)} most probable are drawn." if record.count > len(shown) else ""
    content = Page(
        f"{name}: {fit}",
        record.reason + rest,
        color,
        match_legend(overs),
        north=north(plan.graph),
        corner=CORNER if wants_key_plan(storey, here) else 0.0,
        heading=heading,
    )
    page = sheet(content, panels, config)
    for axes, over, level, box in zip(page.panels, overs, levels, bounds):
        draw_overlay(axes, over, level, box, page.points_per_metre, config)
    draw_key_plan(page, storey, here, color)
    return page.figure


def _rank(index: int, solution: Solution) -> str:
    if solution.probability is None:
        return f"{index + 1}"
    return f"{index + 1}   {percent(solution.probability)}"
