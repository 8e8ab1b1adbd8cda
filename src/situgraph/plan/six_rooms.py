"""The embedded building: the six-room layout of the paper's 'Simulation Data', our own draft.

Six equal rooms, three columns of two, visited in the order 1..6::

    +---+---+---+
    | 2 | 3 | 6 |
    +---+---+---+
    | 1 | 4 | 5 |
    +---+---+---+

The plans of the first 1, 2, 4 and 6 rooms map onto themselves by a half turn, those of the first
3 and 5 do not. Doors and windows are laid out so that no room, turned or not, has at least as
many of each on each wall as any other room: one room seen in full is enough to know which it is
and which way round. The layout was fixed before any experiment was run on it.
"""

from __future__ import annotations

from typing import Literal

import msgspec

from situgraph.errors import InputError
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

Side = Literal["south", "east", "north", "west"]

ROOM = (7.0, 5.2)  # m, between the inner faces, x and y
INNER_WALL = 0.15  # m
OUTER_WALL = 0.25  # m
HEIGHT = 2.8  # m, floor to ceiling

SIDES: tuple[Side, ...] = ("south", "east", "north", "west")
STEP = {"south": (0, -1), "east": (1, 0), "north": (0, 1), "west": (-1, 0)}
INWARD: dict[Side, Vec2] = {
    "south": (0.0, 1.0), "east": (-1.0, 0.0), "north": (0.0, -1.0), "west": (1.0, 0.0),
}  # fmt: skip
CELLS = ((0, 0), (0, 1), (1, 1), (1, 0), (2, 0), (2, 1))


class Opening(msgspec.Struct, frozen=True):
    """A door or window in one side of a room.

    ``at`` (m) runs from the side's west or south end to the middle of the opening.
    """

    category: Literal["door", "window"]
    room: int
    side: Side
    at: float
    width: float = 0.9


class Fixture(msgspec.Struct, frozen=True):
    """Another object: its middle from the room's south-west corner, its full size (m)."""

    category: str
    room: int
    at: tuple[float, float, float]
    size: tuple[float, float, float]
    side: Side | None = None


OPENINGS = (
    Opening("door", 1, "north", 1.6),
    Opening("door", 1, "north", 5.1),
    Opening("door", 1, "east", 1.2),
    Opening("door", 1, "east", 3.9),
    Opening("door", 2, "east", 3.2),
    Opening("door", 3, "south", 4.6),
    Opening("door", 4, "east", 1.9),
    Opening("door", 5, "north", 2.7),
    Opening("door", 2, "north", 5.9),
    Opening("window", 1, "west", 2.2, 1.6),
    Opening("window", 2, "north", 1.4, 1.4),
    Opening("window", 2, "north", 3.9, 1.4),
    Opening("window", 3, "north", 0.9, 1.2),
    Opening("window", 3, "north", 2.6, 1.2),
    Opening("window", 3, "north", 4.5, 1.2),
    Opening("window", 3, "north", 6.1, 1.2),
    Opening("window", 4, "south", 4.9, 1.6),
    Opening("window", 5, "east", 0.9, 1.2),
    Opening("window", 5, "east", 2.5, 1.2),
    Opening("window", 5, "east", 4.2, 1.2),
    Opening("window", 6, "east", 0.8, 1.2),
    Opening("window", 6, "east", 2.6, 1.2),
    Opening("window", 6, "east", 4.3, 1.2),
    Opening("window", 6, "north", 2.0, 1.4),
    Opening("window", 6, "north", 4.8, 1.4),
)
FIXTURES = (
    Fixture("radiator", 1, (0.06, 2.2, 0.45), (0.12, 1.2, 0.6), "west"),
    Fixture("column", 1, (4.9, 2.9, 1.4), (0.3, 0.3, 2.8)),
    Fixture("sink", 2, (0.225, 1.1, 0.9), (0.45, 0.6, 0.2), "west"),
    Fixture("extinguisher", 3, (0.1, 4.4, 1.2), (0.2, 0.2, 0.6), "west"),
    Fixture("furniture", 3, (4.8, 2.6, 0.375), (1.4, 0.8, 0.75)),
    Fixture("radiator", 4, (4.9, 0.06, 0.45), (1.2, 0.12, 0.6), "south"),
    Fixture("column", 5, (2.4, 2.0, 1.4), (0.3, 0.3, 2.8)),
    Fixture("furniture", 6, (4.6, 1.2, 0.375), (0.8, 1.4, 0.75)),
    Fixture("extinguisher", 6, (0.1, 0.8, 1.2), (0.2, 0.2, 0.6), "west"),
)
SILL = {"door": 0.0, "window": 0.9}
LINTEL = {"door": 2.1, "window": 2.2}


