"""Which room an object is in and which wall face it is on (paper, section 'Relation generator').

Rooms are half-spaces of planes without ends, so a room holds what its centre sees: a ray from the
centre to the object that meets a wall on the way says no. Where a footprint is known it decides
instead, which also serves rooms that are not convex.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import msgspec
import numpy as np
from numpy.typing import NDArray

from situgraph.geometry.poses import Array
from situgraph.objects.config import ObjectsConfig
from situgraph.scenegraph.categories import WALL_MOUNTED
from situgraph.scenegraph.graph import Object, Plane, Room, SceneGraph

TWO_SIDED = frozenset({"door", "window"})
STEP = 0.05  # m; from a face into its room, where the face is probed


@dataclass(frozen=True)
class RoomView:
    """A room as arrays: normals (n, 3), offsets (n,), its floor, the heights it spans (m)."""

    room: Room
    planes: tuple[Plane, ...]
    normals: Array
    offsets: Array
    floor: float
    bottom: float
    top: float

    def sees(self, points: Array, margin: float) -> NDArray[np.bool_]:
        """Which of the points (n, 3) are in the room, up to ``margin`` of the ray behind a wall.

        The ray from the centre c to a point p meets plane i at t = -(n.c + d) / (n.(p - c)); the
        point is hidden when 0 < t < 1 - margin for some plane.
        """
        z = points[:, 2]
        inside: NDArray[np.bool_] = (z > self.bottom) & (z < self.top)
        center = np.array(self.room.center)
        if self.room.footprint is not None:
            return inside & self._in_footprint(points, margin)
        along = (points - center) @ self.normals.T
        start = self.normals @ center + self.offsets
        with np.errstate(divide="ignore", invalid="ignore"):
            t = -start / along
        hidden = (t > 0.0) & (t < 1.0 - margin)
        seen: NDArray[np.bool_] = inside & ~hidden.any(axis=1)
        return seen

    def _in_footprint(self, points: Array, margin: float) -> NDArray[np.bool_]:
        from shapely import Polygon, contains_xy

        polygon = Polygon(self.room.footprint)
        reach = margin * float(np.sqrt(polygon.area)) / 2.0
        grown = polygon.buffer(reach, join_style="mitre") if reach > 0.0 else polygon
        found: NDArray[np.bool_] = contains_xy(grown, points[:, 0], points[:, 1])
        return found

    def faces(self, point: Array, config: ObjectsConfig) -> list[tuple[float, int]]:
        """The faces a wall-mounted object at ``point`` (3,) may be on: (signed distance, index)."""
        distance = self.normals @ point + self.offsets
        found = []
        for i in np.argsort(np.abs(distance), kind="stable"):
            foot = point - (distance[i] - STEP) * self.normals[i]
            if not self._within_extent(int(i), foot, config.extent_margin):
                continue
            if self.sees(foot[None], config.visibility_margin)[0]:
                found.append((float(distance[i]), int(i)))
        return found

    def _within_extent(self, index: int, foot: Array, margin: float) -> bool:
        extent = self.planes[index].extent
        if extent is None:
            return True
        a, b = np.array(extent)
        length = float(np.linalg.norm(b - a))
        if length == 0.0:
            return True
        s = float((foot[:2] - a) @ (b - a)) / length
        return -margin <= s <= length + margin


def room_views(graph: SceneGraph, config: ObjectsConfig) -> tuple[RoomView, ...]:
    """The rooms of a graph that have at least one plane or a footprint, ready for queries."""
    views = []
    for room in graph.rooms:
        if not room.planes and room.footprint is None:
            continue
        normals, offsets = graph.plane_arrays(room.planes)
        storey = graph.storey_by_id.get(room.storey) if room.storey is not None else None
        height = (storey.height if storey else None) or config.storey_height
        floor = storey.elevation if storey else room.center[2] - height / 2.0
        planes = tuple(graph.plane_by_id[i] for i in room.planes)
        slack = 0.2 * height
        views.append(
            RoomView(room, planes, normals, offsets, floor, floor - slack, floor + height + slack)
        )
    return tuple(views)


def room_of(points: Array, views: Iterable[RoomView], margin: float) -> list[int | None]:
    """For each point (n, 3) the index of the view whose room holds it; the nearest centre wins."""
    views = tuple(views)
    best = np.full(len(points), np.inf)
    found: list[int | None] = [None] * len(points)
    for k, view in enumerate(views):
        distance = np.linalg.norm(points[:, :2] - np.array(view.room.center)[:2], axis=1)
        for i in np.flatnonzero(view.sees(points, margin) & (distance < best)):
            best[i], found[i] = distance[i], k
    return found


def relate(item: Object, views: tuple[RoomView, ...], config: ObjectsConfig) -> Object:
    """The object with its relations: rooms, and for wall-mounted kinds the faces it is on.

    A door or window takes every room whose face it lies on, each through its own face: two for an
    inner wall. Other wall-mounted things belong to the one room on whose side they hang.
    """
    point = np.array(item.center)
    if item.category in TWO_SIDED:
        hosts = _hosts(point, views, config)
        if hosts:
            rooms = tuple(views[k].room.id for k, _, _ in hosts)
            planes = tuple(views[k].planes[i].id for k, i, _ in hosts)
            return msgspec.structs.replace(item, rooms=rooms, planes=tuple(dict.fromkeys(planes)))
    inside = room_of(point[None], views, config.visibility_margin)[0]
    if inside is None:
        return msgspec.structs.replace(item, rooms=(), planes=())
    view = views[inside]
    on: tuple[str, ...] = ()
    if item.category in WALL_MOUNTED:
        near = [(abs(d), i) for d, i in view.faces(point, config) if abs(d) < config.wall_distance]
        on = (view.planes[min(near)[1]].id,) if near else ()
    return msgspec.structs.replace(item, rooms=(view.room.id,), planes=on)


def _hosts(
    point: Array, views: tuple[RoomView, ...], config: ObjectsConfig
) -> list[tuple[int, int, float]]:
    """The nearest face near ``point``, and that of the room behind the wall if there is one."""
    near = []
    for k, view in enumerate(views):
        for distance, i in view.faces(point, config):
            near.append((abs(distance), k, i, distance))
    near.sort()
    if not near or near[0][0] >= config.wall_distance:
        return []
    _, k0, i0, d0 = near[0]
    hosts = [(k0, i0, d0)]
    for _, k, i, d in near[1:]:
        facing = float(views[k].normals[i] @ views[k0].normals[i0])
        thickness = -(d + d0)
        if k != k0 and facing < -0.9 and -STEP <= thickness <= config.wall_thickness:
            hosts.append((k, i, d))
            break
    return hosts


def related(graph: SceneGraph, config: ObjectsConfig | None = None) -> SceneGraph:
    """The graph with the relations of all its objects found anew from geometry."""
    config = config or ObjectsConfig()
    views = room_views(graph, config)
    return graph.replace(objects=tuple(relate(o, views, config) for o in graph.objects))
