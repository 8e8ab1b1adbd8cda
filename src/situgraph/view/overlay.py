"""An online graph laid over its prior by one solution of a match, and the drawing of it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import msgspec
import numpy as np

from situgraph.geometry.poses import Array
from situgraph.scenegraph.graph import Object, SceneGraph
from situgraph.view import palette
from situgraph.view.config import ViewConfig
from situgraph.view.floors import Building, Floor, Shape, cropped, survey
from situgraph.view.glyphs import glyphs
from situgraph.view.lettering import metres
from situgraph.view.names import draw_names
from situgraph.view.pen import CUT, UNDER, draw_floor, draw_path, fill_polygons, open_edges, strokes
from situgraph.view.placed import placed
from situgraph.view.record import Solution
from situgraph.view.sheet import Bounds

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_TINT = 0.2  # opacity of a room's colour, twice over where both graphs have it
_AROUND = 0.3  # of the online graph's size, shown around it
_MOST = 4.0  # a plan so many times larger than what was seen is cropped
_BEYOND = 3.0  # m, drawn outside a cropped view, so that walls at its edge are whole
HATCH = "/////"


class Overlay(msgspec.Struct, frozen=True):
    """Both graphs in the building frame.

    ``colors`` and ``plan_colors`` hold the colour of each matched room by its S- and its A-id;
    ``levels`` the online storeys drawn on each of the prior's, by position.
    """

    prior: Building
    online: Building
    solution: Solution
    colors: dict[str, str]
    plan_colors: dict[str, str]
    levels: dict[int, tuple[Floor, ...]]

    def floors(self) -> list[Floor]:
        """The prior storeys on which something was seen, lowest first."""
        return [self.prior.floors[i] for i in sorted(self.levels)]

    def busiest(self) -> int:
        """The prior storey with the most rooms seen, by position."""
        return max(sorted(self.levels), key=lambda i: sum(len(f.rooms) for f in self.levels[i]))

    def focus(self, levels: Iterable[int]) -> Bounds:
        """What to show (m): the whole plan, or what was seen where that is a small part."""
        seen = [f.points() for i in levels for f in self.levels[i]]
        points = np.concatenate(seen)
        low, high = points.min(axis=0), points.max(axis=0)
        margin = np.maximum(_AROUND * (high - low), 2.0)
        near = np.stack([low - margin, high + margin])
        whole = self.prior.bounds([self.prior.floors[i] for i in levels])
        if whole is not None:
            limits = np.stack([np.minimum(whole[:2], low), np.maximum(whole[2:], high)])
            if np.prod(np.ptp(limits, axis=0)) < _MOST * np.prod(np.ptp(near, axis=0)):
                near = limits
            near = np.stack([np.maximum(near[0], limits[0]), np.minimum(near[1], limits[1])])
        (x0, y0), (x1, y1) = near.tolist()
        return x0, y0, x1, y1


def lay_over(
    prior: Building, online: SceneGraph, solution: Solution, config: ViewConfig
) -> Overlay:
    """Move the online graph into the building frame and sort it onto the prior's storeys."""
    moved = survey(placed(online, solution), config)
    order = [r.id for r in online.rooms if r.id in solution.rooms]
    colors = {id: palette.MATCH[i % len(palette.MATCH)] for i, id in enumerate(order)}
    plan_colors = {}
    for id, color in colors.items():
        for room in (solution.rooms[id], *solution.also_covers.get(id, ())):
            plan_colors[room] = color
    levels: dict[int, list[Floor]] = {}
    for floor in moved.floors:
        levels.setdefault(_level(prior, floor, solution), []).append(floor)
    return Overlay(
        prior, moved, solution, colors, plan_colors, {i: tuple(f) for i, f in levels.items()}
    )


def _level(prior: Building, floor: Floor, solution: Solution) -> int:
    """The prior storey an online one lies on: as matched, by its rooms, or by its height."""
    keys = [f.key for f in prior.floors]
    matched = solution.storeys.get(floor.key or "")
    if matched in keys:
        return keys.index(matched)
    home = {s.id: i for i, f in enumerate(prior.floors) for s in f.rooms}
    votes = Counter(
        home[solution.rooms[s.id]] for s in floor.rooms if solution.rooms.get(s.id) in home
    )
    if votes:
        return min(votes, key=lambda i: (-votes[i], i))
    heights = [abs(f.elevation - floor.elevation) for f in prior.floors]
    return heights.index(min(heights)) if heights else 0


def draw_overlay(
    axes: Axes, over: Overlay, level: int, bounds: Bounds, scale: float, config: ViewConfig
) -> None:
    """The plan of a storey in grey, and on it what was seen of it, in colour."""
    plan = over.prior.floors[level]
    x0, y0, x1, y1 = bounds
    size = np.ptp(plan.points(), axis=0)
    if (x1 - x0) * (y1 - y0) < 0.5 * np.prod(size):
        plan = cropped(plan, (x0 - _BEYOND, y0 - _BEYOND, x1 + _BEYOND, y1 + _BEYOND))
    draw_floor(axes, plan, scale, UNDER)
    _tint(axes, plan.rooms, over.plan_colors)
    for floor in over.levels.get(level, ()):
        _tint(axes, floor.rooms, over.colors)
        _unexplained(axes, floor, over)
        _planes(axes, floor, over)
        _moved(axes, floor, plan, over, scale)
        _objects(axes, floor, over, scale)
        draw_path(axes, floor.path)
    others = [s for s in plan.rooms if s.id not in over.plan_colors]
    draw_names(axes, others, scale, config, palette.MUTED)
    draw_names(axes, [s for s in plan.rooms if s.id in over.plan_colors], scale, config)


