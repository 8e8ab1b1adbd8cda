"""Doors and windows placed in their walls."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import msgspec
import numpy as np

from situgraph.geometry.poses import Array, pose_to_matrix
from situgraph.scenegraph.graph import Object, SceneGraph
from situgraph.view.config import ViewConfig
from situgraph.view.faces import Faces

KINDS = ("door", "window")
_NEAR = 0.6  # m, a door this close to a face is in its wall
_LEAST_DEPTH = 0.06  # m


class Opening(msgspec.Struct, frozen=True):
    """A door or window: its middle, the unit normal (2,) of its wall into one room, half its width.

    ``front`` and ``back`` (m) are the wall's faces along the normal, seen from the middle.
    """

    id: str
    kind: str
    middle: Array
    normal: Array
    half_width: float
    front: float
    back: float
    leaf: bool = True

    @property
    def tangent(self) -> Array:
        """Along the wall."""
        return np.array([-self.normal[1], self.normal[0]])

    def outline(self, margin: float = 0.0) -> Array:
        """The opening's rectangle (4, 2), thicker than the wall by ``margin`` on either face."""
        t, n = self.half_width * self.tangent, self.normal
        front, back = (self.front + margin) * n, (self.back - margin) * n
        corners: Array = self.middle + np.array([front - t, front + t, back + t, back - t])
        return corners


def half_extent(item: Object, direction: Array) -> float | None:
    """Half the size (m) of an object's ellipsoid along a horizontal unit direction (2,)."""
    if item.ellipsoid is None:
        return None
    turn = pose_to_matrix((0.0, 0.0, 0.0, *item.ellipsoid.rotation))[:2, :3]
    return float(np.linalg.norm(np.array(item.ellipsoid.axes) * (direction @ turn)))


def place_openings(
    graph: SceneGraph, objects: Iterable[Object], faces: Faces, config: ViewConfig
) -> tuple[tuple[Opening, ...], tuple[Object, ...]]:
    """Doors and windows in their walls, and the objects that are neither or are near no wall."""
    doors = [o for o in objects if o.category in KINDS]
    rest = [o for o in objects if o.category not in KINDS]
    index = {id: i for i, id in enumerate(faces.ids)}
    nearest = _nearest_faces(doors, faces)
    placed = []
    for item, near in zip(doors, nearest):
        hosts = [i for i in (_host(graph, index, p) for p in item.planes) if i is not None]
        if not hosts and near is None:
            rest.append(item)
            continue
        placed.append(_opening(item, faces, hosts or [near or 0], config))
    return tuple(placed), tuple(rest)


def _host(graph: SceneGraph, index: dict[str, int], plane: str) -> int | None:
    return index.get(plane) if plane in graph.plane_by_id else None


def _nearest_faces(items: Sequence[Object], faces: Faces) -> list[int | None]:
    if not items or not faces.ids:
        return [None] * len(items)
    import shapely

    tree = shapely.STRtree(shapely.linestrings(faces.segments))
    points = shapely.points([o.center[:2] for o in items])
    found: list[int | None] = [None] * len(items)
    for item, face in tree.query_nearest(points, max_distance=_NEAR, all_matches=False).T:
        found[int(item)] = int(face)
    return found


def _opening(item: Object, faces: Faces, hosts: list[int], config: ViewConfig) -> Opening:
    middle, normal = np.array(item.center[:2]), faces.normals[hosts[0]]
    offsets = [float((faces.segments[i][0] - middle) @ normal) for i in hosts]
    facing = [float(faces.normals[i] @ normal) for i in hosts]
    front = offsets[0]
    others = [o for o, f in zip(offsets, facing) if f < -0.9 and 0.0 < front - o <= config.wall_gap]
    back = min(others) if others else front - config.one_face_thickness
    if not back - 0.3 <= 0.0 <= front + 0.3:  # a detection beside its wall stays where it was seen
        front, back = 0.5 * config.one_face_thickness, -0.5 * config.one_face_thickness
    if front - back < _LEAST_DEPTH:
        front, back = back + _LEAST_DEPTH, back
    half = half_extent(item, np.array([-normal[1], normal[0]])) or 0.5 * config.door_width
    leaf = item.attributes.get("leaf", True) is not False
    return Opening(item.id, item.category, middle, normal, half, front, back, leaf)
