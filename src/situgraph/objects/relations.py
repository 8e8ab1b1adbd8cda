"""Which room an object is in and which wall face it is on (paper, section 'Relation generator').

Rooms are half-spaces of planes without ends, so a room holds what its centre sees: a ray from the
centre to the object that meets a wall on the way says no. Where a footprint is known it decides
instead, which also serves rooms that are not convex.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from situgraph.geometry.poses import Array
from situgraph.objects.config import ObjectsConfig
from situgraph.scenegraph.categories import SOLID, WALL_MOUNTED
from situgraph.scenegraph.graph import Object, Plane, Room, SceneGraph

TWO_SIDED = frozenset({"door", "window"})
STEP = 0.05  # m; from a face into its room, where the face is probed
FAR = 2.0  # m; no object is on a face whose plane is farther from its centre
LONGER = 1.5  # length over depth, in the plan, from which a thing has a front
ALONG = 0.7  # cosine between its depth and a wall's normal, from which it can hang there

Span = tuple[float, float] | None  # m along a wall; None: endless


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
    outline: Any  # shapely polygon of the footprint, None where it is unknown
    spans: tuple[Span, ...]  # of each plane along its wall
    sides: tuple[Span, ...]  # the same from corner to corner of the room, where they are known

    def sees(self, points: Array, margin: float) -> NDArray[np.bool_]:
        """Which of the points (n, 3) are in the room, up to ``margin`` of the ray behind a wall.

        The ray from the centre c to a point p meets plane i at t = -(n.c + d) / (n.(p - c)); the
        point is hidden when 0 < t < 1 - margin for some plane.
        """
        z = points[:, 2]
        inside: NDArray[np.bool_] = (z > self.bottom) & (z < self.top)
        center = np.array(self.room.center)
        if self.outline is not None:
            reach = margin * float(np.sqrt(self.outline.area)) / 2.0
            held: NDArray[np.bool_] = inside & (self.outside(points) <= reach)
            return held
        along = (points - center) @ self.normals.T
        start = self.normals @ center + self.offsets
        with np.errstate(divide="ignore", invalid="ignore"):
            t = -start / along
        hidden = (t > 0.0) & (t < 1.0 - margin)
        seen: NDArray[np.bool_] = inside & ~hidden.any(axis=1)
        return seen

    def outside(self, points: Array) -> Array:
        """How far (m) each point (n, 3) lies outside the room in the plan, 0 inside."""
        if self.outline is not None:
            import shapely

            away: Array = shapely.distance(self.outline, shapely.points(points[:, :2]))
            return away
        behind = points @ self.normals.T + self.offsets
        worst: Array = np.maximum(-behind.min(axis=1, initial=0.0), 0.0)
        return worst

    def faces(
        self, point: Array, thin: Array | None, config: ObjectsConfig
    ) -> list[tuple[float, int]]:
        """The faces a wall-mounted object at ``point`` may be on: (signed distance, index).

        A thing that is longer than deep, seen from above, is on no wall that it stands across:
        ``thin`` (3,) is the direction of its depth, if it has one.
        """
        distance = self.normals @ point + self.offsets
        found = []
        for i in np.argsort(np.abs(distance), kind="stable"):
            if abs(distance[i]) > FAR:
                break
            if thin is not None and abs(float(self.normals[i] @ thin)) < ALONG:
                continue
            foot = point - (distance[i] - STEP) * self.normals[i]
            span, along = self.spans[i], float(tangent(self.normals[i]) @ foot)
            margin = config.extent_margin
            if span is not None and not span[0] - margin <= along <= span[1] + margin:
                continue
            if self.sees(foot[None], config.visibility_margin)[0]:
                found.append((float(distance[i]), int(i)))
        return found


def tangent(normal: Array) -> Array:
    """The level unit direction (3,) along a wall with this normal, the room on its left."""
    level = np.array([-normal[1], normal[0], 0.0])
    unit: Array = level / max(float(np.linalg.norm(level)), 1e-12)
    return unit


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
        bottom, top = floor - slack, floor + height + slack
        outline = _outline(room)
        spans = tuple(_span(p, room) for p in planes)
        sides = tuple(_side(p, room) for p in planes)
        views.append(
            RoomView(room, planes, normals, offsets, floor, bottom, top, outline, spans, sides)
        )
    return tuple(views)


def _span(plane: Plane, room: Room) -> Span:
    """From where to where (m along its wall) a plane bounds a room; None: unknown.

    That is what was seen of it and the sides of the footprint that lie on it: a wall that is mostly
    door is seen in scraps.
    """
    if plane.extent is None:
        return None
    ends = np.array(plane.extent) @ tangent(np.array(plane.normal))[:2]
    if ends[0] == ends[1]:
        return None
    held = [*ends.tolist(), *(_side(plane, room) or ())]
    return min(held), max(held)


def _side(plane: Plane, room: Room) -> Span:
    """From the first to the last corner (m along its wall) of a room's sides on a plane."""
    if room.footprint is None:
        return None
    normal = np.array(plane.normal)
    a = np.array(room.footprint)
    b = np.roll(a, -1, axis=0)
    on = np.abs(np.stack([a, b]) @ normal[:2] + plane.offset).max(axis=0) < STEP
    if not on.any():
        return None
    along = np.concatenate([a[on], b[on]]) @ tangent(normal)[:2]
    return float(along.min()), float(along.max())


