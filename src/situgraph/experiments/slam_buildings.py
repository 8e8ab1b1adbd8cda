"""The buildings of the experiment ``slam``: models of real houses, and three made for it."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from situgraph.scenegraph.graph import (
    Ellipsoid,
    Object,
    Plane,
    Room,
    SceneGraph,
    Storey,
    Vec2,
    Vec4,
)

HEIGHT = 2.8  # m, floor to ceiling
RISE = 3.0  # m, floor to floor
WALL = 0.2  # m
DOOR = (0.9, 2.1)  # m, wide and high
_ALONG_X: Vec4 = (0.0, 0.0, 0.0, 1.0)
_ALONG_Y: Vec4 = (0.0, 0.0, math.sin(math.pi / 4), math.cos(math.pi / 4))
Box = tuple[float, float, float, float]  # x0, y0, x1, y1


class Drive(NamedTuple):
    """A plan, the rooms to visit in this order (none: all, the nearest next)."""

    plan: SceneGraph
    rooms: tuple[str, ...] = ()


def drive(name: str, data: Path, full: bool) -> Drive:
    """The building called ``name``; ``full`` visits all its rooms, else a few.

    Raises:
        InputError: the building's model is not in ``data``.
    """
    return DRIVES[name](data, full)


def _six(data: Path, full: bool) -> Drive:
    from situgraph.plan.six_rooms import six_rooms

    return Drive(six_rooms(), () if full else ("r1", "r2", "r3"))


def _fzk(data: Path, full: bool) -> Drive:
    from situgraph.sim.simulation import rooms_on

    plan = _model(data, "AC20-FZK-Haus.ifc")
    rooms = rooms_on(plan, "Erdgeschoss")
    return Drive(plan, rooms if full else rooms[:4])


def _institute(data: Path, full: bool) -> Drive:
    from situgraph.sim.simulation import rooms_on

    plan = _model(data, "AC11-Institute-Var-2-IFC.ifc")
    rooms = rooms_on(plan, "Erdgeschoss")
    return Drive(plan, rooms if full else rooms[:5])


def _large(data: Path, full: bool) -> Drive:
    plan = _model(data, "bimwhale_LargeBuilding.ifc")
    rooms = tuple(r.id for r in plan.rooms)
    return Drive(plan, rooms if full else rooms[:3])


def _corridor(data: Path, full: bool) -> Drive:
    """A corridor of 30 m without any feature, a room at each end and two at its sides."""
    boxes = {
        "corridor": (0.0, 0.0, 30.0, 2.0),
        "west": (-5.2, -2.0, -WALL, 4.0),
        "east": (30.0 + WALL, -2.0, 35.0, 4.0),
        "north": (24.0, 2.0 + WALL, 29.5, 6.5),
        "south": (0.5, -5.0, 6.5, -WALL),
    }
    doors = (
        door("d0", (-WALL / 2, 1.0), ("west", "corridor"), ("west.e", "corridor.w")),
        door("d1", (30.0 + WALL / 2, 1.0), ("corridor", "east"), ("corridor.e", "east.w")),
        door("d2", (26.0, 2.0 + WALL / 2), ("corridor", "north"), ("corridor.n", "north.s")),
        door("d3", (4.0, -WALL / 2), ("corridor", "south"), ("corridor.s", "south.n")),
    )
    visits = ("west", "corridor", "east", "corridor", "west")
    whole = ("west", "corridor", "east", "north", "corridor", "south", "west")
    return Drive(boxed("corridor of 30 m", boxes, doors), whole if full else visits)


def _two_storeys(data: Path, full: bool) -> Drive:
    """Two rooms, and two above them; a flight of stairs in the longer one joins them."""
    ground = {"hall": (0.0, 0.0, 11.0, 4.5), "side": (0.0, 4.5 + WALL, 5.0, 8.5)}
    upper = {"landing": (0.0, 0.0, 11.0, 4.5), "attic": (6.0, 4.5 + WALL, 11.0, 8.5)}
    stairs = Object(
        "up", "stairs", (5.0, 1.0, 1.5), Ellipsoid((2.4, 0.6, 1.5), _ALONG_X), ("hall", "landing"),
        (), None, {"up": "+x"},
    )  # fmt: skip
    objects = (
        door("d0", (2.5, 4.5 + WALL / 2), ("hall", "side"), ("hall.n", "side.s")),
        door("d1", (9.0, 4.5 + WALL / 2), ("landing", "attic"), ("landing.n", "attic.s"), RISE),
        stairs,
    )
    plan = boxed("two storeys", ground | upper, objects, dict.fromkeys(upper, 1))
    return Drive(plan, ("side", "hall", "landing", "attic"))


DRIVES: dict[str, Callable[[Path, bool], Drive]] = {
    "six rooms": _six,
    "FZK-Haus": _fzk,
    "Institute": _institute,
    "LargeBuilding": _large,
    "corridor of 30 m": _corridor,
    "two storeys": _two_storeys,
}


def _model(data: Path, name: str) -> SceneGraph:
    from situgraph.api import read_plan

    return read_plan(data / "ifc" / name)


def boxed(
    name: str,
    boxes: dict[str, Box],
    objects: tuple[Object, ...],
    levels: dict[str, int] | None = None,
) -> SceneGraph:
    """Rectangular rooms; the planes of room r are r.s, r.e, r.n and r.w."""
    rooms, planes = [], []
    for key, (x0, y0, x1, y1) in boxes.items():
        level = (levels or {}).get(key, 0)
        corners: tuple[Vec2, ...] = ((x0, y0), (x1, y0), (x1, y1), (x0, y1))
        normals = (0.0, 1.0, -y0), (-1.0, 0.0, x1), (0.0, -1.0, y1), (1.0, 0.0, -x0)
        for i, (nx, ny, offset) in enumerate(normals):
            ends = (corners[i], corners[(i + 1) % 4])
            planes.append(Plane(f"{key}.{'senw'[i]}", (nx, ny, 0.0), offset, ends))
        center = ((x0 + x1) / 2, (y0 + y1) / 2, level * RISE + HEIGHT / 2)
        ids = tuple(f"{key}.{side}" for side in "senw")
        rooms.append(Room(key, center, ids, f"s{level}", key, corners))
    count = 1 + max((levels or {"": 0}).values())
    storeys = tuple(Storey(f"s{k}", f"level {k}", k * RISE, HEIGHT) for k in range(count))
    return SceneGraph(
        name=name, storeys=storeys, rooms=tuple(rooms), planes=tuple(planes), objects=objects
    )


def door(
    name: str, at: Vec2, rooms: tuple[str, str], planes: tuple[str, str], floor: float = 0.0
) -> Object:
    """A door in the wall between two faces; ``at`` is its middle in the plan."""
    turned = planes[0][-1] in "ew"
    axes = (DOOR[0] / 2, WALL / 2, DOOR[1] / 2)
    ellipsoid = Ellipsoid(axes, _ALONG_Y if turned else _ALONG_X)
    return Object(name, "door", (*at, floor + DOOR[1] / 2), ellipsoid, rooms, planes)
