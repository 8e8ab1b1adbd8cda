"""Doors, windows and fixtures as objects of the graph, with the rooms and faces they relate to."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import msgspec
import numpy as np

from situgraph.plan.backing import PARALLEL, WallFaces
from situgraph.plan.building import Building, Element, Filling
from situgraph.plan.config import PlanConfig
from situgraph.plan.digits import point3
from situgraph.plan.hosting import Host, RoomFaces, hosts, room_faces
from situgraph.plan.openings import Box, extent_box, filling_box
from situgraph.plan.rooms import RoomShape
from situgraph.scenegraph.categories import WALL_MOUNTED
from situgraph.scenegraph.graph import Ellipsoid, Warning

if TYPE_CHECKING:
    from shapely import STRtree


SAME_PLACE = 0.1  # m; doors whose places and half sizes differ less are one door
NEAR = 1.0  # m; doors farther apart are not compared


class Placed(msgspec.Struct, frozen=True):
    """An object before it has an id: what it is, where, and the rooms and faces by number."""

    source: Filling | Element
    category: str
    box: Box
    rooms: tuple[int, ...]
    faces: tuple[tuple[int, int], ...] = ()


def place_filling(
    filling: Filling, box: Box, faces: RoomFaces, rooms: RoomIndex, config: PlanConfig
) -> Placed | None:
    """A door, window or opening with its hosts; None for a bare opening that is no passage.

    A door has one face at most on each side of its wall; a window may span several rooms. One that
    is in no face but stands in a room (a toilet cubicle's door) is in that room, on no plane.
    """
    window = filling.category == "window"
    found = hosts(box, faces, config.window_overlap if window else config.door_overlap, config)
    if not window:
        found = _one_a_side(found, box, faces)
    category = filling.category
    if category == "opening":
        if not _is_passage(box, found, rooms, config):
            return None
        category = "door"
    found = sorted(found, key=lambda h: (h.room, h.face))
    chosen = tuple(dict.fromkeys(h.room for h in found))
    if not found:
        chosen = tuple(rooms.around(box)[:1])
    box = _between(box, found, rooms)
    return Placed(filling, category, box, chosen, tuple((h.room, h.face) for h in found))


def _one_a_side(found: Sequence[Host], box: Box, faces: RoomFaces) -> list[Host]:
    out: dict[bool, Host] = {}
    for host in found:
        row = int(np.flatnonzero((faces.room == host.room) & (faces.face == host.face))[0])
        out.setdefault(bool(faces.normal[row] @ np.array(box.across) > 0.0), host)
    return list(out.values())


def _is_passage(box: Box, found: Sequence[Host], rooms: RoomIndex, config: PlanConfig) -> bool:
    """Whether a robot could drive through a bare opening: wide, high and down to the floor."""
    if not found:
        return False
    floor = max(rooms.shapes[h.room].bottom for h in found)
    return (
        box.bottom <= floor + config.passage_sill
        and box.top - max(floor, box.bottom) >= config.passage_height
        and 2.0 * box.half[0] >= config.passage_width
    )


def _between(box: Box, found: Sequence[Host], rooms: RoomIndex) -> Box:
    """The box cut to what lies between the faces that host it, where they face each other."""
    n = np.array(box.across)
    positions = []
    for host in found:
        face = rooms.shapes[host.room].faces[host.face]
        middle = np.array(face.point(0.0))
        positions.append((float(np.dot(face.normal, n)), float(middle @ n)))
    one = [p for side, p in positions if side > 0]
    other = [p for side, p in positions if side < 0]
    if one and other and max(one) - min(other) > 0.01:
        return box.depth_within(min(other), max(one))
    return box


def place_fixture(element: Element, rooms: RoomIndex, config: PlanConfig) -> Placed:
    """A fixed element or a piece of furniture with the rooms it stands in.

    Kinds that hang on walls (``WALL_MOUNTED``) are on the face of their room that they touch.
    """
    box = extent_box(element.mesh)
    category = element.category or "fixture"
    found = tuple(rooms.around(box))
    faces: tuple[tuple[int, int], ...] = ()
    if category in WALL_MOUNTED:
        touched = ((r, _touched(box, rooms.shapes[r], config.mount_gap)) for r in found)
        faces = tuple((r, face) for r, face in touched if face is not None)
    return Placed(element, category, box, found, faces)


def _touched(box: Box, room: RoomShape, gap: float) -> int | None:
    """The face nearest to a box's side, if it is within ``gap`` and runs past the box's middle."""
    middle = np.array(box.center[:2])
    best: tuple[float, int] | None = None
    for number, face in enumerate(room.faces):
        n = np.array(face.normal)
        reach = abs(n @ box.along) * box.half[0] + abs(n @ box.across) * box.half[1]
        apart = abs(float(n @ middle) + face.offset - float(reach))
        beside = face.low <= float(middle @ np.array(face.tangent)) <= face.high
        in_height = face.bottom <= box.center[2] <= face.top
        if beside and in_height and apart <= gap and (best is None or (apart, number) < best):
            best = (apart, number)
    return None if best is None else best[1]


def ellipsoid(box: Box, smallest: float) -> Ellipsoid:
    """The ellipsoid of a box: semi-axes are its half sizes, at least ``smallest`` (m).

    The same rule as for detected objects: a uniform box has the standard deviation half/sqrt(3)
    along each axis, and an ellipsoid fitted to points takes sqrt(3) of them for a semi-axis.
    """
    yaw = box.yaw
    if not -math.pi / 2 < yaw <= math.pi / 2:  # a box turned by half a turn is the same box
        yaw -= math.copysign(math.pi, yaw)
    turn = (0.0, 0.0, round(math.sin(yaw / 2.0), 12) + 0.0, round(math.cos(yaw / 2.0), 12))
    return Ellipsoid(point3(max(h, smallest) for h in box.half), turn)


class RoomIndex:
    """Finds the rooms a box stands in."""

    def __init__(self, shapes: Sequence[RoomShape]) -> None:
        """Index rooms by their outlines."""
        from shapely import STRtree

        self.shapes = tuple(shapes)
        self._tree: STRtree = STRtree([s.outline for s in shapes])

    def around(self, box: Box) -> list[int]:
        """Rooms that hold at least half of the box's plan, else the one that holds most of it."""
        from shapely import Polygon

        plan = Polygon(_corners(box)).buffer(1e-3)
        shares: dict[int, float] = {}
        for number in sorted(int(i) for i in self._tree.query(plan, predicate="intersects")):
            room = self.shapes[number]
            height = min(room.top, box.top) - max(room.bottom, box.bottom)
            if height > min(1.0, box.half[2]):
                shares[number] = float(room.outline.intersection(plan).area / plan.area)
        held = [n for n, share in shares.items() if share >= 0.5]
        if held or not shares:
            return held
        best = max(sorted(shares), key=lambda n: shares[n])
        return [best] if shares[best] >= 0.1 else []


def _corners(box: Box) -> list[tuple[float, float]]:
    (x, y, _), (ax, ay), (tx, ty) = box.center, box.across, box.along
    w, d, _ = box.half
    return [
        (x + i * w * tx + j * d * ax, y + i * w * ty + j * d * ay)
        for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))
    ]


