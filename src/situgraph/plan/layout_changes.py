"""Deliberate changes of a graph: broken symmetry, and the mirror image of a building."""

from __future__ import annotations

from typing import Literal

import msgspec
import numpy as np

from situgraph.errors import InputError
from situgraph.scenegraph.graph import Ellipsoid, Object, Pose, Room, SceneGraph, Vec2, Vec4

Change = Literal["object", "wall"]

# How far a wall is moved into its room (m): more than any tolerance, less than a room.
WALL_SHIFT = (0.35, 0.6)
# Things closer (m) to the middle of the layout than this may be their own image.
MIDDLE = 0.5

_change = msgspec.structs.replace


def break_symmetry(graph: SceneGraph, seed: int = 0, change: Change = "object") -> SceneGraph:
    """The graph with one thing altered, so that it no longer maps onto itself.

    ``object`` removes one object or gives it another category; ``wall`` moves one face of a room
    in by 0.35 to 0.6 m, and what hangs on it. The middle of the layout is spared, where a thing
    may be its own image. ``attributes['broken']`` names the node.

    Raises:
        InputError: there is nothing to alter.
    """
    rng = np.random.default_rng(seed)
    broken = _without_object(graph, rng) if change == "object" else _with_wall_moved(graph, rng)
    if broken is None:
        raise InputError(graph.name or "graph", f"no {change} to alter", "alter something else")
    return broken


def mirrored(graph: SceneGraph) -> SceneGraph:
    """The mirror image in the plane x = 0: a building no motion takes to the original.

    Footprints stay counter-clockwise, and the order of a room's planes turns round with them.
    """
    return graph.replace(
        name=None if graph.name is None else f"{graph.name}, mirrored",
        rooms=tuple(_mirrored_room(r) for r in graph.rooms),
        planes=tuple(
            _change(
                p,
                normal=(-p.normal[0], p.normal[1], p.normal[2]),
                extent=None if p.extent is None else (_flip(p.extent[1]), _flip(p.extent[0])),
            )
            for p in graph.planes
        ),
        objects=tuple(_mirrored_object(o) for o in graph.objects),
        keyframes=tuple(_change(k, pose=_mirrored_pose(k.pose)) for k in graph.keyframes),
    )


def _without_object(graph: SceneGraph, rng: np.random.Generator) -> SceneGraph | None:
    middle = _middle(graph)
    able = [o for o in graph.objects if _away(o.center[:2], middle) > MIDDLE]
    if not able:
        return None
    chosen = able[int(rng.integers(len(able)))]
    others = sorted(graph.categories - {chosen.category})
    objects: tuple[Object, ...]
    if others and rng.random() < 0.5:
        other = _change(chosen, category=others[int(rng.integers(len(others)))])
        objects = tuple(other if o.id == chosen.id else o for o in graph.objects)
    else:
        objects = tuple(o for o in graph.objects if o.id != chosen.id)
    return graph.replace(objects=objects, attributes={**graph.attributes, "broken": chosen.id})


def _with_wall_moved(graph: SceneGraph, rng: np.random.Generator) -> SceneGraph | None:
    able = [
        (r, p)
        for r in graph.rooms
        if r.footprint is not None and len(r.footprint) == len(r.planes) == 4
        for p in r.planes
    ]
    if not able:
        return None
    room, plane_id = able[int(rng.integers(len(able)))]
    assert room.footprint is not None
    moved = graph.plane_by_id[plane_id]
    shift = float(rng.uniform(*WALL_SHIFT))
    step = shift * np.array(moved.normal[:2])
    outline = np.array(room.footprint)
    on = np.abs(outline @ np.array(moved.normal[:2]) + moved.offset) < 1e-3
    outline[on] += step
    corners = [(float(x), float(y)) for x, y in outline]
    planes = {p.id: p for p in graph.planes}
    for k, p in enumerate(room.planes):
        planes[p] = _change(planes[p], extent=(corners[k], corners[(k + 1) % 4]))
    planes[plane_id] = _change(planes[plane_id], offset=moved.offset - shift)
    x, y, z = room.center
    center = (x + 0.5 * float(step[0]), y + 0.5 * float(step[1]), z)
    new_room = _change(room, footprint=tuple(corners), center=center)
    objects = tuple(
        _change(o, center=(o.center[0] + step[0], o.center[1] + step[1], o.center[2]))
        if plane_id in o.planes
        else o
        for o in graph.objects
    )
    return graph.replace(
        rooms=tuple(new_room if r.id == room.id else r for r in graph.rooms),
        planes=tuple(planes[p.id] for p in graph.planes),
        objects=objects,
        attributes={**graph.attributes, "broken": plane_id},
    )


def _middle(graph: SceneGraph) -> Vec2:
    points = np.array([p for r in graph.rooms for p in (r.footprint or (r.center[:2],))])
    x, y = (0.5 * (points.min(axis=0) + points.max(axis=0))).tolist()
    mean_x, mean_y = np.mean([r.center[:2] for r in graph.rooms], axis=0).tolist()
    # Both are the centre of a half turn; where they differ there is none.
    return 0.5 * (x + mean_x), 0.5 * (y + mean_y)


def _away(point: Vec2, middle: Vec2) -> float:
    return float(np.hypot(point[0] - middle[0], point[1] - middle[1]))


def _flip(point: Vec2) -> Vec2:
    return -point[0], point[1]


def _mirrored_room(room: Room) -> Room:
    x, y, z = room.center
    outline = room.footprint
    if outline is None:
        return _change(room, center=(-x, y, z))
    # Corner k starts edge k: read backwards, the corner that starts the last edge comes first.
    corners = tuple(_flip(p) for p in (outline[0], *outline[:0:-1]))
    return _change(room, center=(-x, y, z), footprint=corners, planes=room.planes[::-1])


def _mirrored_object(item: Object) -> Object:
    x, y, z = item.center
    shape = item.ellipsoid
    if shape is not None:
        shape = Ellipsoid(shape.axes, _mirrored_turn(shape.rotation))
    return _change(item, center=(-x, y, z), ellipsoid=shape)


def _mirrored_turn(turn: Vec4) -> Vec4:
    """The turn M R M for the mirror M in x; an ellipsoid does not mind its own mirror image."""
    x, y, z, w = turn
    return x, -y, -z, w


def _mirrored_pose(pose: Pose) -> Pose:
    x, y, z, *turn = pose
    qx, qy, qz, qw = turn
    return (-x, y, z, *_mirrored_turn((qx, qy, qz, qw)))
