"""One floor plan on several storeys: which rooms, faces and objects each storey has."""

from __future__ import annotations

import itertools

import msgspec
import numpy as np

from situgraph.plan.contacts import Faces
from situgraph.plan.floor import Floor, centroids
from situgraph.plan.layout_items import KINDS, STAIRS, Items, all_of, make_items, nothing
from situgraph.plan.layout_symmetry import HalfTurn


class Storeys(msgspec.Struct, frozen=True):
    """``levels`` copies of a floor of ``per_floor`` rooms and ``faces`` faces, ``rise`` m apart.

    Room i of level k has the number ``k * per_floor + i``; numbers from ``rooms`` on do not exist,
    so the last storey may be smaller.
    """

    levels: int
    rooms: int
    per_floor: int
    faces: int
    rise: float

    def planes(self, floor: Floor) -> int:
        """The number of planes of all storeys."""
        full, rest = divmod(self.rooms, self.per_floor)
        return int(full * self.faces + floor.first[rest])

    def rectangular(self, floor: Floor) -> int:
        """The number of rooms with four faces on all storeys."""
        four = np.diff(floor.first) == 4
        full, rest = divmod(self.rooms, self.per_floor)
        return int(full * four.sum() + four[:rest].sum())

    def on_level(self, level: int) -> int:
        """The number of rooms on a level."""
        return min(self.per_floor, self.rooms - level * self.per_floor)

    def split(self, count: int) -> list[int]:
        """``count`` objects shared out among the levels by their rooms."""
        bounds = [
            round(count * min(k * self.per_floor, self.rooms) / self.rooms)
            for k in range(self.levels + 1)
        ]
        return [b - a for a, b in itertools.pairwise(bounds)]

    def seen(self, faces: Faces, level: int) -> Faces:
        """The faces of the rooms that exist on a level."""
        keep = faces.room < self.on_level(level)
        return Faces(*(getattr(faces, name)[keep] for name in faces.__struct_fields__))

    def raised(self, items: Items, level: int) -> Items:
        """Objects of the floor on a level; those of rooms that do not exist are left out.

        A door to a room that does not exist leads outside.
        """
        room = np.where(items.room >= 0, items.room + level * self.per_floor, -1)
        face = np.where(items.face >= 0, items.face + level * self.faces, -1)
        gone = room >= self.rooms
        room, face = np.where(gone, -1, room), np.where(gone, -1, face)
        swap = (room[:, :1] < 0) & (room[:, 1:] >= 0)
        room = np.where(swap, room[:, ::-1], room)
        face = np.where(swap, face[:, ::-1], face)
        center = items.center + np.array([0.0, 0.0, level * self.rise])
        moved = Items(items.kind, center, items.yaw, items.width, room, face)
        return moved.rows(room[:, 0] >= 0)

    def repeated(self, items: Items) -> Items:
        """The same objects on every level."""
        return all_of([self.raised(items, level) for level in range(self.levels)])

    def image(self, items: Items, turn: HalfTurn) -> Items:
        """The half turn of objects of all levels (which are all complete then)."""
        level = np.maximum(items.room[:, :1] // self.per_floor, 0)
        levels = np.where(items.room >= 0, items.room // self.per_floor, level)
        ground = Items(
            items.kind,
            items.center,
            items.yaw,
            items.width,
            np.where(items.room >= 0, items.room - levels * self.per_floor, -1),
            np.where(items.face >= 0, items.face - levels * self.faces, -1),
        )
        there = turn.image(ground)
        room = np.where(there.room >= 0, there.room + levels * self.per_floor, -1)
        face = np.where(there.face >= 0, there.face + levels * self.faces, -1)
        return Items(there.kind, there.center, there.yaw, there.width, room, face)

    def stairs(
        self, floor: Floor, faces: Faces, turn: HalfTurn | None, rng: np.random.Generator
    ) -> Items:
        """A flight of stairs from each level to the next, in the room nearest the middle.

        It relates to the room below and to the room above.
        """
        flights = np.array(
            [k for k in range(self.levels - 1) if self.on_level(k + 1) == self.per_floor], dtype=int
        )
        if len(flights) == 0:
            return nothing()
        center = centroids(floor, faces.start)
        away = np.linalg.norm(center - center.mean(axis=0), axis=1)
        if turn is not None:
            away = np.where(center[:, 1] > 0.0, away, away + 1e6)
        room = int(np.argmin(away))
        kind = np.full(len(flights), KINDS.index(STAIRS))
        at = np.tile(center[room], (len(flights), 1))
        ahead = np.tile(faces.direction[floor.first[room]], (len(flights), 1))
        rooms = (room + np.stack([flights, flights + 1], axis=1) * self.per_floor).astype(np.int64)
        none = np.full((len(flights), 2), -1)
        width = np.full(len(flights), STAIRS.width)
        items = make_items(kind, at, ahead, width, rooms, none)
        lift = np.column_stack([np.zeros((len(flights), 2)), flights * self.rise])
        return Items(items.kind, items.center + lift, items.yaw, width, rooms, none)