def six_rooms(map_rooms: int = 6) -> SceneGraph:
    """The building of the first ``map_rooms`` rooms (1 to 6) as a prior graph.

    Ids and coordinates are those of the whole building; a door to a room that is not in the plan
    leads outside.

    Raises:
        InputError: not 1 to 6 rooms.
    """
    if not 1 <= map_rooms <= len(CELLS):
        raise InputError("six rooms", f"no plan of {map_rooms} rooms", "ask for 1 to 6")
    rooms = range(1, map_rooms + 1)
    openings = [_opening(n, o, map_rooms) for n, o in enumerate(OPENINGS)]
    fixtures = [_fixture(n, f) for n, f in enumerate(FIXTURES, len(OPENINGS)) if f.room in rooms]
    return SceneGraph(
        name="six rooms" if map_rooms == len(CELLS) else f"six rooms, the first {map_rooms}",
        kind="prior",
        storeys=(Storey("s0", "ground floor", 0.0, HEIGHT),),
        rooms=tuple(_room(r) for r in rooms),
        planes=tuple(_plane(r, side) for r in rooms for side in SIDES),
        objects=(*(o for o in openings if o is not None), *fixtures),
        modelled_categories=tuple(sorted({o.category for o in (*OPENINGS, *FIXTURES)})),
    )


def _corner(room: int) -> Vec2:
    """The south-west inner corner of a room."""
    column, row = CELLS[room - 1]
    return column * (ROOM[0] + INNER_WALL), row * (ROOM[1] + INNER_WALL)


def _outline(room: int) -> tuple[Vec2, ...]:
    (x, y), (w, d) = _corner(room), ROOM
    return (x, y), (x + w, y), (x + w, y + d), (x, y + d)


def _room(room: int) -> Room:
    x, y = _corner(room)
    center = (x + 0.5 * ROOM[0], y + 0.5 * ROOM[1], 0.5 * HEIGHT)
    planes = tuple(_plane_id(room, side) for side in SIDES)
    return Room(f"r{room}", center, planes, "s0", f"room {room}", _outline(room))


def _plane_id(room: int, side: Side) -> str:
    return f"p{4 * (room - 1) + SIDES.index(side)}"


def _plane(room: int, side: Side) -> Plane:
    k = SIDES.index(side)
    outline = _outline(room)
    nx, ny = INWARD[side]
    start, end = outline[k], outline[(k + 1) % 4]
    offset = -(nx * start[0] + ny * start[1])
    return Plane(_plane_id(room, side), (nx, ny, 0.0), offset, (start, end))


def _opening(number: int, opening: Opening, map_rooms: int) -> Object | None:
    """The opening as an object; None where neither of its rooms is in the plan."""
    side = opening.side
    hosts = [(opening.room, side)]
    beyond = _neighbour(opening.room, side)
    if beyond is not None:
        hosts.append((beyond, SIDES[(SIDES.index(side) + 2) % 4]))
    there = [(room, face) for room, face in hosts if room <= map_rooms]
    if not there:
        return None
    x, y = _corner(there[0][0])
    along = opening.at
    depth = INNER_WALL if len(there) == 2 else OUTER_WALL
    face = there[0][1]
    nx, ny = INWARD[face]
    # Along the wall, then from the inner face half the wall's thickness outwards.
    px = x + (along if nx == 0.0 else (0.0 if nx > 0.0 else ROOM[0])) - 0.5 * depth * nx
    py = y + (along if ny == 0.0 else (0.0 if ny > 0.0 else ROOM[1])) - 0.5 * depth * ny
    low, high = SILL[opening.category], LINTEL[opening.category]
    axes = (0.5 * opening.width, 0.5 * depth, 0.5 * (high - low))
    return Object(
        f"o{number}",
        opening.category,
        (px, py, 0.5 * (low + high)),
        Ellipsoid(axes, _turn(quarter=nx != 0.0)),
        tuple(f"r{room}" for room, _ in there),
        tuple(_plane_id(room, face) for room, face in there),
        1.0,
    )


def _fixture(number: int, fixture: Fixture) -> Object:
    x, y = _corner(fixture.room)
    dx, dy, dz = fixture.at
    w, d, h = fixture.size
    quarter = d > w
    return Object(
        f"o{number}",
        fixture.category,
        (x + dx, y + dy, dz),
        Ellipsoid((0.5 * max(w, d), 0.5 * min(w, d), 0.5 * h), _turn(quarter)),
        (f"r{fixture.room}",),
        () if fixture.side is None else (_plane_id(fixture.room, fixture.side),),
        1.0,
    )


def _neighbour(room: int, side: Side) -> int | None:
    (column, row), (dx, dy) = CELLS[room - 1], STEP[side]
    cell = (column + dx, row + dy)
    return CELLS.index(cell) + 1 if cell in CELLS else None


def _turn(quarter: bool) -> Vec4:
    """No turn, or a quarter turn about z."""
    return (0.0, 0.0, 0.5**0.5, 0.5**0.5) if quarter else (0.0, 0.0, 0.0, 1.0)
