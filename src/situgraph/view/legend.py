"""What occurs in a drawing, as legend entries."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence

from situgraph.view import palette
from situgraph.view.floors import Floor
from situgraph.view.glyphs import glyphs
from situgraph.view.lettering import plain
from situgraph.view.marginalia import Key
from situgraph.view.overlay import HATCH, Overlay
from situgraph.view.pen import CUT, ENDLESS, NO_WALL, READABLE_OBJECT
from situgraph.view.walls import Walls


def plan_legend(floors: Iterable[Floor], scale: float) -> tuple[Key, ...]:
    """What is drawn of these storeys at ``scale`` (points a metre), with counts."""
    floors = list(floors)
    keys = []
    if any(f.walls.solid for f in floors):
        keys.append(Key("wall", patch=palette.WALL))
    if any(f.walls.one_face for f in floors):
        keys.append(Key("wall, one face known", patch=palette.WALL_ONE, edge=palette.WALL))
    if any(f.faces.in_room.any() and f.walls == Walls() for f in floors):
        keys.append(Key("face of a wall", line=palette.WALL))
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
    if others and scale < READABLE_OBJECT:
        keys.append(Key(f"{sum(others.values())} objects, too small to draw"))
        others.clear()
    for name, glyph in glyphs(others).items():
        text = f"{plain(name.replace('_', ' '), 24)} {others[name]}"
        if name in ("door", "window"):
            text += " in no wall"
        keys.append(Key(text, patch=glyph.face, marker=glyph.marker, edge=glyph.edge))
    if any(len(f.path) for f in floors):
        keys.append(Key("path", line=palette.PATH))
    return tuple(keys)


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