class Contents(msgspec.Struct, frozen=True):
    """What stands in a building: the objects, and which bodies were not made one and why."""

    placed: tuple[Placed, ...]
    warnings: tuple[Warning, ...]


def find_contents(
    building: Building, walls: WallFaces, shapes: Sequence[RoomShape], config: PlanConfig
) -> Contents:
    """Doors, then windows, then fixtures, each in file order.

    A door that the file holds twice in one place is one door; bare openings that are no passages
    and fixtures outside all rooms (trees, cars, terraces) are left out.
    """
    faces, rooms = room_faces(shapes), RoomIndex(shapes)
    boxes = {f.key: filling_box(f, walls) for f in building.fillings}
    once = _once(building.fillings, boxes)
    made = {f.key: place_filling(f, boxes[f.key], faces, rooms, config) for f in once}
    placed = [p for p in made.values() if p is not None]
    placed.sort(key=lambda p: p.category != "door")
    fixtures = [place_fixture(e, rooms, config) for e in building.fixtures]
    left_out: dict[str, list[Filling | Element]] = {
        "duplicate-object": [f for f in building.fillings if f.key not in made],
        "opening-left-out": [f for f in once if made[f.key] is None],
        "outside-object": [p.source for p in fixtures if not p.rooms],
    }
    warnings = [
        Warning(code, f"{len(found)} {_LEFT_OUT[code]}", tuple(e.guid for e in found))
        for code, found in left_out.items()
        if found
    ]
    return Contents((*placed, *(p for p in fixtures if p.rooms)), tuple(warnings))


_LEFT_OUT = {
    "duplicate-object": "doors or windows stand a second time in the same place and are left out",
    "opening-left-out": "bare openings are no passages between rooms and are left out",
    "outside-object": "fixtures stand in no room and are left out",
}


def _once(fillings: Sequence[Filling], boxes: Mapping[int, Box]) -> list[Filling]:
    """Fillings without those that repeat an earlier one; the one whose host is known stays."""
    order = sorted(fillings, key=lambda f: (f.host is None, f.key))
    centers = np.array([boxes[f.key].center for f in order]).reshape(-1, 3)
    kept: list[int] = []
    for n, filling in enumerate(order):
        near = np.abs(centers[kept] - centers[n]).max(axis=1, initial=0.0) <= NEAR
        others = [order[kept[k]] for k in np.flatnonzero(near)]
        others = [o for o in others if o.category == filling.category]
        if not any(_is_same(boxes[o.key], boxes[filling.key]) for o in others):
            kept.append(n)
    return sorted((order[n] for n in kept), key=lambda f: f.key)


def _is_same(one: Box, other: Box) -> bool:
    """Whether two boxes are one door: as wide, as high, and in the same place of the same wall."""
    apart = np.array(other.center) - one.center
    across, along = abs(apart[:2] @ one.across), abs(apart[:2] @ one.along)
    if abs(np.dot(one.across, other.across)) < PARALLEL:
        return False
    sizes = (abs(one.half[0] - other.half[0]), abs(one.half[2] - other.half[2]))
    beside = across <= one.half[1] + other.half[1] + SAME_PLACE
    return bool(beside and max(along, abs(apart[2]), *sizes) <= SAME_PLACE)
