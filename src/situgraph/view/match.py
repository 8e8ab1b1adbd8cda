"""The drawing of a match: the online graph over its plan, and rival placements side by side."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from situgraph.geometry.poses import wrap_angle
from situgraph.scenegraph.graph import SceneGraph
from situgraph.view import palette
from situgraph.view.config import USUAL, ViewConfig
from situgraph.view.floors import Building, survey
from situgraph.view.glyphs import glyphs
from situgraph.view.keyplan import draw_key_plan
from situgraph.view.lettering import metres, number, percent, plain
from situgraph.view.marginalia import Key
from situgraph.view.names import draw_names
from situgraph.view.overlay import HATCH, Overlay, draw_overlay, lay_over
from situgraph.view.pen import draw_floor
from situgraph.view.plan import north
from situgraph.view.record import HasDict, MatchRecord, Solution, read_record
from situgraph.view.sheet import Bounds, Page, Panel, blank, sheet

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Match = Mapping[str, Any] | HasDict | MatchRecord

VERDICT_COLORS = {"unique": palette.GOOD, "ambiguous": palette.ADVICE, "none": palette.MOVED}
_CORNER = 2.0  # inch, for the key plan


def draw_match(
    match: Match,
    online: SceneGraph,
    prior: SceneGraph | Building,
    config: ViewConfig = USUAL,
    *,
    solution: int = 0,
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

    Raises:
        InputError: ``match`` is no match JSON.
    """
    record = read_record(match)
    plan = prior if isinstance(prior, Building) else survey(prior, config)
    title = f"{online.name or 'Online graph'} in {plan.graph.name or 'the plan'}"
    color = VERDICT_COLORS[record.verdict]
    if not solution < len(record.solutions):
        return _apart(record, online, plan, title, config)
    chosen = record.solutions[solution]
    over = lay_over(plan, online, chosen, config)
    if not over.levels:
        return blank(
            title, f"{record.verdict}: {record.reason} Nothing of it can be drawn.", config
        )
    levels = sorted(over.levels)[: config.max_panels]
    bounds = over.focus(levels)
    content = Page(
        f"{title}: {record.verdict}",
        f"{record.reason}\n{figures(chosen, len(online.rooms))}",
        color,
        match_legend([over]),
        _notes(record, solution),
        north(plan.graph),
        _CORNER,
    )
    named = plan.graph.storeys and len(plan.floors) > 1
    panels = [Panel(bounds, plan.floors[i].name if named else "") for i in levels]
    page = sheet(content, panels, config)
    for axes, level in zip(page.panels, levels):
        draw_overlay(axes, over, level, bounds, page.points_per_metre, config)
    draw_key_plan(page, plan.floors[over.busiest()], [("", bounds)], color)
    return page.figure


def draw_rivals(
    match: Match, online: SceneGraph, prior: SceneGraph | Building, config: ViewConfig = USUAL
) -> Figure:
    """Draw the solutions of a match side by side, best first, each with what sets it apart.

    Raises:
        InputError: ``match`` is no match JSON.
    """
    record = read_record(match)
    plan = prior if isinstance(prior, Building) else survey(prior, config)
    title = f"{online.name or 'Online graph'} in {plan.graph.name or 'the plan'}"
    shown = record.solutions[: config.max_rivals]
    if not shown or not plan.floors:
        return blank(title, f"{record.verdict}: {record.reason}", config)
    overs = [lay_over(plan, online, s, config) for s in shown]
    if not all(o.levels for o in overs):
        return blank(title, "The online graph holds nothing that could be drawn.", config)
    levels = [o.busiest() for o in overs]
    bounds = [o.focus([level]) for o, level in zip(overs, levels)]
    panels = []
    for i, (over, level, box) in enumerate(zip(overs, levels, bounds)):
        name = (
            f"{i + 1}   {percent(over.solution.probability)}"
            if over.solution.probability is not None
            else f"{i + 1}"
        )
        note = (
            figures(over.solution, len(online.rooms))
            if i == 0
            else difference(shown[0], over.solution, online)
        )
        storey = plan.floors[level].name if len(plan.floors) > 1 else ""
        panels.append(Panel(box, name, "  ·  ".join(filter(None, (storey, note)))))
    rest = record.count - len(shown)
    heading = f"{number(record.count)} placements fit" if record.count > 1 else "one placement fits"
    subtitle = record.reason + (f"\nThe {len(shown)} most probable are drawn." if rest > 0 else "")
    content = Page(f"{title}: {heading}", subtitle, VERDICT_COLORS[record.verdict],
                   match_legend(overs), (), north(plan.graph), _CORNER)  # fmt: skip
    page = sheet(content, panels, config)
    for axes, over, level, box in zip(page.panels, overs, levels, bounds):
        draw_overlay(axes, over, level, box, page.points_per_metre, config)
    here = [
        (str(i + 1), box)
        for i, (box, level) in enumerate(zip(bounds, levels))
        if level == levels[0]
    ]
    draw_key_plan(page, plan.floors[levels[0]], here, VERDICT_COLORS[record.verdict])
    return page.figure