def _outline(room: Room) -> Any:
    if room.footprint is None:
        return None
    import shapely

    polygon = shapely.Polygon(room.footprint)
    shapely.prepare(polygon)
    return polygon


def room_of(points: Array, views: Iterable[RoomView], margin: float) -> list[int | None]:
    """For each point (n, 3) the index of the view whose room holds it.

    Of several, the one that it is least outside of, then the one with the nearest centre.
    """
    views = tuple(views)
    best = np.full((len(points), 2), np.inf)
    found: list[int | None] = [None] * len(points)
    for k, view in enumerate(views):
        held = np.flatnonzero(view.sees(points, margin))
        if not len(held):
            continue
        away = np.round(view.outside(points[held]), 3)
        distance = np.linalg.norm(points[held, :2] - np.array(view.room.center)[:2], axis=1)
        for i, rank in zip(held.tolist(), zip(away.tolist(), distance.tolist())):
            if rank < tuple(best[i]):
                best[i], found[i] = rank, k
    return found


def _thin_direction(item: Object) -> Array | None:
    """The level direction (3,) of a thing's depth; None where it is as deep as long, or unknown."""
    if item.ellipsoid is None:
        return None
    from situgraph.geometry.ellipsoids import shape_matrix

    shape = shape_matrix(item.ellipsoid.axes, item.ellipsoid.rotation)[:2, :2]
    values, vectors = np.linalg.eigh(shape)
    if values[1] < LONGER**2 * values[0]:
        return None
    return np.array([*vectors[:, 0], 0.0])


def _reach(item: Object, normal: Array) -> float:
    """How far (m) a thing's ellipsoid reaches from its centre along a wall's normal."""
    if item.ellipsoid is None:
        return 0.0
    from situgraph.geometry.ellipsoids import shape_matrix

    shape = shape_matrix(item.ellipsoid.axes, item.ellipsoid.rotation)
    return float(np.sqrt(normal @ shape @ normal))


def relate(
    item: Object, views: tuple[RoomView, ...], config: ObjectsConfig, eye: Array | None = None
) -> Object:
    """The object with its relations: rooms, and for wall-mounted kinds the faces it is on.

    A door or window takes every room whose face it lies on, each through its own face: two for an
    inner wall. Other wall-mounted things belong to the one room on whose side they hang: where it
    is known from where one was seen, ``eye`` (3,), that is the room of that place if one of its
    walls is as near, since nobody looks through a wall. A thing just behind it was placed amiss.
    """
    point = np.array(item.center)
    if item.category in TWO_SIDED:
        hosts = _hosts(item, views, config)
        if hosts:
            rooms = tuple(views[k].room.id for k, _, _ in hosts)
            planes = tuple(views[k].planes[i].id for k, i, _ in hosts)
            return msgspec.structs.replace(item, rooms=rooms, planes=tuple(dict.fromkeys(planes)))
    inside = room_of(point[None], views, config.visibility_margin)[0]
    if eye is not None and item.category in WALL_MOUNTED:
        viewer = room_of(eye[None], views, 0.0)[0]
        if viewer is not None and viewer != inside and _on(item, views[viewer], config):
            inside = viewer
    if inside is None:
        return msgspec.structs.replace(item, rooms=(), planes=())
    view = views[inside]
    on = _on(item, view, config) if item.category in WALL_MOUNTED else None
    return msgspec.structs.replace(item, rooms=(view.room.id,), planes=(on,) if on else ())


def flat(item: Object, graph: SceneGraph, config: ObjectsConfig) -> bool:
    """Whether a thing that should stand out of its wall lies in the wall's face: a picture of one.

    Its centre is that of the side that was seen. What lies deeper behind the face was placed amiss.
    """
    if item.category not in SOLID or not item.planes:
        return False
    plane = graph.plane_by_id[item.planes[0]]
    return abs(float(np.dot(plane.normal, item.center)) + plane.offset) < config.stands_out


def _on(item: Object, view: RoomView, config: ObjectsConfig) -> str | None:
    """The face of a room that a thing hangs on: the nearest within reach."""
    point = np.array(item.center)
    near = [
        (gap, i)
        for d, i in view.faces(point, _thin_direction(item), config)
        if (gap := abs(d) - _reach(item, view.normals[i])) < config.wall_distance
    ]
    return view.planes[min(near)[1]].id if near else None


def _hosts(
    item: Object, views: tuple[RoomView, ...], config: ObjectsConfig
) -> list[tuple[int, int, float]]:
    """The nearest face near an opening, and that of the room behind the wall if there is one.

    An opening's middle lies in its wall, so it may be half a wall farther behind a face than it
    may be before it.
    """
    near = []
    point, thin = np.array(item.center), _thin_direction(item)
    for k, view in enumerate(views):
        for distance, i in view.faces(point, thin, config):
            if -config.wall_distance - config.wall_thickness / 2 < distance < config.wall_distance:
                near.append((abs(distance), k, i, distance))
    near.sort()
    if not near:
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


def related(
    graph: SceneGraph,
    config: ObjectsConfig | None = None,
    eyes: Mapping[str, Array] | None = None,
) -> SceneGraph:
    """The graph with the relations of all its objects found anew from geometry.

    ``eyes``: by object the place (3,) it was seen from, where that is known.
    """
    config = config or ObjectsConfig()
    views = room_views(graph, config)
    known = eyes or {}
    return graph.replace(
        objects=tuple(relate(o, views, config, known.get(o.id)) for o in graph.objects)
    )
