"""The mirror image of a scene graph."""

from __future__ import annotations

import msgspec

from situgraph.scenegraph.graph import Ellipsoid, Object, Pose, Room, SceneGraph, Vec2, Vec4

_change = msgspec.structs.replace


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
