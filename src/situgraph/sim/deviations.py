"""The building as built differs from the plan: moved walls, missing doors, extra furniture.

A deviation changes a scene graph into another one with the same ids; the driven world is built
from the changed graph, so it is consistent, and each change is recorded.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any, Literal

import msgspec
import numpy as np

from situgraph.geometry.poses import Array
from situgraph.scenegraph.graph import Object, Plane, Room, SceneGraph
from situgraph.sim.clutter import extra_furniture, in_doorways
from situgraph.sim.config import WorldConfig

_BACK = 0.6  # m; two faces back to back within this are one wall
_OVERLAP = 0.2  # m; of their common stretch at least
_EDGE = 0.6  # m; no footprint edge gets shorter than this, no room less wide


class Deviation(msgspec.Struct, frozen=True):
    """One difference between plan and building.

    ``moved-wall``: each of its ``ids`` (planes) lies ``offsets`` m from the plan, positive along
    the planned inward normal. ``missing-door``, ``extra-furniture`` and ``left-out`` (a thing that
    would have blocked a door): the object's id.
    """

    kind: Literal["moved-wall", "missing-door", "extra-furniture", "left-out"]
    ids: tuple[str, ...]
    offsets: tuple[float, ...] = ()


def deviate(
    plan: SceneGraph, config: WorldConfig, rng: np.random.Generator
) -> tuple[SceneGraph, tuple[Deviation, ...]]:
    """The graph of the building as built and its deviations, as many as ``config`` asks for.

    What the plan puts in the way of a door is always left out: a robot has to drive.
    Fewer changes are made where the plan offers no more: walls whose move would break a room stay,
    and so do doors without which a room would be cut off.
    """
    built = plan
    done: list[Deviation] = []
    for name in in_doorways(plan):
        built = without(built, name)
        done.append(Deviation("left-out", (name,)))
    groups = _walls(plan) if config.moved_walls else []
    for index in rng.permutation(len(groups)):
        if sum(d.kind == "moved-wall" for d in done) == config.moved_walls:
            break
        by = config.moved_by * (1.0 if rng.random() < 0.5 else -1.0)
        changed = move_wall(built, groups[index], by) or move_wall(built, groups[index], -by)
        if changed is not None:
            built, deviation = changed
            done.append(deviation)
    for _ in range(config.missing_doors):
        if not (free := _spare_doors(built)):
            break
        name = free[rng.integers(len(free))]
        built = without(built, name)
        done.append(Deviation("missing-door", (name,)))
    for item in extra_furniture(built, config.extra_furniture, rng):
        built = built.replace(objects=(*built.objects, item))
        done.append(Deviation("extra-furniture", (item.id,)))
    return built, tuple(done)


def _spare_doors(plan: SceneGraph) -> list[str]:
    """Inner doors that can go: those that are no bridge of the graph of rooms and doors."""
    import networkx as nx

    doors = [o for o in plan.objects if o.category == "door" and len(o.rooms) > 1]
    pairs = [frozenset(d.rooms[:2]) for d in doors]
    graph: Any = nx.Graph()
    graph.add_edges_from(tuple(p) for p in pairs if len(p) == 2)
    bridges = {frozenset(b) for b in nx.bridges(graph)}
    return [d.id for d, p in zip(doors, pairs) if p not in bridges or pairs.count(p) > 1]


def without(plan: SceneGraph, name: str) -> SceneGraph:
    """The plan without the object of that id."""
    return plan.replace(objects=tuple(o for o in plan.objects if o.id != name))


def move_wall(
    plan: SceneGraph, wall: Collection[str], by: float
) -> tuple[SceneGraph, Deviation] | None:
    """Move all faces of one wall by ``by`` m along the normal of its first; None if a room breaks.

    What stands on the wall (doors, windows, ...) moves along.
    """
    import shapely

    ids = sorted(wall)
    direction = np.asarray(plan.plane_by_id[ids[0]].normal[:2])
    direction = direction / np.linalg.norm(direction)
    shift = np.array([*(direction * by), 0.0])
    rooms = []
    for room in plan.rooms:
        moved = _moved_room(room, plan, [p for p in room.planes if p in wall], shift[:2])
        if moved is None:
            return None
        rooms.append(moved)
    shapes = [shapely.Polygon(r.footprint) for r in rooms if r.footprint]
    before = [shapely.Polygon(r.footprint) for r in plan.rooms if r.footprint]
    if _overlap(shapes) > _overlap(before) + 1e-3:
        return None
    offsets = {p: float(np.dot(plan.plane_by_id[p].normal, shift)) for p in ids}
    objects = tuple(
        _moved_object(o, shift) if set(o.planes) & set(wall) else o for o in plan.objects
    )
    built = plan.replace(
        rooms=tuple(rooms), planes=_moved_planes(plan, rooms, offsets, shift[:2]), objects=objects
    )
    return built, Deviation("moved-wall", tuple(ids), tuple(offsets[p] for p in ids))


def _walls(plan: SceneGraph) -> list[frozenset[str]]:
    """The inner walls: faces of one storey that are connected by standing back to back."""
    import networkx as nx

    storey = {p: r.storey for r in plan.rooms for p in r.planes}
    faces = [p for p in plan.planes if p.extent and not p.virtual and p.id in storey]
    graph: Any = nx.Graph()
    for i, a in enumerate(faces):
        for b in faces[i + 1 :]:
            if storey[a.id] == storey[b.id] and _back_to_back(a, b):
                graph.add_edge(a.id, b.id)
    return sorted((frozenset(c) for c in nx.connected_components(graph)), key=sorted)


def _back_to_back(a: Plane, b: Plane) -> bool:
    na, nb = np.asarray(a.normal[:2]), np.asarray(b.normal[:2])
    if na @ nb > -0.98:
        return False
    pa, pb = np.asarray(a.extent), np.asarray(b.extent)
    gap = -(pb @ na + a.offset)
    if not (gap.min() > -0.02 and gap.max() < _BACK):
        return False
    along = np.array([-na[1], na[0]])
    sa, sb = np.sort(pa @ along), np.sort(pb @ along)
    return bool(min(sa[1], sb[1]) - max(sa[0], sb[0]) > _OVERLAP)


def _moved_room(room: Room, plan: SceneGraph, faces: list[str], shift: Array) -> Room | None:
    """The room with the edges that lie on ``faces`` moved; None when it would break."""
    import shapely

    if not faces or not room.footprint:
        return room
    points = np.asarray(room.footprint, dtype=float)
    on = np.zeros(len(points), dtype=bool)
    for plane in (plan.plane_by_id[p] for p in faces):
        away = np.abs(points @ np.asarray(plane.normal[:2]) + plane.offset)
        edge = (away < 0.02) & (np.roll(away, -1) < 0.02)
        on |= edge | np.roll(edge, 1)
    moved = points + np.where(on[:, None], shift, 0.0)
    polygon = shapely.Polygon(moved)
    lengths = np.linalg.norm(np.roll(moved, -1, axis=0) - moved, axis=1)
    before = np.linalg.norm(np.roll(points, -1, axis=0) - points, axis=1)
    shorter = (lengths < before - 1e-6) & (lengths < _EDGE)
    if not polygon.is_valid or shorter.any() or polygon.buffer(-_EDGE).is_empty:
        return None
    center = np.asarray(polygon.centroid.coords[0]) - shapely.Polygon(points).centroid.coords[0]
    x, y, z = room.center
    return msgspec.structs.replace(
        room,
        center=(x + float(center[0]), y + float(center[1]), z),
        footprint=tuple((float(a), float(b)) for a, b in moved),
    )


def _overlap(shapes: list[Any]) -> float:
    import shapely

    return float(sum(s.area for s in shapes) - shapely.union_all(shapes).area)


def _moved_planes(
    plan: SceneGraph, rooms: list[Room], offsets: Mapping[str, float], shift: Array
) -> tuple[Plane, ...]:
    """Moved faces keep their direction; the extents of all faces follow their rooms' corners."""
    corner: dict[tuple[float, float], tuple[float, float]] = {}
    for old, new in zip(plan.rooms, rooms):
        for a, b in zip(old.footprint or (), new.footprint or ()):
            corner[_key(a)] = b
    planes = []
    for plane in plan.planes:
        extent = plane.extent
        if extent is not None:
            own = shift if plane.id in offsets else np.zeros(2)
            ends = [
                corner.get(_key(e), (e[0] + float(own[0]), e[1] + float(own[1]))) for e in extent
            ]
            extent = (ends[0], ends[1])
        offset = plane.offset - offsets.get(plane.id, 0.0)
        planes.append(msgspec.structs.replace(plane, offset=offset, extent=extent))
    return tuple(planes)


def _key(point: tuple[float, float]) -> tuple[float, float]:
    return (round(point[0], 3), round(point[1], 3))


def _moved_object(item: Object, shift: Array) -> Object:
    x, y, z = (float(v) for v in np.asarray(item.center) + shift)
    return msgspec.structs.replace(item, center=(x, y, z))
