"""Rooms by the directions and offsets of their walls, and the same walls in another order."""

from __future__ import annotations

import math

import msgspec

from situgraph.scenegraph.graph import Plane, Room, SceneGraph

# A room: its centre, then for each wall the direction of the normal in degrees, and the offset.
Rooms = dict[str, tuple[tuple[float, float], tuple[tuple[float, float], ...]]]


def graph(rooms: Rooms) -> SceneGraph:
    planes = tuple(
        Plane(f"{name}{k}", (math.cos(math.radians(a)), math.sin(math.radians(a)), 0.0), offset)
        for name, (_, walls) in rooms.items()
        for k, (a, offset) in enumerate(walls)
    )
    made = tuple(
        Room(name, (*center, 1.4), tuple(f"{name}{k}" for k in range(len(walls))))
        for name, (center, walls) in rooms.items()
    )
    return SceneGraph(rooms=made, planes=planes)


def reordered(seen: SceneGraph, order: tuple[int, ...]) -> SceneGraph:
    """The walls of each room in this order, and the rooms the other way round."""
    return seen.replace(
        rooms=tuple(
            msgspec.structs.replace(room, planes=tuple(room.planes[k] for k in order))
            for room in reversed(seen.rooms)
        )
    )
