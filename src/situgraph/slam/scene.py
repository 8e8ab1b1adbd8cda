"""The map as a scene graph."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from situgraph.geometry.poses import Array, matrix_to_pose
from situgraph.scenegraph.graph import Keyframe, Plane, Pose, Room, SceneGraph, Storey, Warning
from situgraph.slam.planemap import MapPlane
from situgraph.slam.rooms import MapRoom
from situgraph.slam.storeys import BETWEEN

if TYPE_CHECKING:
    from situgraph.slam.slam import Slam


def scene_graph(slam: Slam) -> SceneGraph:
    """Everything observable, in the map frame.

    Planes carry ``sightings``, ``length`` (m seen), ``sigma_angle`` (rad) and ``sigma_offset`` (m)
    as of their last sighting; their normals point to where they were seen from: into their rooms.
    Rooms carry ``closed`` (share of the outline seen as wall), ``entered`` and ``area`` (m2). What
    is no room is a warning whose code starts with ``room-``.
    """
    slam.refresh()
    bounding = {p for r in slam.rooms.rooms.values() for p in r.planes}
    shown = [
        p
        for p in slam.planes.planes.values()
        if p.number in bounding or (p.certain(slam.config.map) and p.length > 0)
    ]
    reasons = tuple(Warning(r.code, r.sentence) for r in slam.reasons)
    return SceneGraph(
        kind="online",
        storeys=tuple(
            Storey(f"s{s.number}", elevation=round(s.elevation, 4)) for s in slam.storeys.storeys
        ),
        rooms=tuple(_room(slam, r) for r in slam.rooms.rooms.values()),
        planes=tuple(_plane(slam, p) for p in shown),
        keyframes=_keyframes(slam),
        warnings=(*slam.warnings, *reasons),
    )


def _keyframes(slam: Slam) -> tuple[Keyframe, ...]:
    poses = slam.graph.poses([k.number for k in slam.keyframes])
    rows = matrix_to_pose(poses) if len(poses) else np.empty((0, 7))
    return tuple(
        Keyframe(
            f"k{k.number}",
            k.stamp,
            _pose(row),
            attributes={} if k.storey == BETWEEN else {"storey": f"s{k.storey}"},
        )
        for k, row in zip(slam.keyframes, rows)
    )


def _room(slam: Slam, room: MapRoom) -> Room:
    outline = room.footprint
    floor = slam.storeys.storeys[room.storey].elevation
    middle = floor + slam.config.rooms.half_height
    return Room(
        f"r{room.number}",
        (outline.centre[0], outline.centre[1], middle),
        tuple(f"p{p}" for p in room.planes),
        storey=f"s{room.storey}",
        footprint=tuple((float(x), float(y)) for x, y in outline.corners),
        attributes={
            "closed": round(float(outline.closed), 3),
            "entered": room.entered,
            "area": round(outline.area, 2),
            "kind": "corridor" if room.corridor else "room",
        },
    )


def _plane(slam: Slam, plane: MapPlane) -> Plane:
    n = plane.plane[:3] / np.linalg.norm(plane.plane[:3])
    (ax, ay), (bx, by) = plane.ends().tolist()
    angle, offset = slam.graph.plane_sigma(plane.number, plane.sightings)
    return Plane(
        f"p{plane.number}",
        (float(n[0]), float(n[1]), float(n[2])),
        float(plane.plane[3]),
        extent=((ax, ay), (bx, by)),
        attributes={
            "sightings": plane.sightings,
            "length": round(plane.length, 3),
            "sigma_angle": round(angle, 6),
            "sigma_offset": round(offset, 5),
        },
    )


def _pose(row: Array) -> Pose:
    x, y, z, qx, qy, qz, qw = row.tolist()
    return (x, y, z, qx, qy, qz, qw)
