"""What a building model holds, free of its file format: the input of everything that is geometry.

All coordinates are metres in the building frame, z up.
"""

from __future__ import annotations

from collections.abc import Mapping

import msgspec
import numpy as np
from numpy.typing import NDArray

from situgraph.geometry.poses import Array
from situgraph.scenegraph.graph import Warning


class Mesh(msgspec.Struct, frozen=True):
    """Triangles: ``vertices`` (n, 3) in metres, ``faces`` (m, 3) counter-clockwise from outside."""

    vertices: Array
    faces: NDArray[np.int64]

    @property
    def low(self) -> Array:
        """The smallest x, y, z."""
        low: Array = self.vertices.min(axis=0)
        return low

    @property
    def high(self) -> Array:
        """The largest x, y, z."""
        high: Array = self.vertices.max(axis=0)
        return high


class Level(msgspec.Struct, frozen=True):
    """A declared storey: its key, name and elevation (m), which may be wrong or absent."""

    key: int
    guid: str
    name: str | None
    elevation: float | None


class Element(msgspec.Struct, frozen=True):
    """A space, wall or fixture: ``key`` is its number in the file, ``level`` its storey's key."""

    key: int
    guid: str
    kind: str
    name: str | None
    mesh: Mesh
    level: int | None = None
    long_name: str | None = None
    category: str | None = None

    @property
    def source(self) -> str:
        """How planes and reports name it: its IFC class and GlobalId."""
        return f"{self.kind} {self.guid}"


class Filling(msgspec.Struct, frozen=True):
    """A door, window or bare opening.

    ``mesh`` is the hole it stands in when there is one (``in_hole``), else its own body; ``host``
    the key of the wall it is in or part of; ``across`` the horizontal unit direction through it,
    where the file states it.
    """

    key: int
    guid: str
    kind: str
    category: str
    name: str | None
    mesh: Mesh
    host: int | None = None
    level: int | None = None
    leaf: bool = True
    in_hole: bool = False
    across: tuple[float, float] | None = None


class Building(msgspec.Struct, frozen=True):
    """A building model as read; ``boundaries`` gives the spaces (keys) a door or window touches."""

    name: str | None
    levels: tuple[Level, ...]
    spaces: tuple[Element, ...]
    walls: tuple[Element, ...]
    fillings: tuple[Filling, ...]
    fixtures: tuple[Element, ...]
    slabs: tuple[Element, ...] = ()
    boundaries: Mapping[int, tuple[int, ...]] = {}
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    attributes: Mapping[str, str | float | int | bool | None] = {}
    warnings: tuple[Warning, ...] = ()