def _tint(axes: Axes, shapes: Sequence[Shape], colors: dict[str, str]) -> None:
    drawn = [(s.outline.polygon, colors.get(s.id)) for s in shapes if s.outline is not None]
    known = [(polygon, color) for polygon, color in drawn if color is not None]
    fill_polygons(axes, [p for p, _ in known], [c for _, c in known], 1.3, alpha=_TINT)


def _unexplained(axes: Axes, floor: Floor, over: Overlay) -> None:
    alone = [s for s in floor.rooms if s.id not in over.colors]
    polygons = [s.outline.polygon for s in alone if s.outline is not None]
    dots = np.array([s.center for s in alone if s.outline is None]).reshape(-1, 2)
    axes.scatter(dots[:, 0], dots[:, 1], s=90.0, facecolors="none", hatch=HATCH, linewidths=0.7,
                 edgecolors=palette.UNEXPLAINED, zorder=4.9)  # fmt: skip
    fill_polygons(axes, polygons, "none", 4.9, palette.UNEXPLAINED, 0.0, hatch=HATCH)
    cut = open_edges(s.outline for s in floor.rooms if s.outline is not None)
    strokes(axes, cut, palette.ONLINE, 0.6, 5.0, CUT)


def _planes(axes: Axes, floor: Floor, over: Overlay) -> None:
    """Planes with a counterpart in blue, the others grey."""
    moved = {d.plane for d in over.solution.deviations}
    faces = floor.faces.only(~floor.faces.infinite)
    fits = np.array(
        [id in over.solution.planes and id not in moved for id in faces.ids], dtype=bool
    )
    alone = np.array([id not in over.solution.planes for id in faces.ids], dtype=bool)
    strokes(axes, faces.only(fits).segments, palette.ONLINE, 1.7, 5.1)
    strokes(axes, faces.only(alone).segments, palette.UNEXPLAINED, 1.2, 5.0, (2.5, 1.5))


def _moved(axes: Axes, floor: Floor, plan: Floor, over: Overlay, scale: float) -> None:
    """Moved walls in red where they were seen and, dashed, where they were planned."""
    longest, normals = _longest(floor), dict(zip(floor.faces.ids, floor.faces.normals))
    planned = _longest(plan)
    for deviation in over.solution.deviations:
        seen = longest.get(deviation.plane)
        if seen is None:
            continue
        strokes(axes, [seen], palette.MOVED, 2.2, 5.3)
        before = planned.get(over.solution.planes.get(deviation.plane, ""))
        if before is not None:
            strokes(axes, [before], palette.MOVED, 0.9, 5.2, (2.0, 1.4))
        along = (seen[1] - seen[0]) / max(float(np.linalg.norm(seen[1] - seen[0])), 1e-9)
        turn = float(np.degrees(np.arctan2(along[1], along[0])))
        # The label stands in the wall's own room: its other face may have moved as well.
        x, y = seen.mean(axis=0) + normals[deviation.plane] * 9.0 / scale
        axes.text(
            x, y, f"{'+' if deviation.offset > 0 else ''}{metres(deviation.offset)}", fontsize=7.5,
            color=palette.MOVED, ha="center", va="center", zorder=7.0, clip_on=True,
            rotation=(turn + 90.0) % 180.0 - 90.0, rotation_mode="anchor", fontweight="bold",
            bbox={"facecolor": palette.PAPER, "edgecolor": "none", "alpha": 0.85, "pad": 0.8},
        )  # fmt: skip


def _longest(floor: Floor) -> dict[str, Array]:
    """The longest segment of each plane of a storey."""
    found: dict[str, Array] = {}
    for id, segment in zip(floor.faces.ids, floor.faces.segments):
        if id not in found or np.linalg.norm(np.diff(segment, axis=0)) > np.linalg.norm(
            np.diff(found[id], axis=0)
        ):
            found[id] = segment
    return found


def _objects(axes: Axes, floor: Floor, over: Overlay, scale: float) -> None:
    """A symbol for every object: filled where it has a counterpart, hollow where not."""
    ids = {o.id for o in floor.openings} | {o.id for o in floor.objects}
    seen = [o for o in over.online.graph.objects if o.id in ids]
    size = float(np.clip(0.34 * scale, 3.0, 7.0))
    for name, glyph in glyphs(o.category for o in seen).items():
        for known in (True, False):
            at = _centers(seen, name, over, known)
            face, edge = (glyph.edge, palette.PAPER) if known else (palette.PAPER, glyph.edge)
            axes.scatter(at[:, 0], at[:, 1], s=size**2, marker=glyph.marker, facecolors=face,
                         edgecolors=edge, linewidths=0.7 if known else 1.1, zorder=5.6)  # fmt: skip


def _centers(objects: Sequence[Object], category: str, over: Overlay, known: bool) -> Array:
    matched = over.solution.objects
    found = [o.center[:2] for o in objects if o.category == category and (o.id in matched) == known]
    return np.array(found, dtype=float).reshape(-1, 2)
