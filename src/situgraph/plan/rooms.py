"""The shape of a room from its body: footprint, vertical faces, heights."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import msgspec

from situgraph.plan.building import Element
from situgraph.plan.config import PlanConfig
from situgraph.plan.digits import point2
from situgraph.plan.faces import Face, vertical_faces
from situgraph.plan.outlines import footprint
from situgraph.scenegraph.graph import Vec2

OVERLAP_HEIGHT = 0.5  # m; rooms that share less height stand one above the other
OVERLAP_SHARE = 0.1  # of the smaller floor; less is a matter of wall thickness

if TYPE_CHECKING:
    from shapely import Polygon


class RoomShape(msgspec.Struct, frozen=True):
    """A room's plan: ``outline`` (a shapely polygon, holes kept), its faces with inward normals.

    ``slivers`` counts the faces left out as too small; ``parts`` the separate pieces of its floor,
    of which the outline is the largest.
    """

    element: Element
    outline: Polygon
    faces: tuple[Face, ...]
    bottom: float
    top: float
    slivers: int = 0
    parts: int = 1


def room_shape(element: Element, config: PlanConfig) -> RoomShape | None:
    """The shape of a space, or None where its body has no floor area."""
    mesh = element.mesh
    pieces = footprint(mesh)
    if not pieces:
        return None
    bottom, top = float(mesh.low[2]), float(mesh.high[2])
    # A low attic has low walls: there half the room's own height is enough.
    height = min(config.min_face_height, 0.5 * (top - bottom))
    found = vertical_faces(mesh, config, outward=False, min_height=height)
    kept = [f for f in found if f.length >= config.min_face_length and f.height >= height]
    return RoomShape(
        element=element,
        outline=pieces[0],
        faces=tuple(in_order(kept, pieces[0])),
        bottom=bottom,
        top=top,
        slivers=len(found) - len(kept),
        parts=len(pieces),
    )


def in_order(faces: list[Face], outline: Polygon) -> list[Face]:
    """Faces in the order in which one meets them along the outline, counter-clockwise."""
    from shapely import Point

    ring = outline.exterior

    def place(face: Face) -> tuple[bool, float, float]:
        middle = Point(face.point(0.5 * (face.low + face.high)))
        inside = (
            ring.distance(middle) > 0.05
        )  # faces of pillars and courts come after the outer ones
        return inside, round(ring.project(middle), 3), face.bottom

    return sorted(faces, key=place)


def center(shape: RoomShape) -> Vec2:
    """The centroid of the floor, or a point inside where the centroid is outside."""
    point = shape.outline.centroid
    if not shape.outline.contains(point):
        point = shape.outline.representative_point()
    return float(point.x), float(point.y)


def ring(shape: RoomShape) -> tuple[Vec2, ...]:
    """The outer corners of the floor, counter-clockwise."""
    return tuple(point2(corner) for corner in shape.outline.exterior.coords[:-1])


def overlaps(shapes: Sequence[RoomShape]) -> Iterator[tuple[int, int, float]]:
    """Pairs of rooms that stand in one another, and the share of the smaller one's floor."""
    from shapely import STRtree

    tree = STRtree([s.outline for s in shapes])
    for one, shape in enumerate(shapes):
        for other in sorted(int(i) for i in tree.query(shape.outline, predicate="intersects")):
            if other <= one:
                continue
            second = shapes[other]
            height = min(shape.top, second.top) - max(shape.bottom, second.bottom)
            if height <= OVERLAP_HEIGHT:
                continue
            area = shape.outline.intersection(second.outline).area
            share = area / min(shape.outline.area, second.outline.area)
            if share > OVERLAP_SHARE:
                yield one, other, share
