"""An online graph in the building frame, where a solution of a match has it."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from situgraph.scenegraph.graph import SceneGraph
from situgraph.scenegraph.transform import transformed
from situgraph.view.record import Solution


def placed(online: SceneGraph, solution: Solution) -> SceneGraph:
    """The graph moved by the solution: of a bent map each part by its own placement.

    A room that is not explained goes with the explained one next to it, planes and objects go with
    the first of their rooms, and what has no room with the room next to it.
    """
    if not solution.parts:
        return transformed(online, solution.transform)
    moved = [transformed(online, part.transform) for part in solution.parts]
    home = {room: k for k, part in enumerate(solution.parts) for room in part.rooms}
    known, parts = np.array([online.room_by_id[r].center for r in home]), [*home.values()]

    def nearest(point: Iterable[float]) -> int:
        apart = np.linalg.norm(known - np.array([*point]), axis=1)
        return parts[int(apart.argmin())]

    rooms = [home[r.id] if r.id in home else nearest(r.center) for r in online.rooms]
    of_room = {r.id: k for r, k in zip(online.rooms, rooms)}
    of_plane: dict[str, int] = {}
    for room, k in zip(online.rooms, rooms):
        for plane in room.planes:
            of_plane.setdefault(plane, k)
    objects = [of_room[o.rooms[0]] if o.rooms else nearest(o.center) for o in online.objects]
    frames = [nearest(frame.pose[:3]) for frame in online.keyframes]
    return moved[0].replace(
        rooms=tuple(moved[k].rooms[i] for i, k in enumerate(rooms)),
        planes=tuple(moved[of_plane.get(p.id, 0)].planes[i] for i, p in enumerate(online.planes)),
        objects=tuple(moved[k].objects[i] for i, k in enumerate(objects)),
        keyframes=tuple(moved[k].keyframes[i] for i, k in enumerate(frames)),
    )
