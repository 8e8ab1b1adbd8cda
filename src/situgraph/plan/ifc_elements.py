"""Walls, doors, windows and fixtures of a graph as IFC elements."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from situgraph.plan.ifc_author import Author
from situgraph.plan.wall_pieces import WallPiece
from situgraph.scenegraph.graph import Object, Vec2

# An object without an ellipsoid becomes a cube of this size (m).
SIZE = 0.3
# How far an opening is cut beyond both sides of its wall (m), so that nothing of it is left.
CUT = 0.05
LEAF = 0.05  # m, thickness of door leaves and window panes

# The class of each category, and its predefined type where the class has several meanings.
CLASSES = {
    "column": ("IfcColumn", "COLUMN"),
    "radiator": ("IfcSpaceHeater", "RADIATOR"),
    "sink": ("IfcSanitaryTerminal", "SINK"),
    "toilet": ("IfcSanitaryTerminal", "TOILETPAN"),
    "bathtub": ("IfcSanitaryTerminal", "BATH"),
    "extinguisher": ("IfcFireSuppressionTerminal", "USERDEFINED"),
    "furniture": ("IfcFurniture", "NOTDEFINED"),
    "stairs": ("IfcStair", "STRAIGHT_RUN_STAIR"),
    "outlet": ("IfcOutlet", "POWEROUTLET"),
    "switch": ("IfcSwitchingDevice", "TOGGLESWITCH"),
    "light": ("IfcLightFixture", "NOTDEFINED"),
}


def add_wall(author: Author, piece: WallPiece, number: int, storey: Any, height: float) -> Any:
    """The piece in a placement of its own: x along the face, y into the room."""
    at = author.placement((*piece.start, 0.0), piece.direction, storey.ObjectPlacement)
    c, s = piece.direction
    local: list[Vec2] = []
    for x, y in piece.outline:
        dx, dy = x - piece.start[0], y - piece.start[1]
        local.append((c * dx + s * dy, -s * dx + c * dy))
    return author.rooted(
        "IfcWall",
        f"wall {number} {piece.a} {piece.b}",
        Name=f"wall {number}",
        ObjectPlacement=at,
        Representation=author.prism(local, height),
        PredefinedType="SOLIDWALL",
    )


def add_filling(author: Author, item: Object, piece: WallPiece, wall: Any, floor: float) -> Any:
    """An opening through the wall at the object's place, and the door or window in it.

    ``floor`` (m) is the height of the storey.
    """
    width, _, height = _size(item)
    at = (piece.along(item.center[:2]), -0.5 * piece.thickness, item.center[2] - floor)
    opening = author.rooted(
        "IfcOpeningElement",
        f"opening {item.id}",
        Name=f"opening of {item.id}",
        ObjectPlacement=author.placement(at, under=wall.ObjectPlacement),
        Representation=author.box(width, piece.thickness + 2.0 * CUT, height),
        PredefinedType="OPENING",
    )
    ends = "RelatingBuildingElement RelatedOpeningElement"
    author.relate("IfcRelVoidsElement", f"voids {item.id}", wall, opening, ends)
    filling = author.rooted(
        "IfcDoor" if item.category == "door" else "IfcWindow",
        f"object {item.id}",
        Name=_name(item),
        ObjectPlacement=author.placement((0.0, 0.0, 0.0), under=opening.ObjectPlacement),
        Representation=author.box(width, LEAF, height),
        OverallHeight=height,
        OverallWidth=width,
        PredefinedType=item.category.upper(),
    )
    ends = "RelatingOpeningElement RelatedBuildingElement"
    author.relate("IfcRelFillsElement", f"fills {item.id}", opening, filling, ends)
    return filling


def add_boundaries(
    author: Author, item: Object, piece: WallPiece, filling: Any, spaces: Mapping[str, Any]
) -> None:
    """Say of which rooms a door or window is a boundary."""
    for room in item.rooms:
        author.rooted(
            "IfcRelSpaceBoundary",
            f"boundary {room} {item.id}",
            RelatingSpace=spaces[room],
            RelatedBuildingElement=filling,
            PhysicalOrVirtualBoundary="PHYSICAL",
            InternalOrExternalBoundary="EXTERNAL" if piece.b is None else "INTERNAL",
        )


def add_fixture(author: Author, item: Object, storey: Any, floor: float) -> Any:
    """Anything else: a box where the object's ellipsoid is; ``floor`` (m) as above."""
    kind, predefined = CLASSES.get(item.category, ("IfcBuildingElementProxy", "NOTDEFINED"))
    yaw = _yaw(item)
    x, y, z = item.center
    ahead = (math.cos(yaw), math.sin(yaw))
    return author.rooted(
        kind,
        f"object {item.id}",
        Name=_name(item),
        ObjectType=item.category,
        ObjectPlacement=author.placement((x, y, z - floor), ahead, storey.ObjectPlacement),
        Representation=author.box(*_size(item)),
        PredefinedType=predefined,
    )


def _name(item: Object) -> str:
    return str(item.attributes.get("name") or item.id)


def _size(item: Object) -> tuple[float, float, float]:
    """Full width, depth and height (m)."""
    if item.ellipsoid is None:
        return SIZE, SIZE, SIZE
    width, depth, height = item.ellipsoid.axes
    return 2.0 * width, 2.0 * depth, 2.0 * height


def _yaw(item: Object) -> float:
    if item.ellipsoid is None:
        return 0.0
    x, y, z, w = item.ellipsoid.rotation
    return math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
