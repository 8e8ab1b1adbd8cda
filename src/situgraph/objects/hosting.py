"""The place of a door or window in its wall, from the points that lie in that wall.

A door that stands open drags the centre of its ellipsoid into the room. What belongs to the opening
is what lies in the wall: the frame, the closed leaf, the pane. Its middle along the wall is the
place that a building model gives.
"""

from __future__ import annotations

import numpy as np

from situgraph.geometry.poses import Array
from situgraph.objects.relations import RoomView

IN_WALL = 0.2  # m; points this close to a face belong to the opening in it
ENOUGH = 20  # points in the wall that carry a place
TRIM = (2.0, 98.0)  # percentiles that bound the opening along and up the wall


def host(points: Array, views: tuple[RoomView, ...]) -> tuple[int, int] | None:
    """The room's view and face that most of the points (n, 3) of an opening lie in, or None."""
    best, found = 0, None
    center = points.mean(axis=0)
    for k, view in enumerate(views):
        distance = points @ view.normals.T + view.offsets
        for i in range(distance.shape[1]):
            count = int((np.abs(distance[:, i]) < IN_WALL).sum())
            foot = center - (view.normals[i] @ center + view.offsets[i] - 0.05) * view.normals[i]
            if count > best and view.sees(foot[None], 0.1)[0]:
                best, found = count, (k, i)
    return found if best >= ENOUGH else None


def place(points: Array, view: RoomView, face: int) -> Array:
    """The middle (3,) of the points (n, 3) that lie in a face, on that face."""
    normal, offset = view.normals[face], view.offsets[face]
    inside = points[np.abs(points @ normal + offset) < IN_WALL]
    along = np.array([-normal[1], normal[0], 0.0])
    s = np.percentile(inside @ along, TRIM).mean()
    z = np.percentile(inside[:, 2], TRIM).mean()
    on_face: Array = s * along - offset * normal
    on_face[2] = z
    return on_face
