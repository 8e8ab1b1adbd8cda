"""Small buildings made by hand, whose every measure is known."""

from __future__ import annotations

import math

from situgraph.scenegraph.graph import Ellipsoid, Object, Plane, Room, SceneGraph, Storey

HEIGHT = 2.8
WALL = 0.2
UPRIGHT = (0.0, 0.0, 0.0, 1.0)
QUARTER = (0.0, 0.0, math.sin(math.pi / 4), math.cos(math.pi / 4))

Box = tuple[float, float, float, float]


def building(
    boxes: dict[str, Box],
    objects: tuple[Object, ...] = (),
    storeys: dict[str, int] | None = None,
    levels: int = 1,
    rise: float = 3.0,
) -> SceneGraph:
    """Rectangular rooms ``x0, y0, x1, y1``; the planes of room r are r.s, r.e, r.n and r.w."""
    rooms, planes = [], []
    for name, (x0, y0, x1, y1) in boxes.items():
        level = (storeys or {}).get(name, 0)
        corners = ((x0, y0), (x1, y0), (x1, y1), (x0, y1))
        sides = (("s", (0, 1), -y0), ("e", (-1, 0), x1), ("n", (0, -1), y1), ("w", (1, 0), -x0))
        for i, (side, (nx, ny), offset) in enumerate(sides):
            extent = (corners[i], corners[(i + 1) % 4])
            normal = (float(nx), float(ny), 0.0)
            planes.append(Plane(f"{name}.{side}", normal, float(offset), extent))
        center = ((x0 + x1) / 2, (y0 + y1) / 2, level * rise + HEIGHT / 2)
        ids = tuple(f"{name}.{s}" for s in "senw")
        rooms.append(Room(name, center, ids, f"s{level}", None, corners))
    stack = tuple(Storey(f"s{k}", f"level {k}", k * rise, HEIGHT) for k in range(levels))
    return SceneGraph(
        name="test building",
        storeys=stack,
        rooms=tuple(rooms),
        planes=tuple(planes),
        objects=objects,
    )


def door(name: str, x: float, y: float, rooms: tuple[str, ...], planes: tuple[str, ...], **more):
    """A door 0.9 m wide in a wall that runs along y, unless its planes say otherwise."""
    return Object(
        name, "door", (x, y, 1.05), Ellipsoid((0.45, 0.1, 1.05), QUARTER), rooms, planes, None, more
    )


def window(name: str, x: float, y: float, room: str, plane: str) -> Object:
    """A window 1.4 m wide, 0.9 to 2.1 m high, in a wall that runs along y."""
    return Object(
        name, "window", (x, y, 1.5), Ellipsoid((0.7, 0.1, 0.6), QUARTER), (room,), (plane,)
    )


def box_room(objects: tuple[Object, ...] = ()) -> SceneGraph:
    """One closed room of 6 by 4 m with a corner in the origin."""
    return building({"a": (0.0, 0.0, 6.0, 4.0)}, objects)


def two_rooms(**attributes: object) -> SceneGraph:
    """Two rooms side by side, a door between them, a window to the west."""
    return building(
        {"a": (0.0, 0.0, 5.0, 4.0), "b": (5.0 + WALL, 0.0, 10.0, 4.0)},
        (
            door("d", 5.0 + WALL / 2, 2.0, ("a", "b"), ("a.e", "b.w"), **attributes),
            window("w", -0.1, 2.0, "a", "a.w"),
        ),
    )


def two_storeys(category: str = "stairs") -> SceneGraph:
    """A long room above another, joined by a flight."""
    way = Object(
        "up", category, (5.0, 1.0, 1.5), Ellipsoid((2.4, 0.6, 1.5)), ("low", "high"), (), None,
        {"up": "+x"},
    )  # fmt: skip
    rooms = {"low": (0.0, 0.0, 10.0, 4.0), "high": (0.0, 0.0, 10.0, 4.0)}
    return building(rooms, (way,), {"high": 1}, levels=2)
