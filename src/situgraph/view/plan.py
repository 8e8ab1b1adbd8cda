"""The drawing of one scene graph: a panel for each storey."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from situgraph.scenegraph.graph import SceneGraph
from situgraph.view import palette
from situgraph.view.config import USUAL, ViewConfig
from situgraph.view.floors import Building, Floor, survey
from situgraph.view.glyphs import glyphs
from situgraph.view.lettering import number, plain
from situgraph.view.marginalia import Key
from situgraph.view.names import draw_names
from situgraph.view.pen import CUT, ENDLESS, NO_WALL, draw_floor
from situgraph.view.sheet import Bounds, Page, Panel, blank, sheet

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_KINDS = {"prior": "A-Graph, from the building model", "online": "S-Graph, from sensors"}


def draw_graph(
    graph: SceneGraph | Building,
    config: ViewConfig = USUAL,
    *,
    storeys: Sequence[str] = (),
    title: str | None = None,
) -> Figure:
    """Draw a scene graph in plan view, one panel for each storey, lowest first.

    Args:
        graph: an A- or S-Graph, drawn in its own frame (x to the right, y up).
        config: sizes and limits.
        storeys: ids or names of the storeys to draw; all when empty.
        title: instead of the graph's name.

    Raises:
        InputError: there is no storey of that name.
    """
    building = graph if isinstance(graph, Building) else survey(graph, config)
    floors = building.chosen(storeys)
    shown = floors[: config.max_panels]
    bounds = building.bounds(shown)
    name = title or building.graph.name or "Scene graph"
    if bounds is None:
        return blank(name, "This graph holds nothing that could be drawn.", config)
    content = Page(
        name,
        summary(building),
        keys=legend(shown),
        notes=_notes(building, shown, floors),
        north=north(building.graph),
    )
    page = sheet(content, captions(shown, bounds), config)
    for axes, floor in zip(page.panels, shown):
        draw_floor(axes, floor, page.points_per_metre)
        draw_names(axes, floor.rooms, page.points_per_metre, config)
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


def legend(floors: Iterable[Floor]) -> tuple[Key, ...]:
    """What occurs on these storeys, with counts."""
    floors = list(floors)
    keys = []
    if any(f.walls.solid for f in floors):
        keys.append(Key("wall", patch=palette.WALL))
    if any(f.walls.one_face for f in floors):
        keys.append(Key("wall, one face known", patch=palette.WALL_ONE, edge=palette.WALL))
    if any(f.walls.loose for f in floors):
        keys.append(Key("face, tick to its free side", line=palette.WALL))
    if any(f.faces.infinite.any() for f in floors):
        keys.append(Key("plane of no room", line=palette.WALL_ONE, dashes=ENDLESS, width=0.8))
    if any(f.faces.virtual.any() for f in floors):
        keys.append(Key("no wall", line=palette.UNEXPLAINED, dashes=NO_WALL))
    if any(s.outline is None or any(s.outline.open) for f in floors for s in f.rooms):
        keys.append(Key("not bounded", line=palette.UNEXPLAINED, dashes=CUT))
    openings = Counter(o.kind for f in floors for o in f.openings)
    if openings["door"]:
        keys.append(Key(f"door {openings['door']}", line=palette.DOOR, width=1.6))
    if openings["window"]:
        keys.append(Key(f"window {openings['window']}", line=palette.WINDOW, width=1.6))
    others = Counter(o.category for f in floors for o in f.objects)
    for name, glyph in glyphs(others).items():
        text = f"{plain(name.replace('_', ' '), 24)} {others[name]}"
        if name in ("door", "window"):
            text += " in no wall"
        keys.append(Key(text, patch=glyph.face, marker=glyph.marker, edge=glyph.edge))
    if any(len(f.path) for f in floors):
        keys.append(Key("path", line=palette.PATH))
    return tuple(keys)


def north(graph: SceneGraph) -> float | None:
    """The direction of true north in the drawing (radians from x), where the graph says it."""
    value = graph.attributes.get("true_north")
    return float(value) if isinstance(value, int | float) else None
