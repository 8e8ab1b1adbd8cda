"""Gaps that the LiDAR saw in walls, as evidence for doors that the camera saw too."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import msgspec
import numpy as np

from situgraph.geometry.poses import Array
from situgraph.objects.config import ObjectsConfig
from situgraph.objects.doorways import EVIDENCE
from situgraph.objects.reconcile import along_wall, united
from situgraph.objects.relations import RoomView, relate
from situgraph.scenegraph.graph import Ellipsoid, Object, SceneGraph

GAP = "gap"


class WallGap(NamedTuple):
    """An opening in the line of the scene graph's plane ``plane``: its ``ends`` (2, 2), metres."""

    plane: str
    ends: Array


def gap_doors(
    gaps: Sequence[WallGap], views: tuple[RoomView, ...], config: ObjectsConfig
) -> list[Object]:
    """A door as wide as each gap, with its relations; gaps in no room's wall are left out."""
    sides = {
        plane.id: (view, view.normals[i]) for view in views for i, plane in enumerate(view.planes)
    }
    found = []
    for number, gap in enumerate(gaps):
        if gap.plane not in sides:
            continue
        view, normal = sides[gap.plane]
        ends = np.asarray(gap.ends, dtype=float)
        x, y = (float(v) for v in ends.mean(axis=0))
        width = float(np.linalg.norm(ends[1] - ends[0]))
        yaw = math.atan2(normal[1], normal[0]) - math.pi / 2.0
        door = Object(
            f"gap{number}",
            "door",
            (x, y, view.floor + config.doorway_height / 2.0),
            Ellipsoid(
                (max(width, config.opening_width) / 2.0, 0.1, config.doorway_height / 2.0),
                (0.0, 0.0, math.sin(yaw / 2.0), math.cos(yaw / 2.0)),
            ),
            attributes={EVIDENCE: GAP},
        )
        placed = relate(door, views, config)
        if placed.planes:
            found.append(placed)
    return found


def backs(doors: Sequence[Object], weak: Object, graph: SceneGraph, config: ObjectsConfig) -> bool:
    """Whether one of the gaps' doors is where a door that was seen too seldom should be."""
    return weak.category == "door" and any(
        along_wall(weak, d, graph) <= config.doorway_merge for d in doors
    )


def supported(
    objects: Sequence[Object], doors: Sequence[Object], graph: SceneGraph, config: ObjectsConfig
) -> tuple[Object, ...]:
    """The objects, those doors that a gap confirms with that evidence added; no new ones."""
    out = list(objects)
    for door in doors:
        near = [
            (apart, k)
            for k, o in enumerate(out)
            if o.category == "door"
            and (apart := along_wall(o, door, graph)) <= config.doorway_merge
        ]
        if near:
            _, k = min(near)
            # The place stays: where a wall was seen to end is coarser than a frame or a passage.
            out[k] = msgspec.structs.replace(
                united(out[k], door), center=out[k].center, confidence=out[k].confidence
            )
    return tuple(out)
