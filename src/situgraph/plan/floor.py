"""The plan view of a layout before it has planes and objects: polygons on wall centre lines."""

from __future__ import annotations

from collections.abc import Sequence

import msgspec
import numpy as np

from situgraph.geometry.poses import Array
from situgraph.plan.contacts import Faces, Index


class Floor(msgspec.Struct, frozen=True):
    """Room outlines on wall centre lines, in metres, counter-clockwise.

    ``corners`` (c, 2) holds all outlines one after the other; room i owns the rows ``first[i]`` to
    ``first[i + 1]``, so ``first`` has one entry more than there are rooms. ``thickness`` (n,) is
    the thickness in metres of the walls around a room: half of it stands inside the outline.
    """

    corners: Array
    first: Index
    thickness: Array

    @property
    def count(self) -> int:
        """The number of rooms."""
        return len(self.first) - 1

    @property
    def owner(self) -> Index:
        """The room (c,) of each corner, and of the face that starts there."""
        return np.repeat(np.arange(self.count), np.diff(self.first))

    @property
    def following(self) -> Index:
        """The row (c,) of the next corner of the same outline."""
        following = np.arange(1, len(self.corners) + 1)
        following[self.first[1:] - 1] = self.first[:-1]
        return following


def from_boxes(boxes: Array, thickness: Array) -> Floor:
    """A floor of rectangles (n, 4) ``x0 y0 x1 y1``; face order south, east, north, west."""
    corners = boxes[:, [0, 1, 2, 1, 2, 3, 0, 3]].reshape(-1, 2)
    return Floor(corners, 4 * np.arange(len(boxes) + 1), thickness)


def from_outlines(outlines: Sequence[Array], thickness: Array) -> Floor:
    """A floor of polygons (k, 2) with any number of corners."""
    first = np.concatenate([[0], np.cumsum([len(o) for o in outlines], dtype=np.int64)])
    corners = np.concatenate(list(outlines)) if outlines else np.zeros((0, 2))
    return Floor(corners, first, thickness)


def joined(floors: Sequence[Floor]) -> Floor:
    """Several floors as one, rooms in the order given."""
    shift = np.cumsum([0] + [len(f.corners) for f in floors])
    first = [f.first[:-1] + s for f, s in zip(floors, shift, strict=False)]
    return Floor(
        np.concatenate([f.corners for f in floors]),
        np.concatenate([*first, shift[-1:]]),
        np.concatenate([f.thickness for f in floors]),
    )


def turned(floor: Floor) -> Floor:
    """The floor after a half turn about the origin; rooms, corners and faces keep their order."""
    return Floor(-floor.corners, floor.first, floor.thickness)


def inner_corners(floor: Floor) -> Array:
    """Corners (c, 2) of the rooms' inner faces: each edge moved in by half the wall thickness."""
    p = floor.corners
    edge = p[floor.following] - p
    edge = edge / np.linalg.norm(edge, axis=1, keepdims=True)
    normal = np.stack([-edge[:, 1], edge[:, 0]], axis=1)
    half = 0.5 * floor.thickness[floor.owner]
    before = np.empty_like(floor.following)
    before[floor.following] = np.arange(len(p))
    # Offset lines n.x = n.p + half of this edge and of the one before meet in the inner corner.
    n1, n2 = normal[before], normal
    c1 = np.einsum("ij,ij->i", n1, p) + half
    c2 = np.einsum("ij,ij->i", n2, p) + half
    det = n1[:, 0] * n2[:, 1] - n1[:, 1] * n2[:, 0]
    return np.stack(
        [(c1 * n2[:, 1] - c2 * n1[:, 1]) / det, (c2 * n1[:, 0] - c1 * n2[:, 0]) / det], axis=1
    )


def inner_faces(floor: Floor, corners: Array) -> Faces:
    """The faces of the rooms of one storey, given their inner corners (c, 2)."""
    end = corners[floor.following]
    edge = end - corners
    edge = edge / np.linalg.norm(edge, axis=1, keepdims=True)
    normal = np.stack([-edge[:, 1], edge[:, 0]], axis=1)
    return Faces(corners, end, normal, floor.owner, np.zeros(len(corners), dtype=np.int64))


def centroids(floor: Floor, corners: Array) -> Array:
    """Area centroids (n, 2) of the polygons with these corners (c, 2)."""
    anchor = corners[floor.first[:-1]][floor.owner]
    p, q = corners - anchor, corners[floor.following] - anchor
    cross = p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]
    starts = floor.first[:-1]
    area = np.add.reduceat(cross, starts)
    moment = np.add.reduceat((p + q) * cross[:, None], starts)
    return corners[starts] + moment / (3.0 * area[:, None])
