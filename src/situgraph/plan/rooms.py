"""The shape of a room from its body: footprint, vertical faces, heights."""

from __future__ import annotations

from typing import TYPE_CHECKING

import msgspec

from situgraph.plan.building import Element
from situgraph.plan.config import PlanConfig
from situgraph.plan.faces import Face, vertical_faces
from situgraph.plan.outlines import footprint

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
    found = vertical_faces(mesh, config, outward=False)
    bottom, top = float(mesh.low[2]), float(mesh.high[2])
    # A low attic has low walls: there half the room's own height is enough.
    height = min(config.min_face_height, 0.5 * (top - bottom))
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