def _apart(
    record: MatchRecord, online: SceneGraph, plan: Building, title: str, config: ViewConfig
) -> Figure:
    """Both graphs side by side, where no placement explains the one by the other."""
    seen = survey(online, config)
    graphs = [(b, b.floors[0]) for b in (seen, plan) if b.floors]
    boxes: list[Bounds] = [b for b in (g.bounds([f]) for g, f in graphs) if b is not None]
    if len(boxes) < 2:
        return blank(f"{title}: {record.verdict}", record.reason, config)
    names = (
        "what was seen",
        f"the plan{', ' + plan.floors[0].name if len(plan.floors) > 1 else ''}",
    )
    panels = [Panel(box, name) for box, name in zip(boxes, names)]
    content = Page(f"{title}: {record.verdict}", record.reason, VERDICT_COLORS[record.verdict])
    page = sheet(content, panels, config)
    for axes, (_, floor) in zip(page.panels, graphs):
        draw_floor(axes, floor, page.points_per_metre)
        draw_names(axes, floor.rooms, page.points_per_metre, config)
    return page.figure


def figures(solution: Solution, rooms: int) -> str:
    """One line: rooms explained, probability, fit, moved walls."""
    parts = [f"{len(solution.rooms)} of {rooms} rooms explained"]
    if solution.probability is not None:
        parts.append(f"probability {percent(solution.probability)}")
    if solution.rms is not None:
        parts.append(f"residual {metres(solution.rms)} rms")
    if solution.objects:
        parts.append(f"{len(solution.objects)} objects agree")
    if solution.deviations:
        parts.append(f"{len(solution.deviations)} wall{'s' * (len(solution.deviations) > 1)} moved")
    return "  ·  ".join(parts)


def difference(best: Solution, other: Solution, online: SceneGraph) -> str:
    """What sets a rival apart from the best solution, in a few words."""
    parts = []
    turn = math.degrees(abs(float(wrap_angle(other.transform.yaw - best.transform.yaw))))
    if turn > 1.0:
        parts.append(f"turned {turn:.0f}°")
    centers = np.array([r.center for r in online.rooms], dtype=float).reshape(-1, 3)
    if len(centers):
        step = other.transform.points(centers).mean(axis=0) - best.transform.points(centers).mean(
            axis=0
        )
        if np.linalg.norm(step[:2]) > 0.3:
            parts.append(f"{np.linalg.norm(step[:2]):.1f} m away")
        if abs(step[2]) > 0.8:
            parts.append("other storey")
    elsewhere = sum(1 for r, a in best.rooms.items() if other.rooms.get(r) != a)
    if elsewhere:
        parts.append(f"{elsewhere} of {len(best.rooms)} rooms elsewhere")
    for count, reference, what in (
        (len(other.rooms), len(best.rooms), "rooms"),
        (len(other.objects), len(best.objects), "objects"),
        (len(other.deviations), len(best.deviations), "moved walls"),
    ):
        if count != reference:
            parts.append(f"{count} {what} (not {reference})")
    return ", ".join(parts) or "the same but for residuals"


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


def match_legend(overs: Sequence[Overlay]) -> tuple[Key, ...]:
    """What occurs in the overlays."""
    keys = [Key("wall of the plan", patch=palette.WALL_ONE)]
    solutions = [o.solution for o in overs]
    if any(s.rooms for s in solutions):
        keys.append(Key("room seen and its counterpart", patch=palette.MATCH[0], alpha=0.45))
    if any(r.id not in o.colors for o in overs for r in o.online.graph.rooms):
        keys.append(Key("unexplained room", hatch=HATCH, edge=palette.UNEXPLAINED))
    if any(s.planes for s in solutions):
        keys.append(Key("face seen", line=palette.ONLINE, width=1.8))
    if any(p.id not in o.solution.planes for o in overs for p in o.online.graph.planes):
        keys.append(Key("face without counterpart", line=palette.UNEXPLAINED, dashes=(2.5, 1.5)))
    if any(s.deviations for s in solutions):
        keys.append(Key("moved wall", line=palette.MOVED, width=2.2))
        keys.append(Key("where it was planned", line=palette.MOVED, width=0.9, dashes=(2.0, 1.4)))
    seen = overs[0].online.graph.objects
    for name, glyph in glyphs(o.category for o in seen).items():
        text = plain(name.replace("_", " "), 24)
        if any(o.category == name and o.id in s.objects for s in solutions for o in seen):
            keys.append(Key(f"{text} seen", patch=glyph.edge, marker=glyph.marker, edge=glyph.edge))
        if any(o.category == name and o.id not in s.objects for s in solutions for o in seen):
            keys.append(Key(f"{text} without counterpart", marker=glyph.marker, edge=glyph.edge))
    if overs[0].online.graph.keyframes:
        keys.append(Key("path", line=palette.PATH))
    return tuple(keys)
