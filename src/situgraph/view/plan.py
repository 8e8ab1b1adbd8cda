"""The drawing of one scene graph: a panel for each storey."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import TYPE_CHECKING

from situgraph.scenegraph.graph import SceneGraph
from situgraph.view.axonometry import draw_stack
from situgraph.view.config import USUAL, ViewConfig
from situgraph.view.floors import Building, Floor, survey
from situgraph.view.legend import plan_legend
from situgraph.view.lettering import number
from situgraph.view.names import draw_names
from situgraph.view.pen import draw_floor
from situgraph.view.sheet import Bounds, Page, Panel, blank, drawing_scale, sheet

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_KINDS = {"prior": "A-Graph, from the building model", "online": "S-Graph, from sensors"}


def draw_graph(
    graph: SceneGraph | Building,
    config: ViewConfig = USUAL,
    *,
    storeys: Sequence[str] = (),
    title: str | None = None,
    heading: bool = True,
) -> Figure:
    """Draw a scene graph in plan view, one panel for each storey, lowest first.

    Args:
        graph: an A- or S-Graph, drawn in its own frame (x to the right, y up).
        config: sizes and limits.
        storeys: ids or names of the storeys to draw; all when empty.
        title: instead of the graph's name.
        heading: whether the picture carries its title.

    Raises:
        InputError: there is no storey of that name.
    """
    building = graph if isinstance(graph, Building) else survey(graph, config)
    floors = building.chosen(storeys)
    shown = floors[: config.max_panels]
    bounds = building.bounds(shown)
    name = title or building.graph.name or "Scene graph"
    if bounds is None:
        return blank(name, "This graph holds nothing that could be drawn.", config, heading)
    panels = captions(shown, bounds)
    content = Page(
        name,
        summary(building),
        keys=plan_legend(shown, drawing_scale(panels, config)),
        notes=_notes(building, shown, floors),
        north=north(building.graph),
        heading=heading,
    )
    page = sheet(content, panels, config)
    for axes, floor in zip(page.panels, shown):
        draw_floor(axes, floor, page.points_per_metre)
        draw_names(axes, floor.rooms, page.points_per_metre, config)
    if page.spare is not None and len(shown) > 1:
        draw_stack(page, page.spare, shown)
    return page.figure


def summary(building: Building) -> str:
    """One line: what kind of graph, and how much of what."""
    graph = building.graph
    counts = [
        _count(len(building.floors), "storey") if graph.storeys else "",
        _count(len(graph.rooms), "room"),
        _count(len(graph.planes), "plane"),
        _count(len(graph.objects), "object"),
        _count(len(graph.keyframes), "keyframe") if graph.keyframes else "",
    ]
    return f"{_KINDS[graph.kind]}  ·  " + "  ·  ".join(c for c in counts if c)


def _count(count: int, thing: str) -> str:
    plural = thing if count == 1 else f"{thing}s"
    return f"{number(count)} {plural}"


def captions(floors: Sequence[Floor], bounds: Bounds) -> list[Panel]:
    """Name, elevation and rooms of each storey; nothing for the only floor of a graph without."""
    if [f.key for f in floors] == [None]:
        return [Panel(bounds)]
    rooms = [_count(len(f.rooms), "room") for f in floors]
    return [
        Panel(
            bounds, f.name or "no storey", r if f.key is None else f"{f.elevation:+.2f} m  ·  {r}"
        )
        for f, r in zip(floors, rooms)
    ]


def _notes(building: Building, shown: Sequence[Floor], floors: Sequence[Floor]) -> tuple[str, ...]:
    notes = []
    if len(shown) < len(floors):
        notes.append(
            f"{len(floors) - len(shown)} further storeys are not drawn; choose with --storey."
        )
    if building.graph.warnings:
        codes = Counter(w.code for w in building.graph.warnings)
        listed = ", ".join(f"{code} {count}" for code, count in codes.most_common(6))
        notes.append(f"{_count(len(building.graph.warnings), 'warning')}: {listed}")
    return tuple(notes)


def north(graph: SceneGraph) -> float | None:
    """The direction of true north in the drawing (radians from x), where the graph says it."""
    value = graph.attributes.get("true_north")
    return float(value) if isinstance(value, int | float) else None
