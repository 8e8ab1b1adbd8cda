"""The walls between and around the rooms of a graph, as straight pieces in the plan view."""

from __future__ import annotations

from typing import TYPE_CHECKING

import msgspec
import numpy as np

from situgraph.geometry.poses import Array
from situgraph.plan.contacts import Faces, faces_of, find_contacts, free_stretches
from situgraph.scenegraph.graph import Object, SceneGraph, Vec2

if TYPE_CHECKING:
    from shapely import Polygon

# Two faces this close (m), back to back, are the sides of one wall.
THICKEST_WALL = 0.6
# Outer walls that no door or window says the thickness of (m).
OUTER_WALL = 0.25
# Shorter pieces (m) are the ends of other walls.
SHORTEST = 0.3


class WallPiece(msgspec.Struct, frozen=True):
    """A straight piece of wall along face ``a``, from ``low`` to ``high`` metres of it.

    ``a`` and ``b`` are plane ids (``b`` None: the outside); ``start`` and ``direction`` place the
    face in the plan view, its room to the left; ``thickness`` (m) lies to the right. ``outline``
    is the plan of the piece with its ends run into the walls it meets.
    """

    storey: int
    a: str
    b: str | None
    start: Vec2
    direction: Vec2
    low: float
    high: float
    thickness: float
    outline: tuple[Vec2, ...]

    def along(self, point: Vec2) -> float:
        """How far (m) along face ``a`` a plan-view point lies."""
        dx, dy = point[0] - self.start[0], point[1] - self.start[1]
        return dx * self.direction[0] + dy * self.direction[1]


def wall_pieces(graph: SceneGraph) -> tuple[WallPiece, ...]:
    """The walls of a graph whose rooms have footprints and whose planes have extents.

    Inner walls fill the gap between two faces; outer walls are as thick as their openings say
    (whose middle is the wall's), else as the others are, 0.25 m where nothing says. Storeys are
    numbered as in ``faces_of``.
    """
    faces, names = faces_of(graph)
    contacts = find_contacts(faces, THICKEST_WALL, SHORTEST)
    thickness = _outer_thickness(graph, faces, names)
    length = faces.length
    usual = float(np.median(list(thickness.values()))) if thickness else OUTER_WALL
    reach = max([usual, *thickness.values(), *contacts.gap.tolist()])
    rooms = _Rooms(graph, faces)
    columns = (contacts.a, contacts.b, contacts.low, contacts.high, contacts.gap)
    pieces = [
        _piece(faces, names, a, names[b], low, high, gap, reach, rooms)
        for a, b, low, high, gap in zip(*(c.tolist() for c in columns))
        if gap > 1e-3
    ]
    stretches = (c.tolist() for c in free_stretches(faces, contacts))
    pieces += [
        _piece(
            faces,
            names,
            face,
            None,
            low,
            high,
            thickness.get(names[face], usual),
            reach,
            rooms,
        )
        for face, low, high in zip(*stretches)
        if high - low >= min(SHORTEST, 0.5 * float(length[face]))
    ]
    return tuple(pieces)


def piece_of(item: Object, pieces: dict[str, list[WallPiece]]) -> WallPiece | None:
    """The piece of wall a door or window stands in; None where its planes have no wall there."""
    planes = set(item.planes)
    best = None
    for plane in item.planes:
        for piece in pieces.get(plane, ()):
            along = piece.along((item.center[0], item.center[1]))
            if piece.low <= along <= piece.high:
                both = piece.b is not None and {piece.a, piece.b} <= planes
                if both:
                    return piece
                best = best or piece
    return best


def _outer_thickness(graph: SceneGraph, faces: Faces, names: list[str]) -> dict[str, float]:
    """Twice the distance of openings to the outside behind their face, by plane id."""
    row = {name: i for i, name in enumerate(names)}
    found: dict[str, float] = {}
    for item in graph.objects:
        if item.category not in ("door", "window") or len(item.planes) != 1:
            continue
        i = row.get(item.planes[0])
        if i is None:
            continue
        behind = -float(faces.normal[i] @ (np.array(item.center[:2]) - faces.start[i]))
        if behind > 0.01:
            found[item.planes[0]] = 2.0 * behind
    return found


class _Rooms:
    """Finds the rooms of a storey that a piece of wall must keep out of."""

    def __init__(self, graph: SceneGraph, faces: Faces) -> None:
        import shapely

        storey = dict(zip(faces.room.tolist(), faces.storey.tolist()))
        rows = [i for i, r in enumerate(graph.rooms) if i in storey and r.footprint is not None]
        self.storey = np.array([storey[i] for i in rows])
        outlines = [shapely.Polygon(graph.rooms[i].footprint) for i in rows]
        # A hair larger, so that no sliver of wall stays on a face.
        self.outline = shapely.buffer(outlines, 1e-7, join_style="mitre")
        self.tree = shapely.STRtree(self.outline)

    def cut_from(self, wall: Polygon, storey: int) -> Polygon:
        import shapely

        near = self.tree.query(wall, predicate="intersects")
        near = near[self.storey[near] == storey]
        return wall.difference(shapely.union_all(self.outline[np.sort(near)]))


def _piece(
    faces: Faces,
    names: list[str],
    face: int,
    other: str | None,
    low: float,
    high: float,
    thickness: float,
    reach: float,
    rooms: _Rooms,
) -> WallPiece:
    import shapely

    start, direction = faces.start[face], faces.direction[face]
    outward = -faces.normal[face]
    length = float(faces.length[face])
    # Only where the face itself ends does the wall run on into the one it meets.
    first = -reach if low < reach else low
    last = length + reach if high > length - reach else high
    storey = int(faces.storey[face])
    box = _rectangle(start, direction, outward, first, last, thickness)
    core = _rectangle(start, direction, outward, low, high, thickness)
    cut = rooms.cut_from(shapely.Polygon(box), storey)
    parts = getattr(cut, "geoms", [cut])
    middle = shapely.Point(core.mean(axis=0))
    chosen = min(parts, key=lambda part: (part.distance(middle), -part.area))
    outline = np.array(shapely.remove_repeated_points(chosen, 1e-5).exterior.coords)[:-1]
    if not chosen.exterior.is_ccw:
        outline = outline[::-1]
    return WallPiece(
        storey,
        names[face],
        other,
        (float(start[0]), float(start[1])),
        (float(direction[0]), float(direction[1])),
        low,
        high,
        thickness,
        tuple((float(x), float(y)) for x, y in outline),
    )


def _rectangle(
    start: Array, direction: Array, outward: Array, low: float, high: float, thickness: float
) -> Array:
    """Corners (4, 2), clockwise seen from the room."""
    a, b = start + low * direction, start + high * direction
    return np.array([a, b, b + thickness * outward, a + thickness * outward])
