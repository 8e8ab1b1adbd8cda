"""Doorways from the trajectory alone (paper, section 'Doorways'): no camera is needed.

Where the robot's path leaves one room, it went through an opening. The last position in a room and
the first one outside it span a segment; its cut with the room's walls gives the place and the face.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from situgraph.geometry.poses import Array
from situgraph.objects.config import ObjectsConfig
from situgraph.objects.relations import RoomView, room_of, room_views
from situgraph.scenegraph.graph import Ellipsoid, Object, SceneGraph

DOORWAY = "door"  # the category that a trajectory shows
EVIDENCE = "evidence"  # attribute of an object: which kinds of evidence it stands on
TRAJECTORY = "trajectory"


@dataclass(frozen=True)
class Crossing:
    """One passage: the place (3,) on the wall, the room's view and the index of its face."""

    place: Array
    view: int
    face: int


def doorways(
    path: Array, graph: SceneGraph, config: ObjectsConfig | None = None
) -> tuple[Object, ...]:
    """Doorways crossed by a path of robot positions (n, 3) in the graph's frame, in order.

    The denser the path, the better the place: keyframes alone are allowed. A doorway between two
    known rooms is related to both, each through its own face; its height is a usual one, since the
    path does not tell. Passing the same doorway again adds nothing new.
    """
    config = config or ObjectsConfig()
    views = room_views(graph, config)
    crossings = _crossings(np.asarray(path, dtype=float), views)
    merged: list[list[Crossing]] = []
    for crossing in crossings:
        for group in merged:
            if _same(group, crossing, views, config):
                group.append(crossing)
                break
        else:
            merged.append([crossing])
    through = [group for group in merged if not _around(group)]
    return tuple(_doorway(k, group, views, config) for k, group in enumerate(through))


def _crossings(path: Array, views: tuple[RoomView, ...]) -> list[Crossing]:
    """Every passage through a face of a room, out of it or into it, in the order of the path."""
    inside = room_of(path, views, 0.0)
    found = []
    for k in range(1, len(path)):
        if inside[k - 1] == inside[k]:
            continue
        out, back = (inside[k - 1], path[k - 1], path[k]), (inside[k], path[k], path[k - 1])
        for room, start, end in (out, back):
            if room is not None and (crossing := _exit(room, start, end, views)) is not None:
                found.append(crossing)
    return found


def _exit(room: int, start: Array, end: Array, views: tuple[RoomView, ...]) -> Crossing | None:
    """Where the segment from ``start`` in a room to ``end`` outside leaves it: its first face.

    None where there is no such face, or no wall behind it.
    """
    view = views[room]
    a = view.normals @ start + view.offsets
    b = view.normals @ end + view.offsets
    cut = [(a[i] / (a[i] - b[i]), i) for i in range(len(a)) if a[i] >= 0.0 > b[i]]
    if not cut:
        return None
    s, i = min(cut)
    if view.planes[i].virtual:
        return None
    return Crossing(start + s * (end - start), room, int(i))


def _same(
    group: list[Crossing], new: Crossing, views: tuple[RoomView, ...], config: ObjectsConfig
) -> bool:
    """Whether a passage goes through the doorway of a group: near it, through a parallel face."""
    first = group[0]
    n0 = views[first.view].normals[first.face]
    n1 = views[new.view].normals[new.face]
    if abs(float(n0 @ n1)) < 0.9:
        return False
    apart = new.place - np.mean([c.place for c in group], axis=0)
    across = abs(float(apart @ n0))
    along = float(np.linalg.norm(apart[:2] - (apart @ n0) * n0[:2]))
    return along < config.doorway_merge and across < config.wall_thickness


def _around(group: list[Crossing]) -> bool:
    """Whether the passages lead past a wall's end from a room into itself."""
    return len({c.view for c in group}) == 1 and len({(c.view, c.face) for c in group}) > 1


def _doorway(
    number: int, group: list[Crossing], views: tuple[RoomView, ...], config: ObjectsConfig
) -> Object:
    faces = dict.fromkeys((c.view, c.face) for c in group)
    # One side at a time, so that passing twice on one side does not pull the place off the wall.
    sides = [np.mean([c.place for c in group if (c.view, c.face) == f], axis=0) for f in faces]
    x, y, _ = (float(v) for v in np.mean(sides, axis=0))
    view = views[group[0].view]
    normal = view.normals[group[0].face]
    yaw = math.atan2(normal[1], normal[0]) - math.pi / 2.0
    ellipsoid = Ellipsoid(
        (config.doorway_width / 2.0, 0.1, config.doorway_height / 2.0),
        (0.0, 0.0, math.sin(yaw / 2.0), math.cos(yaw / 2.0)),
    )
    return Object(
        f"doorway{number}",
        DOORWAY,
        (x, y, view.floor + config.doorway_height / 2.0),
        ellipsoid,
        tuple(dict.fromkeys(views[k].room.id for k, _ in faces)),
        tuple(dict.fromkeys(views[k].planes[i].id for k, i in faces)),
        attributes={EVIDENCE: TRAJECTORY, "leaf": False},
    )
