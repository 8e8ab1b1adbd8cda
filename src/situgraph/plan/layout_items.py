"""The things that stand in layouts, in the form in which they are drawn: one row each."""

from __future__ import annotations

from collections.abc import Sequence

import msgspec
import numpy as np
from numpy.typing import NDArray

from situgraph.geometry.poses import Array
from situgraph.plan.contacts import Index

Mask = NDArray[np.bool_]


class ItemKind(msgspec.Struct, frozen=True):
    """What an object of a category measures: full width, depth and height, and its foot, in m."""

    category: str
    width: float
    depth: float
    height: float
    foot: float
    on_wall: bool


DOOR = ItemKind("door", 0.9, 0.15, 2.1, 0.0, True)
WINDOW = ItemKind("window", 1.4, 0.15, 1.3, 0.9, True)
# From floor to floor, and a railing that stands in the room above.
STAIRS = ItemKind("stairs", 1.2, 2.4, 4.3, 0.0, False)
OTHERS = (
    ItemKind("radiator", 1.0, 0.12, 0.6, 0.15, True),
    ItemKind("sink", 0.6, 0.45, 0.2, 0.8, True),
    ItemKind("extinguisher", 0.2, 0.2, 0.6, 0.9, True),
    ItemKind("column", 0.3, 0.3, 2.8, 0.0, False),
    ItemKind("furniture", 1.4, 0.8, 0.75, 0.0, False),
)
KINDS = (DOOR, WINDOW, STAIRS, *OTHERS)


class Items(msgspec.Struct, frozen=True):
    """Objects of a floor as columns of equal length n.

    ``kind`` indexes ``KINDS``; ``center`` (n, 3) in metres above the floor of the storey; ``yaw``
    (n,) turns x to the object's width; ``width`` (n,) in metres; ``room`` and ``face`` (n, 2) are
    rows of the floor, -1 where there is no second (or no) one.
    """

    kind: Index
    center: Array
    yaw: Array
    width: Array
    room: Index
    face: Index

    @property
    def count(self) -> int:
        """The number of objects."""
        return len(self.kind)

    def rows(self, which: Index | Mask) -> Items:
        """Some of them, by index or mask."""
        return Items(*(getattr(self, name)[which] for name in self.__struct_fields__))


def nothing() -> Items:
    """No object at all."""
    pairs = np.zeros((0, 2), dtype=np.int64)
    none = np.zeros(0)
    return Items(np.zeros(0, dtype=np.int64), np.zeros((0, 3)), none, none, pairs, pairs)


def all_of(parts: Sequence[Items]) -> Items:
    """Several sets as one, in the order given."""
    names = Items.__struct_fields__
    return Items(*(np.concatenate([getattr(p, name) for p in parts]) for name in names))


def make_items(
    kind: Index, center: Array, direction: Array, width: Array, room: Index, face: Index
) -> Items:
    """Objects at plan positions ``center`` (n, 2), set up at the height of their kind.

    ``direction`` (n, 2) is the unit vector along the object's width.
    """
    middle = np.array([k.foot + 0.5 * k.height for k in KINDS])[kind]
    yaw = np.arctan2(direction[:, 1], direction[:, 0])
    return Items(kind, np.column_stack([center, middle]), yaw, width, room, face)


def second_none(first: Index) -> Index:
    """(n,) rows as (n, 2) pairs without a second."""
    return np.stack([first, np.full(len(first), -1)], axis=1)
