"""A whole scene graph seen from another frame."""

from __future__ import annotations

import msgspec
import numpy as np

from situgraph.geometry.poses import Array, Placement, matrix_to_pose, pose_to_matrix
from situgraph.scenegraph.graph import Ellipsoid, Pose, SceneGraph, Vec2, Vec3, Vec4


def transformed(graph: SceneGraph, placement: Placement) -> SceneGraph:
    """The graph with every node moved by ``placement`` (ids, relations and attributes stay)."""
    change = msgspec.structs.replace
    turn = placement.matrix()
    normals, offsets = placement.planes(*graph.plane_arrays(p.id for p in graph.planes))
    planes = tuple(
        change(
            p,
            normal=_triple(n),
            offset=float(d),
            extent=None
            if p.extent is None
            else (_pair(placement, p.extent[0]), _pair(placement, p.extent[1])),
        )
        for p, n, d in zip(graph.planes, normals, offsets, strict=True)
    )
    rooms = tuple(
        change(
            r,
            center=_triple(placement.points(r.center)),
            footprint=None
            if r.footprint is None
            else tuple((float(x), float(y)) for x, y in placement.points(r.footprint)),
        )
        for r in graph.rooms
    )
    objects = tuple(
        change(
            o,
            center=_triple(placement.points(o.center)),
            ellipsoid=None if o.ellipsoid is None else _turned(o.ellipsoid, turn),
        )
        for o in graph.objects
    )
    frames = tuple(change(k, pose=_moved(k.pose, turn)) for k in graph.keyframes)
    storeys = tuple(change(s, elevation=s.elevation + placement.z) for s in graph.storeys)
    return graph.replace(
        storeys=storeys, rooms=rooms, planes=planes, objects=objects, keyframes=frames
    )


def _triple(values: Array) -> Vec3:
    x, y, z = (float(v) for v in values)
    return x, y, z


def _pair(placement: Placement, point: Vec2) -> Vec2:
    x, y = placement.points(point)
    return float(x), float(y)


def _moved(pose: Pose, turn: Array) -> Pose:
    x, y, z, qx, qy, qz, qw = (float(v) for v in matrix_to_pose(turn @ pose_to_matrix(pose)))
    return x, y, z, qx, qy, qz, qw


def _turned(ellipsoid: Ellipsoid, turn: Array) -> Ellipsoid:
    only = np.eye(4)
    only[:3, :3] = turn[:3, :3]
    pose = matrix_to_pose(only @ pose_to_matrix((0.0, 0.0, 0.0, *ellipsoid.rotation)))
    rotation: Vec4 = (float(pose[3]), float(pose[4]), float(pose[5]), float(pose[6]))
    return Ellipsoid(ellipsoid.axes, rotation)
