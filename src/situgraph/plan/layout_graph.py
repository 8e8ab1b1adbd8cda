"""From the columns of a layout to its scene graph."""

from __future__ import annotations

import math

import numpy as np

from situgraph.geometry.poses import Placement
from situgraph.plan.contacts import Faces
from situgraph.plan.floor import Floor, centroids
from situgraph.plan.layout_config import LayoutConfig
from situgraph.plan.layout_items import KINDS, Items
from situgraph.scenegraph.graph import Ellipsoid, Object, Plane, Room, SceneGraph, Storey


def build_graph(
    floor: Floor,
    faces: Faces,
    items: Items,
    rooms: int,
    storeys: int,
    config: LayoutConfig,
    frame: Placement,
    name: str,
) -> SceneGraph:
    """The first ``rooms`` rooms of ``storeys`` copies of a floor, moved into the building frame.

    ``faces`` are those of one floor; ``items`` refer to rooms and faces of all storeys.
    """
    storey_nodes = tuple(
        Storey(f"s{k}", f"level {k}", frame.z + k * config.storey_height, config.room_height)
        for k in range(storeys)
    )
    corners = frame.points(faces.start)
    ends = [tuple(p) for p in corners.tolist()]
    following = [ends[i] for i in floor.following.tolist()]
    normal = np.column_stack([frame.vectors(faces.normal), np.zeros(len(ends))])
    offset = (-np.einsum("ij,ij->i", normal[:, :2], corners)).tolist()
    normals = [tuple(n) for n in normal.tolist()]
    centers = frame.points(centroids(floor, faces.start)).tolist()
    first = floor.first.tolist()
    room_nodes, plane_nodes = [], []
    for k in range(rooms):
        level, i = divmod(k, floor.count)
        base = level * len(ends)
        z = frame.z + level * config.storey_height + 0.5 * config.room_height
        around = range(first[i], first[i + 1])
        plane_ids = tuple(f"p{base + f}" for f in around)
        footprint = tuple(ends[first[i] : first[i + 1]])
        center = (centers[i][0], centers[i][1], z)
        room_nodes.append(Room(f"r{k}", center, plane_ids, f"s{level}", None, footprint))
        plane_nodes += [
            Plane(p, normals[f], offset[f], (ends[f], following[f]))
            for p, f in zip(plane_ids, around, strict=True)
        ]
    return SceneGraph(
        name=name,
        kind="prior",
        storeys=storey_nodes,
        rooms=tuple(room_nodes),
        planes=tuple(plane_nodes),
        objects=_object_nodes(items, frame),
    )


def _object_nodes(items: Items, frame: Placement) -> tuple[Object, ...]:
    center = frame.points(items.center).tolist()
    half_yaw = 0.5 * (items.yaw + frame.yaw)
    turn = np.stack([np.sin(half_yaw), np.cos(half_yaw)], axis=1).tolist()
    width = (0.5 * items.width).tolist()
    columns = zip(
        items.kind.tolist(),
        center,
        turn,
        width,
        items.room.tolist(),
        items.face.tolist(),
        strict=True,
    )
    nodes = []
    for n, (kind, at, (s, c), half_width, room, face) in enumerate(columns):
        measures = KINDS[kind]
        ellipsoid = Ellipsoid(
            (half_width, 0.5 * measures.depth, 0.5 * measures.height), (0.0, 0.0, s, c)
        )
        nodes.append(
            Object(
                f"o{n}",
                measures.category,
                (at[0], at[1], at[2]),
                ellipsoid,
                tuple(f"r{i}" for i in room if i >= 0),
                tuple(f"p{i}" for i in face if i >= 0),
            )
        )
    return tuple(nodes)


def random_frame(config: LayoutConfig, rng: np.random.Generator) -> Placement:
    """Where a layout lies in the building frame: any yaw, a position within the range."""
    x, y = rng.uniform(-config.position_range, config.position_range, 2)
    return Placement(float(x), float(y), 0.0, float(rng.uniform(-math.pi, math.pi)))
