"""The plan-view outline of every room: its footprint, or what its planes enclose.

Planes of a room without a footprint are infinite lines in the plan. They are cut at each other in
the order given, if that closes a polygon whose inside is where the normals point; else the outline
is the cut of their half-planes around the room's centre. A side that no plane bounds (a corridor's
ends) is cut where the ray from the centre meets a neighbour's wall, or after a fixed reach.
"""

from __future__ import annotations

import math

import msgspec
import numpy as np

from situgraph.geometry.planes import from_footprint
from situgraph.geometry.poses import Array
from situgraph.scenegraph.graph import Room, SceneGraph
from situgraph.view.config import ViewConfig

_VERTICAL = 0.7  # a plane whose normal has a shorter horizontal part is no wall
_CROSSING = 0.3  # sine of the smallest angle at which two lines make a corner
_SEARCH = 8.0  # m, how far the ray from the centre looks for a neighbour's wall
_WALL = 0.15  # m, left for the wall between that neighbour's face and the room


class Outline(msgspec.Struct, frozen=True):
    """A counter-clockwise polygon (n, 2) in metres.

    ``sides[i]`` is the id of the plane on the edge from vertex i to i + 1; None where that is not
    known (footprints) or where nothing bounds the room (``open``).
    """

    polygon: Array
    sides: tuple[str | None, ...]
    derived: bool = False

    @property
    def open(self) -> tuple[bool, ...]:
        """Which edges are cut off rather than observed."""
        return tuple(self.derived and side is None for side in self.sides)


class _Line(msgspec.Struct, frozen=True):
    id: str
    x: float
    y: float
    offset: float
    ends: tuple[tuple[float, float], ...] = ()

    def side(self, x: float, y: float) -> float:
        return self.x * x + self.y * y + self.offset


def room_outlines(graph: SceneGraph, config: ViewConfig) -> dict[str, Outline]:
    """Outlines by room id; a room without any vertical plane or footprint has none."""
    found: dict[str, Outline] = {}
    waiting: list[tuple[Room, list[_Line]]] = []
    for room in graph.rooms:
        if room.footprint is not None and len(room.footprint) >= 3:
            found[room.id] = _given(np.array(room.footprint, dtype=float))
            continue
        lines = _lines(graph, room)
        outline = _around(lines) or _enclosed(room, lines)
        if outline is not None:
            found[room.id] = outline
        elif lines:
            waiting.append((room, lines))
    if waiting:
        found.update(_opened(waiting, list(found.values()), config))
    return found


def _given(polygon: Array) -> Outline:
    x, y = polygon.T
    area = float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))
    return Outline(polygon if area >= 0.0 else polygon[::-1], (None,) * len(polygon))


def _lines(graph: SceneGraph, room: Room) -> list[_Line]:
    lines = []
    for id in room.planes:
        plane = graph.plane_by_id[id]
        x, y, _ = plane.normal
        length = math.hypot(x, y)
        if length >= _VERTICAL:
            # The plane's cut at the room's height: a tilted wall is where the room sees it.
            offset = (plane.offset + plane.normal[2] * room.center[2]) / length
            lines.append(_Line(id, x / length, y / length, offset, plane.extent or ()))
    return lines


def _around(lines: list[_Line]) -> Outline | None:
    """The polygon of consecutive lines, if they were given in order around the room."""
    if len(lines) < 3:
        return None
    corners = []
    for before, line in zip([lines[-1], *lines[:-1]], lines):
        cross = before.x * line.y - before.y * line.x
        if abs(cross) < _CROSSING:
            return None
        x = (before.y * line.offset - line.y * before.offset) / cross
        y = (line.x * before.offset - before.x * line.offset) / cross
        corners.append((x, y))
    polygon, ids = np.array(corners), [line.id for line in lines]
    normals = np.array([(line.x, line.y) for line in lines])
    x, y = polygon.T
    if float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))) < 0.0:
        polygon, ids, normals = polygon[::-1], ids[-2::-1] + ids[-1:], normals[::-1]
        normals = np.roll(normals, -1, axis=0)
    if np.min(np.linalg.norm(np.roll(polygon, -1, axis=0) - polygon, axis=1)) < 0.05:
        return None
    inside, _ = from_footprint(polygon)
    if np.min(np.sum(inside * normals, axis=1)) < 0.9 or not _simple(polygon):
        return None
    return Outline(polygon, tuple(ids), derived=True)


def _simple(polygon: Array) -> bool:
    import shapely

    return bool(shapely.is_valid(shapely.polygons(polygon)))


