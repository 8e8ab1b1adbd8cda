"""One door, several kinds of evidence: seen by the camera, crossed by the robot, a gap in a wall.

Doorways and visually detected doors that share a wall face and a place are one object of category
``door``; its attribute ``evidence`` lists what it stands on. The place of a passage lies on the
wall by construction; that of an image also holds the leaf, which may stand open.
"""

from __future__ import annotations

from collections.abc import Sequence

import msgspec
import numpy as np

from situgraph.objects.config import ObjectsConfig
from situgraph.objects.doorways import EVIDENCE
from situgraph.scenegraph.graph import Object, SceneGraph

ACROSS = 0.5  # cosine; walls that meet at more than 60 degrees


def reconciled(
    seen: Sequence[Object], passages: Sequence[Object], graph: SceneGraph, config: ObjectsConfig
) -> tuple[Object, ...]:
    """Objects with each passage united with the door it belongs to, else added as its own door.

    All objects must carry their relations already. Each passage takes the nearest door that shares
    one of its faces within ``config.doorway_merge`` along the wall; else a door on a face across
    that is no farther than an open leaf would be, which it then is.
    """
    doors = [k for k, o in enumerate(seen) if o.category == "door"]
    out = list(seen)
    added = []
    for passage in passages:
        near = [
            (apart, k)
            for k in doors
            if (apart := along_wall(out[k], passage, graph)) <= config.doorway_merge
        ]
        if near:
            _, k = min(near)
            out[k] = united(out[k], passage)
            continue
        leaves = [
            (apart, k)
            for k in doors
            if (apart := _as_leaf(out[k], passage, graph)) <= config.doorway_width
        ]
        if leaves:
            _, k = min(leaves)
            bare = msgspec.structs.replace(out[k], rooms=(), planes=())
            out[k] = united(bare, passage)
        else:
            added.append(passage)
    return (*out, *added)


def united(door: Object, passage: Object) -> Object:
    """The door with the passage's place in the plan, both relations and both kinds of evidence."""
    kinds = [str(o.attributes.get(EVIDENCE, "")) for o in (door, passage)]
    evidence = ",".join(dict.fromkeys(k for kind in kinds for k in kind.split(",") if k))
    return msgspec.structs.replace(
        door,
        center=(passage.center[0], passage.center[1], door.center[2]),
        rooms=tuple(dict.fromkeys((*door.rooms, *passage.rooms))),
        planes=tuple(dict.fromkeys((*door.planes, *passage.planes))),
        confidence=max(door.confidence or 0.0, passage.confidence or 1.0),
        attributes={**door.attributes, EVIDENCE: evidence},
    )


def passed(
    weak: Object, passages: Sequence[Object], graph: SceneGraph, config: ObjectsConfig
) -> bool:
    """Whether the robot passed where a door that the camera saw too seldom should be."""
    return weak.category == "door" and any(
        along_wall(weak, p, graph) <= config.doorway_merge for p in passages
    )


def _as_leaf(door: Object, passage: Object, graph: SceneGraph) -> float:
    """Distance (m) of a door on a wall across from the passage's; infinite for other doors."""
    if not door.planes or not passage.planes or "trajectory" in str(door.attributes.get(EVIDENCE)):
        return float("inf")
    own, other = (np.array(graph.plane_by_id[o.planes[0]].normal[:2]) for o in (door, passage))
    if abs(float(own @ other)) > ACROSS:
        return float("inf")
    return float(np.linalg.norm(np.array(door.center[:2]) - np.array(passage.center[:2])))


def along_wall(door: Object, passage: Object, graph: SceneGraph) -> float:
    """Distance (m) of two doors along a face they share; infinite if they share none."""
    shared = set(door.planes) & set(passage.planes)
    if not shared:
        return float("inf")
    apart = np.array(door.center[:2]) - np.array(passage.center[:2])
    normals = [np.array(graph.plane_by_id[key].normal[:2]) for key in sorted(shared)]
    return min(float(np.linalg.norm(apart - (apart @ n) * n)) for n in normals)
