"""The one graph type: what an A-Graph and an S-Graph both are.

Nodes are immutable records whose fields are those of the JSON format (``docs/graph-format.md``);
``SceneGraph`` ties them together by id and answers the questions every stage asks.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cached_property
from types import MappingProxyType
from typing import Literal

import msgspec
import numpy as np

from situgraph.geometry.poses import Array

Vec2 = tuple[float, float]
Vec3 = tuple[float, float, float]
Vec4 = tuple[float, float, float, float]
Pose = tuple[float, float, float, float, float, float, float]
Scalar = str | float | int | bool | None

FORMAT: Literal["situgraph/scene-graph"] = "situgraph/scene-graph"
VERSION: Literal[1] = 1


class Storey(msgspec.Struct, frozen=True, omit_defaults=True):
    """A level of a building; ``elevation`` and ``height`` in metres."""

    id: str
    name: str | None = None
    elevation: float = 0.0
    height: float | None = None
    attributes: dict[str, Scalar] = {}


class Room(msgspec.Struct, frozen=True, omit_defaults=True):
    """A room: its centre (m), the ids of the planes that bound it, its plan-view footprint (m)."""

    id: str
    center: Vec3
    planes: tuple[str, ...]
    storey: str | None = None
    name: str | None = None
    footprint: tuple[Vec2, ...] | None = None
    attributes: dict[str, Scalar] = {}


class Plane(msgspec.Struct, frozen=True, omit_defaults=True):
    """One face of a wall: unit ``normal`` into the room, ``offset`` and plan ``extent`` (m)."""

    id: str
    normal: Vec3
    offset: float
    extent: tuple[Vec2, Vec2] | None = None
    virtual: bool | None = None
    source: str | None = None
    attributes: dict[str, Scalar] = {}


class Ellipsoid(msgspec.Struct, frozen=True):
    """Semi-axes (m) and the rotation ``qx qy qz qw`` from its axes to the graph's frame."""

    axes: Vec3
    rotation: Vec4 = (0.0, 0.0, 0.0, 1.0)


class Object(msgspec.Struct, frozen=True, omit_defaults=True):
    """A thing with a category; ``rooms``, ``planes``: its relations *in room*, *on plane*."""

    id: str
    category: str
    center: Vec3
    ellipsoid: Ellipsoid | None = None
    rooms: tuple[str, ...] = ()
    planes: tuple[str, ...] = ()
    confidence: float | None = None
    attributes: dict[str, Scalar] = {}


class Keyframe(msgspec.Struct, frozen=True, omit_defaults=True):
    """A robot pose ``x y z qx qy qz qw`` in the graph's frame at ``stamp`` (s)."""

    id: str
    stamp: float
    pose: Pose
    attributes: dict[str, Scalar] = {}


class Warning(msgspec.Struct, frozen=True, omit_defaults=True):
    """Something odd about the graph: a stable ``code``, the ids concerned and a sentence."""

    code: str
    message: str
    ids: tuple[str, ...] = ()


class SceneGraph(msgspec.Struct, frozen=True, dict=True):
    """A scene graph; ``kind`` says where it comes from and never decides what may be done."""

    name: str | None = None
    kind: Literal["prior", "online"] = "prior"
    storeys: tuple[Storey, ...] = ()
    rooms: tuple[Room, ...] = ()
    planes: tuple[Plane, ...] = ()
    objects: tuple[Object, ...] = ()
    keyframes: tuple[Keyframe, ...] = ()
    warnings: tuple[Warning, ...] = ()
    modelled_categories: tuple[str, ...] | None = None
    attributes: dict[str, Scalar] = {}

    @cached_property
    def storey_by_id(self) -> Mapping[str, Storey]:
        """Storeys by id."""
        return MappingProxyType({s.id: s for s in self.storeys})

    @cached_property
    def room_by_id(self) -> Mapping[str, Room]:
        """Rooms by id."""
        return MappingProxyType({r.id: r for r in self.rooms})

    @cached_property
    def plane_by_id(self) -> Mapping[str, Plane]:
        """Planes by id."""
        return MappingProxyType({p.id: p for p in self.planes})

    @cached_property
    def object_by_id(self) -> Mapping[str, Object]:
        """Objects by id."""
        return MappingProxyType({o.id: o for o in self.objects})

    @cached_property
    def objects_by_room(self) -> Mapping[str, tuple[Object, ...]]:
        """The objects related to each room that has any."""
        return _group((o, r) for o in self.objects for r in o.rooms)

    @cached_property
    def objects_by_plane(self) -> Mapping[str, tuple[Object, ...]]:
        """The objects related to each plane that has any."""
        return _group((o, p) for o in self.objects for p in o.planes)

    @cached_property
    def rooms_by_plane(self) -> Mapping[str, tuple[str, ...]]:
        """The ids of the rooms each plane bounds."""
        found: dict[str, list[str]] = {}
        for room in self.rooms:
            for plane in room.planes:
                found.setdefault(plane, []).append(room.id)
        return MappingProxyType({p: tuple(r) for p, r in found.items()})

    @cached_property
    def categories(self) -> frozenset[str]:
        """The categories that occur."""
        return frozenset(o.category for o in self.objects)

    @property
    def modelled(self) -> frozenset[str]:
        """The categories this graph models: as declared, else those that occur."""
        declared = self.modelled_categories
        return self.categories if declared is None else frozenset(declared)

    def plane_arrays(self, ids: Iterable[str]) -> tuple[Array, Array]:
        """Normals (n, 3) and offsets (n,) of the named planes, in that order."""
        planes = [self.plane_by_id[i] for i in ids]
        normals = np.array([p.normal for p in planes], dtype=float).reshape(-1, 3)
        return normals, np.array([p.offset for p in planes], dtype=float)

    def replace(self, **changes: object) -> SceneGraph:
        """A copy with some fields changed."""
        return msgspec.structs.replace(self, **changes)


def _group(pairs: Iterable[tuple[Object, str]]) -> Mapping[str, tuple[Object, ...]]:
    found: dict[str, list[Object]] = {}
    for item, key in pairs:
        found.setdefault(key, []).append(item)
    return MappingProxyType({k: tuple(v) for k, v in found.items()})