def _enclosed(room: Room, lines: list[_Line]) -> Outline | None:
    """The cut of the half-planes around the centre, if it is bounded."""
    facing = [line for line in lines if line.side(*room.center[:2]) > 0.0]
    if len(facing) < 3:
        return None
    reach = 3.0 * max(line.side(*room.center[:2]) for line in facing) + 5.0
    outline = _cut(room, facing, (reach, reach, reach, reach))
    return None if outline is None or any(outline.open) else outline


def _cut(room: Room, lines: list[_Line], reach: tuple[float, ...]) -> Outline | None:
    """The box of ``reach`` along the first line's axes, cut by every line."""
    points = _box(room, lines, reach)
    labels: list[str | None] = [None] * 4
    for line in lines:
        points, labels = _clip(points, labels, line)
        if len(points) < 3:
            return None
    return Outline(np.array(points), tuple(labels), derived=True)


def _axes(lines: list[_Line]) -> tuple[tuple[float, float], ...]:
    """Four directions: along the first line's normal, its left, and back."""
    x, y = (lines[0].x, lines[0].y) if lines else (1.0, 0.0)
    return ((x, y), (-y, x), (-x, -y), (y, -x))


def _box(room: Room, lines: list[_Line], reach: tuple[float, ...]) -> list[tuple[float, float]]:
    (ux, uy), (vx, vy), *_ = _axes(lines)
    east, north, west, south = reach
    corners = ((-west, -south), (east, -south), (east, north), (-west, north))
    cx, cy = room.center[:2]
    return [(cx + a * ux + b * vx, cy + a * uy + b * vy) for a, b in corners]


def _clip(
    points: list[tuple[float, float]], labels: list[str | None], line: _Line
) -> tuple[list[tuple[float, float]], list[str | None]]:
    """Sutherland-Hodgman against one line; ``labels`` name the edge that starts at each vertex."""
    kept: list[tuple[float, float]] = []
    names: list[str | None] = []
    sides = [line.side(x, y) for x, y in points]
    for i, a in enumerate(points):
        j = (i + 1) % len(points)
        inside, next_inside = sides[i] >= 0.0, sides[j] >= 0.0
        if inside:
            kept.append(a)
            names.append(labels[i])
        if inside != next_inside:
            t = sides[i] / (sides[i] - sides[j])
            b = points[j]
            kept.append((a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])))
            names.append(line.id if inside else labels[i])
    return kept, names


def _opened(
    waiting: list[tuple[Room, list[_Line]]], known: list[Outline], config: ViewConfig
) -> dict[str, Outline]:
    """Outlines of rooms that their planes leave open."""
    free = _free_ways(waiting, known)
    found = {}
    for (room, lines), ways in zip(waiting, free):
        facing = [line for line in lines if line.side(*room.center[:2]) > 0.0] or lines
        reach = tuple(
            _reach(room, facing, axis, way, config.open_reach)
            for axis, way in zip(_axes(lines), ways)
        )
        outline = _cut(room, facing, reach)
        if outline is not None:
            found[room.id] = outline
    return found


def _reach(
    room: Room, lines: list[_Line], axis: tuple[float, float], way: float, usual: float
) -> float:
    """How far the box goes along ``axis``: past an own plane, along an own extent, or ``way``."""
    cx, cy = room.center[:2]
    for line in lines:
        slope = line.x * axis[0] + line.y * axis[1]
        if slope < -0.7:
            return -line.side(cx, cy) / slope * 1.5 + 1.0
    seen = [(x - cx) * axis[0] + (y - cy) * axis[1] for line in lines for x, y in line.ends]
    if seen:
        return max(max(seen), 0.3)
    return max(way - _WALL, 0.3) if math.isfinite(way) else usual


def _free_ways(waiting: list[tuple[Room, list[_Line]]], known: list[Outline]) -> Array:
    """Distances (rooms, 4) from each centre along its axes to the nearest known wall, or inf."""
    import shapely

    ways = np.full((len(waiting), 4), np.inf)
    if not known:
        return ways
    walls = np.concatenate(
        [np.stack([o.polygon, np.roll(o.polygon, -1, axis=0)], axis=1) for o in known]
    )
    starts = np.repeat([r.center[:2] for r, _ in waiting], 4, axis=0)
    axes = np.array([_axes(lines) for _, lines in waiting]).reshape(-1, 2)
    rays = shapely.linestrings(np.stack([starts, starts + _SEARCH * axes], axis=1))
    lines = shapely.linestrings(walls)
    ray, wall = shapely.STRtree(lines).query(rays, predicate="intersects")
    meets = shapely.distance(
        shapely.points(starts[ray]), shapely.intersection(rays[ray], lines[wall])
    )
    np.minimum.at(ways.reshape(-1), ray[meets > 0.3], meets[meets > 0.3])
    return ways
