"""Which wall a door or window lies in: the face that most of its points are in.

An open leaf that rests against another wall stands a little before it; frame, closed leaf and pane
lie behind the face. What reaches past the corner of the room is not in the wall: there lies the
jamb of a door in the wall across, often named door together with the wall beside it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from situgraph.geometry.poses import Array
from situgraph.objects.relations import RoomView, tangent

BEFORE, BEHIND = 0.15, 0.25  # m; points so near a face, on either side, are of an opening in it
CORNER = 0.05  # m; how well a corner is known
ENOUGH = 12  # points in the wall that carry a place
SAMPLE = 400  # points of a thing that are enough to tell which wall it is in


def host_of(points: Array, hits: Array, views: tuple[RoomView, ...]) -> tuple[int, int] | None:
    """The room's view and the face that most of the points (n, 3) lie in, or None.

    ``hits`` (n,): how many frames saw each.
    """
    best, found = 0.0, None
    center = np.average(points, axis=0, weights=hits)
    every = max(1, len(points) // SAMPLE)
    points, hits = points[::every], hits[::every]
    for k, view in enumerate(views):
        near = in_walls(points, view)
        weights, counts = hits @ near, near.sum(axis=0) * every
        for i in np.flatnonzero((weights > best) & (counts >= ENOUGH)).tolist():
            foot = center - (view.normals[i] @ center + view.offsets[i] - 0.05) * view.normals[i]
            if weights[i] > best and view.sees(foot[None], 0.1)[0]:
                best, found = float(weights[i]), (k, i)
    return found


def in_walls(points: Array, view: RoomView) -> NDArray[np.bool_]:
    """Which points (n, 3) are in the wall behind each face of a room: (n, faces)."""
    distance = points @ view.normals.T + view.offsets
    within: NDArray[np.bool_] = (distance < BEFORE) & (distance > -BEHIND)
    for i, side in enumerate(view.sides):
        if side is not None and within[:, i].any():
            along = points @ tangent(view.normals[i])
            within[:, i] &= (along > side[0] - CORNER) & (along < side[1] + CORNER)
    return within
