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

from situgraph.geometry.poses import Array
from situgraph.objects.config import ObjectsConfig
from situgraph.objects.doorways import EVIDENCE
from situgraph.scenegraph.graph import Object, Plane, SceneGraph

GAP = "gap"
ALONG = 0.17  # sine of the angle between a gap and the wall it is in; 10 degrees
PAST = 0.6  # m; half of a door, and a jamb that was not seen


class WallGap(NamedTuple):
    """An opening in the line of a wall: its ``ends`` (2, 2) in the plan, its ``floor``'s height.

    Both in the scene graph's frame (m). The wall is found by its place: a long one may be several
    faces, and the plane that SLAM found the gap in need not bound a room.
    """

    ends: Array
    floor: float

    @property
    def width(self) -> float:
        """From end to end (m)."""
        return float(np.linalg.norm(self.ends[1] - self.ends[0]))

    def lies_in(self, normal: Array, offset: float, height: float, config: ObjectsConfig) -> bool:
        """Whether it is in the wall of a face (normal (3,), offset) of a room at a ``height``."""
        span, middle = self.ends[1] - self.ends[0], self.ends.mean(axis=0)
        return bool(
            abs(float(span @ normal[:2])) <= ALONG * self.width
            and abs(float(middle @ normal[:2]) + offset) <= config.wall_thickness
            and 0.0 < height - self.floor < config.storey_height
        )


def in_walls(
    passages: Sequence[Object], gaps: Sequence[WallGap], graph: SceneGraph, config: ObjectsConfig
) -> list[Object]:
    """The passages that lead through a wall, not past the end of one into an open side.

    There the wall was seen, on both sides or up to the doorway, or the LiDAR saw a gap of its.
    """
    return [
        p
        for p in passages
        if any(_beside(p, graph.plane_by_id[key]) <= PAST for key in p.planes)
        or any(_opens(p, gap, graph, config) for gap in gaps)
    ]


def _beside(passage: Object, plane: Plane) -> float:
    """How far (m) a passage lies past the seen ends of a face; 0 between them or if unknown."""
    if plane.extent is None:
        return 0.0
    along = np.array([-plane.normal[1], plane.normal[0]])
    low, high = sorted((np.array(plane.extent) @ along).tolist())
    at = float(np.array(passage.center[:2]) @ along)
    return max(float(low) - at, at - float(high), 0.0)


def supported(
    objects: Sequence[Object], gaps: Sequence[WallGap], graph: SceneGraph, config: ObjectsConfig
) -> tuple[Object, ...]:
    """The same objects, ``gap`` added to the evidence of each door that has one in its wall."""
    return tuple(
        _confirmed(o) if any(_opens(o, gap, graph, config) for gap in gaps) else o for o in objects
    )


def _opens(door: Object, gap: WallGap, graph: SceneGraph, config: ObjectsConfig) -> bool:
    """Whether a gap lies in a wall of the door, where the door is."""
    if door.category != "door":
        return False
    away = gap.ends.mean(axis=0) - np.array(door.center[:2])
    for key in door.planes:
        plane = graph.plane_by_id[key]
        normal = np.array(plane.normal)
        along = float(np.linalg.norm(away - (away @ normal[:2]) * normal[:2]))
        if along <= config.doorway_merge and gap.lies_in(
            normal, plane.offset, door.center[2], config
        ):
            return True
    return False


def _confirmed(door: Object) -> Object:
    evidence = ",".join([*filter(None, [str(door.attributes.get(EVIDENCE, ""))]), GAP])
    return msgspec.structs.replace(door, attributes={**door.attributes, EVIDENCE: evidence})
