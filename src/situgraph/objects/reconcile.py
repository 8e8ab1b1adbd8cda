"""One door, several kinds of evidence: seen by the camera, crossed by the robot, a gap in a wall.

Doorways and visually detected doors that share a wall face and a place are one object of category
``door``; its attribute ``evidence`` lists what it stands on. The place of a passage lies on the
wall by construction; that of an image also holds the leaf, which may stand open.
"""

from __future__ import annotations

from collections.abc import Sequence

import msgspec
import numpy as np

from situgraph.geometry.poses import Array
from situgraph.objects.config import ObjectsConfig
from situgraph.objects.doorways import EVIDENCE
from situgraph.scenegraph.graph import Object, SceneGraph

LEAF = 1.25  # m; a face that was seen over no more may be an open leaf
HINGE = 0.3  # m; from the end of a door to that of its leaf
ASKEW = 0.94  # cosine; a leaf that is open by less than 20 degrees is the door itself
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


def without_leaves(objects: Sequence[Object], graph: SceneGraph) -> tuple[Object, ...]:
    """The objects without the doors that are open leaves which SLAM took for a piece of wall.

    Such a leaf is a door in a face hardly longer than itself; it stands askew to the wall of
    another door and begins where that one ends. What the robot passed is no leaf.
    """
    doors = [o for o in objects if o.category == "door" and o.planes and o.ellipsoid is not None]
    leaves = {o.id for o in doors if any(_hung(o, d, graph) for d in doors if d is not o)}
    return tuple(o for o in objects if o.id not in leaves)


def _hung(leaf: Object, door: Object, graph: SceneGraph) -> bool:
    plane = graph.plane_by_id[leaf.planes[0]]
    if plane.extent is None or "trajectory" in str(leaf.attributes.get(EVIDENCE)):
        return False
    length = float(np.linalg.norm(np.subtract(*plane.extent)))
    facing = np.array(plane.normal[:2]) @ graph.plane_by_id[door.planes[0]].normal[:2]
    other = graph.plane_by_id[door.planes[0]].extent
    longer = other is None or float(np.linalg.norm(np.subtract(*other))) > length
    if length > LEAF or not longer or abs(float(facing)) > ASKEW:
        return False
    apart = _ends(leaf, graph)[:, None] - _ends(door, graph)[None]
    return bool(np.linalg.norm(apart, axis=2).min() <= HINGE)


def _ends(door: Object, graph: SceneGraph) -> Array:
    """The two ends (2, 2) of a door in the plan."""
    assert door.ellipsoid is not None
    normal = graph.plane_by_id[door.planes[0]].normal
    half = door.ellipsoid.axes[0] * np.array([-normal[1], normal[0]])
    return np.array([door.center[:2] - half, door.center[:2] + half])


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


def backed(
    weak: Sequence[Object],
    sure: Sequence[Object],
    passages: Sequence[Object],
    graph: SceneGraph,
    config: ObjectsConfig,
) -> list[Object]:
    """Of the doors that the camera saw too seldom those that the robot passed.

    A passage is through one door: a sure one in reach of it, else the nearest of the others.
    """
    found: set[str] = set()
    for passage in passages:
        if any(_reached(o, passage, graph, config) for o in sure):
            continue
        near = [
            (along_wall(o, passage, graph), o.id)
            for o in weak
            if _reached(o, passage, graph, config)
        ]
        found.update(key for _, key in sorted(near)[:1])
    return [o for o in weak if o.id in found]


def _reached(door: Object, passage: Object, graph: SceneGraph, config: ObjectsConfig) -> bool:
    """Whether a passage may be through it."""
    return door.category == "door" and along_wall(door, passage, graph) <= config.doorway_merge


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
