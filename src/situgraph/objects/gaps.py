"""Gaps that the LiDAR saw in walls, as further evidence for doors.

A wall that something stands before has a gap as well, and so has one with an opening that is no
door: over half of all gaps are such. So a gap makes no door and moves none; it confirms one that
the camera saw or the robot passed.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from situgraph.geometry.poses import Array
from situgraph.objects.config import ObjectsConfig
from situgraph.objects.doorways import EVIDENCE
from situgraph.scenegraph.graph import Object, SceneGraph

GAP = "gap"
ALONG = 0.17  # sine of the angle between a gap and the wall it is in; 10 degrees


class WallGap(NamedTuple):
    """An opening in the line of a wall: its ``ends`` (2, 2) in the plan, its ``floor``'s height.

    Both in the scene graph's frame (m). The wall is found by its place: a long one may be several
    faces, and the plane that SLAM found the gap in need not bound a room.
    """

    ends: Array
    floor: float


def supported(
    objects: Sequence[Object], gaps: Sequence[WallGap], graph: SceneGraph, config: ObjectsConfig
) -> tuple[Object, ...]:
    """The same objects, ``gap`` added to the evidence of each door that has one in its wall."""
    if not gaps:
        return tuple(objects)
    ends = np.array([gap.ends for gap in gaps], dtype=float)
    floors = np.array([gap.floor for gap in gaps])
    return tuple(
        _confirmed(o) if o.category == "door" and _near(o, ends, floors, graph, config).any() else o
        for o in objects
    )


def _near(
    door: Object, ends: Array, floors: Array, graph: SceneGraph, config: ObjectsConfig
) -> NDArray[np.bool_]:
    """Which gaps (n, 2, 2) over ``floors`` (n,) lie in a wall of the door, where the door is."""
    middle, span = ends.mean(axis=1), ends[:, 1] - ends[:, 0]
    rise = door.center[2] - floors
    found = np.zeros(len(ends), dtype=bool)
    for key in door.planes:
        plane = graph.plane_by_id[key]
        normal = np.array(plane.normal[:2])
        before = middle @ normal + plane.offset
        away = middle - np.array(door.center[:2])
        along = np.linalg.norm(away - (away @ normal)[:, None] * normal, axis=1)
        found |= (
            (np.abs(span @ normal) <= ALONG * np.linalg.norm(span, axis=1))
            & (np.abs(before) <= config.wall_thickness)
            & (along <= config.doorway_merge)
        )
    return found & (rise > 0.0) & (rise < config.storey_height)


def _confirmed(door: Object) -> Object:
    evidence = ",".join([*filter(None, [str(door.attributes.get(EVIDENCE, ""))]), GAP])
    return msgspec.structs.replace(door, attributes={**door.attributes, EVIDENCE: evidence})
