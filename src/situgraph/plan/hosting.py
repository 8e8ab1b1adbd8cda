"""Which faces of which rooms a door or window is in."""

from __future__ import annotations

from collections.abc import Sequence

import msgspec
import numpy as np
from numpy.typing import NDArray

from situgraph.geometry.poses import Array
from situgraph.plan.backing import PARALLEL
from situgraph.plan.config import PlanConfig
from situgraph.plan.openings import Box
from situgraph.plan.rooms import RoomShape


class Host(msgspec.Struct, frozen=True):
    """A face that carries an opening: room and face numbers, the share of its width there."""

    room: int
    face: int
    share: float
    gap: float


class RoomFaces(msgspec.Struct, frozen=True):
    """The faces of all rooms, one row a stretch: where they are and whose they are."""

    normal: Array  # (n, 2)
    offset: Array  # (n,)
    ends: Array  # (n, 2, 2)
    bottom: Array  # (n,)
    top: Array  # (n,)
    room: NDArray[np.int64]
    face: NDArray[np.int64]


def room_faces(rooms: Sequence[RoomShape]) -> RoomFaces:
    """The faces of rooms as arrays; a face counts once for each of its stretches."""
    rows = [
        (*f.normal, f.offset, *f.point(lo), *f.point(hi), f.bottom, f.top, r, k)
        for r, room in enumerate(rooms)
        for k, f in enumerate(room.faces)
        for lo, hi in f.spans
    ]
    table = np.array(rows, dtype=float).reshape(-1, 11)
    return RoomFaces(
        normal=table[:, :2],
        offset=table[:, 2],
        ends=table[:, 3:7].reshape(-1, 2, 2),
        bottom=table[:, 7],
        top=table[:, 8],
        room=table[:, 9].astype(np.int64),
        face=table[:, 10].astype(np.int64),
    )


def hosts(box: Box, faces: RoomFaces, overlap: float, config: PlanConfig) -> list[Host]:
    """The faces an opening is in, on both sides of its wall, widest share first.

    A face hosts the opening when it is parallel to its wall, the opening begins within ``wall_gap``
    behind it (not in front: that is a hole in the far wall), and the face runs along at least
    ``overlap`` of its width and half of its height.
    """
    n, t = np.array(box.across), np.array(box.along)
    middle = np.array(box.center[:2])
    distance = faces.normal @ middle + faces.offset  # of the box's middle, > 0 inside the room
    depth = box.half[1]
    parallel = np.abs(faces.normal @ n) >= PARALLEL
    near = (distance <= depth + 1e-3) & (distance >= -depth - config.wall_gap)
    along = np.sort(faces.ends @ t, axis=1) - middle @ t
    half = max(box.half[0], 1e-3)
    shared = np.minimum(along[:, 1], half) - np.maximum(along[:, 0], -half)
    share = shared / (2.0 * half)
    height = np.minimum(faces.top, box.top) - np.maximum(faces.bottom, box.bottom)
    enough = height >= 0.5 * np.minimum(2.0 * box.half[2], faces.top - faces.bottom)
    found: dict[tuple[int, int], Host] = {}
    for row in np.flatnonzero(parallel & near & (share > 0.0) & enough):
        key = (int(faces.room[row]), int(faces.face[row]))
        before = found[key].share if key in found else 0.0
        gap = -float(distance[row]) - depth
        found[key] = Host(*key, min(1.0, before + float(share[row])), gap)
    kept = [h for h in found.values() if h.share >= overlap]
    return sorted(kept, key=lambda h: (-round(h.share, 3), abs(h.gap), h.room, h.face))
