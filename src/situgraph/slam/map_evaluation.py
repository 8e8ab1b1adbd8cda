"""How good walls and rooms of a map are, against the graph of the building as it really is."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any, NamedTuple

import numpy as np

from situgraph.geometry.poses import Array
from situgraph.scenegraph.graph import Room, SceneGraph
from situgraph.slam.evaluation import Errors, statistics

ANGLE = np.radians(10.0)
REACH = 0.5  # m; a wall farther from every true wall has no counterpart
IOU = 0.7  # of footprints; a room below is not that room


class WallErrors(NamedTuple):
    """Of walls that bound rooms: offset (m) and angle (rad) errors, and walls without counterpart.

    ``pairs`` names (estimated, true, signed offset error) each.
    """

    offset: Errors
    angle: Errors
    unmatched: int
    pairs: tuple[tuple[str, str, float], ...]


class RoomScores(NamedTuple):
    """Shares of rooms found that are right and of visited rooms that were found.

    ``iou`` is that of each room found with its best true one; the ``strict`` figures count rooms
    that no wall parts one by one.
    """

    precision: float
    recall: float
    strict_precision: float
    strict_recall: float
    iou: tuple[float, ...]


def wall_errors(estimate: SceneGraph, truth: SceneGraph) -> WallErrors:
    """Compare the planes of rooms with the true ones; both graphs in one frame.

    Each estimated plane is compared with the nearest true one of its direction beside it, at the
    middle of what was seen of it.
    """
    true = [p for p in truth.planes if p.extent is not None]
    normals = np.array([p.normal[:2] for p in true], dtype=float).reshape(-1, 2)
    length = np.linalg.norm(normals, axis=1)
    normals = normals / length[:, None]
    offsets = np.array([p.offset for p in true]) / length
    ends = np.array([p.extent for p in true], dtype=float).reshape(-1, 2, 2)
    bounding = {p for r in estimate.rooms for p in r.planes}
    shifts, turns, pairs = [], [], []
    unmatched = 0
    for plane in estimate.planes:
        if plane.id not in bounding or plane.extent is None:
            continue
        n = np.array(plane.normal[:2]) / np.hypot(*plane.normal[:2])
        middle = np.array(plane.extent, dtype=float).mean(axis=0)
        cosine = normals @ n
        across = normals @ middle + offsets
        tangent = np.stack([-normals[:, 1], normals[:, 0]], axis=1)
        along = np.einsum("ijk,ik->ij", ends - middle, tangent)
        beside = (along.min(axis=1) < 0.3) & (along.max(axis=1) > -0.3)
        cost = np.where(
            (cosine > np.cos(ANGLE)) & beside & (np.abs(across) < REACH), np.abs(across), np.inf
        )
        best = int(np.argmin(cost)) if len(cost) else -1
        if best < 0 or not np.isfinite(cost[best]):
            unmatched += 1
            continue
        shifts.append(abs(float(across[best])))
        turns.append(float(np.arccos(min(float(cosine[best]), 1.0))))
        pairs.append((plane.id, true[best].id, float(across[best])))
    return WallErrors(statistics(shifts), statistics(turns), unmatched, tuple(pairs))


def room_scores(
    estimate: SceneGraph, truth: SceneGraph, visited: Collection[str], least_iou: float = IOU
) -> RoomScores:
    """Compare footprints; both graphs in one frame.

    True rooms with no wall between them (a ``virtual`` face) are one space for a LiDAR: an
    estimated room is right when it is one true room or a whole such space, and a true room is
    found when it or its space is. ``strict`` figures do without that.
    """
    shapes = {r.id: _shape(r) for r in truth.rooms if r.footprint}
    spaces = _spaces(truth, shapes)
    storeys = {r.id: r.storey for r in truth.rooms}
    levels = {s.id: s.elevation for s in truth.storeys}
    own_levels = {s.id: s.elevation for s in estimate.storeys}
    best_iou, right, strict_right = [], 0, 0
    found: set[str] = set()
    strictly: set[str] = set()
    for room in estimate.rooms:
        if not room.footprint:
            continue
        shape = _shape(room)
        here = [
            key
            for key in shapes
            if _same_level(levels.get(storeys[key] or ""), own_levels.get(room.storey or ""))
        ]
        single = max(((_iou(shape, shapes[k]), k) for k in here), default=(0.0, ""))
        joint = max(
            ((_iou(shape, area), names) for names, area in spaces if names[0] in here),
            default=(0.0, ("",)),
        )
        best_iou.append(max(single[0], joint[0]))
        if single[0] >= least_iou:
            strict_right += 1
            strictly.add(single[1])
            found.add(single[1])
        if joint[0] >= least_iou:
            found |= set(joint[1])
        right += best_iou[-1] >= least_iou
    wanted = [v for v in visited if v in shapes]
    count = len(best_iou)
    return RoomScores(
        right / count if count else 0.0,
        sum(v in found for v in wanted) / max(len(wanted), 1),
        strict_right / count if count else 0.0,
        sum(v in strictly for v in wanted) / max(len(wanted), 1),
        tuple(best_iou),
    )


def _shape(room: Room) -> Any:
    import shapely

    return shapely.Polygon(room.footprint).buffer(0)


def _iou(a: Any, b: Any) -> float:
    joint = a.intersection(b).area
    return float(joint / max(a.area + b.area - joint, 1e-9))


def _same_level(a: float | None, b: float | None) -> bool:
    return a is None or b is None or abs(a - b) < 1.0


def _spaces(truth: SceneGraph, shapes: Mapping[str, Any]) -> list[tuple[tuple[str, ...], Any]]:
    """Groups of rooms that no wall parts, with their joint area (gaps of a wall's depth closed)."""
    import shapely

    parent = {k: k for k in shapes}

    def root(key: str) -> str:
        while parent[key] != key:
            key = parent[key]
        return key

    storeys = {r.id: r.storey for r in truth.rooms}
    for room in truth.rooms:
        if room.id not in shapes:
            continue
        for name in room.planes:
            plane = truth.plane_by_id[name]
            if not plane.virtual or plane.extent is None:
                continue
            for other in shapes:
                if other != room.id and storeys[other] == storeys[room.id]:
                    beyond = _beyond(np.array(plane.extent), np.array(plane.normal[:2]))
                    inside = shapely.contains_xy(shapes[other], beyond)
                    if inside.sum() * 0.1 >= 0.5:
                        parent[root(other)] = root(room.id)
    groups: dict[str, list[str]] = {}
    for key in shapes:
        groups.setdefault(root(key), []).append(key)
    out = []
    for names in groups.values():
        if len(names) > 1:
            area = shapely.unary_union([shapes[n].buffer(0.2) for n in names]).buffer(-0.2)
            out.append((tuple(names), area))
    return out


def _beyond(extent: Array, normal: Array) -> Array:
    """Points every 0.1 m along a face, 0.35 m behind it."""
    a, b = extent
    steps = max(int(np.linalg.norm(b - a) / 0.1), 1)
    share = (np.arange(steps) + 0.5)[:, None] / steps
    out: Array = a + share * (b - a) - 0.35 * normal / np.linalg.norm(normal)
    return out
