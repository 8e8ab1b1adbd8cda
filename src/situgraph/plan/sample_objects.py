"""The objects a robot has seen, with the errors of its detector."""

from __future__ import annotations

import math
from collections.abc import Mapping

import msgspec
import numpy as np

from situgraph.geometry.poses import Array
from situgraph.plan.contacts import Index
from situgraph.plan.exploration import Walk
from situgraph.plan.sample_draft import Draft, DraftObject, triples
from situgraph.plan.sample_motion import RoomMotions
from situgraph.plan.sample_prior import RATES, PriorArrays
from situgraph.plan.sample_walls import SeenPlanes
from situgraph.plan.sampler_config import SamplerConfig
from situgraph.scenegraph.graph import Ellipsoid, Vec3, Vec4

Rng = np.random.Generator

# A second instance of an object stands this far (m) from the first.
DUPLICATE_DISTANCE = (0.2, 0.5)
MISSED, FALSE, DUPLICATED, CONFUSED, WRONG_WALL = range(len(RATES))


def add_objects(
    draft: Draft,
    seen: SeenPlanes,
    index: Mapping[int, int],
    prior: PriorArrays,
    motions: RoomMotions,
    walk: Walk,
    down: float,
    config: SamplerConfig,
    rng: Rng,
) -> None:
    """Add what is seen from the explored rooms; relations lead to explored rooms only."""
    slot_of = {room: slot for slot, room in enumerate(walk.order)}
    first: dict[int, int] = {}
    for slot, room in enumerate(walk.order):
        for row in prior.objects[room]:
            first.setdefault(row, slot)
    if not first:
        return
    rows, slots = np.array(list(first)), np.array(list(first.values()))
    center = _centers(rows, slots, seen, prior, motions)
    center[:, 2] -= down
    center += config.object_sigma * rng.normal(size=center.shape)
    rates = prior.rates[rows]
    error = rng.random((len(rows), len(RATES))) < rates
    objects, planes = prior.graph.objects, draft.planes
    for i, (row, at) in enumerate(zip(rows.tolist(), triples(center), strict=True)):
        node = objects[row]
        if error[i, MISSED]:
            draft.missed_objects.append(node.id)
            continue
        rooms = [slot_of[r] for r in prior.object_rooms[row] if r in slot_of]
        hosts = [index[p] for p in prior.object_planes[row] if p in index]
        yaw = float(motions.yaw[slots[i]])
        found = DraftObject(node.category, at, _turned(node.ellipsoid, yaw), rooms, hosts, node.id)
        if error[i, CONFUSED]:
            _confuse(found, prior.categories, rng)
        if error[i, WRONG_WALL] and hosts:
            _rehang(found, draft, rng)
        draft.objects.append(found)
        if error[i, DUPLICATED]:
            along = planes[hosts[0]].normal if hosts else None
            again = _beside(at, along, rng)
            draft.objects.append(msgspec.structs.replace(found, center=again, copy=True))
    _add_false(draft, rows, rates[:, FALSE], prior, rng)


def _centers(
    rows: Index, slots: Index, seen: SeenPlanes, prior: PriorArrays, motions: RoomMotions
) -> Array:
    """Centres (k, 3) in the map, heights still the building's; objects go with moved walls."""
    center = np.array(prior.object_center[rows])
    if np.any(seen.moved):
        for i, row in enumerate(rows.tolist()):
            host = next((p for p in prior.object_planes[row] if p in seen.place), None)
            if host is not None:
                center[i, :2] += seen.moved[seen.place[host]] * prior.normal[host, :2]
    center[:, :2] = motions.points(center[:, :2], slots)
    return center


def _turned(ellipsoid: Ellipsoid | None, yaw: float) -> Ellipsoid | None:
    """The ellipsoid after a turn about z."""
    if ellipsoid is None:
        return None
    c, s = math.cos(0.5 * yaw), math.sin(0.5 * yaw)
    x, y, z, w = ellipsoid.rotation
    return Ellipsoid(ellipsoid.axes, (c * x - s * y, s * x + c * y, c * z + s * w, c * w - s * z))


def _confuse(found: DraftObject, categories: tuple[str, ...], rng: Rng) -> None:
    others = [c for c in categories if c != found.category]
    found.category = others[int(rng.integers(len(others)))]
    found.confused = True


def _rehang(found: DraftObject, draft: Draft, rng: Rng) -> None:
    """Relate the object to another wall of one of its rooms instead of its own."""
    room = draft.rooms[found.rooms[0]]
    own = [p for p in found.planes if p in room.planes]
    others = [p for p in room.planes if p not in found.planes]
    if own and others:
        wrong = others[int(rng.integers(len(others)))]
        found.planes = [wrong if p == own[0] else p for p in found.planes]
        found.wrong_wall = True


def _beside(at: Vec3, normal: Vec3 | None, rng: Rng) -> Vec3:
    """A place next to another one: along the wall it hangs on, else in any direction."""
    distance = float(rng.uniform(*DUPLICATE_DISTANCE)) * (1.0 if rng.random() < 0.5 else -1.0)
    if normal is None:
        angle = float(rng.uniform(-math.pi, math.pi))
        ahead = (math.cos(angle), math.sin(angle))
    else:
        flat = math.hypot(normal[0], normal[1])
        ahead = (-normal[1] / flat, normal[0] / flat)
    return at[0] + distance * ahead[0], at[1] + distance * ahead[1], at[2]


def _add_false(draft: Draft, rows: Index, rate: Array, prior: PriorArrays, rng: Rng) -> None:
    """Objects that are not there: each looks like a real one, but in any seen room."""
    for i in np.repeat(np.arange(len(rows)), rng.poisson(rate)).tolist():
        node = prior.graph.objects[int(rows[i])]
        slot = int(rng.integers(len(draft.rooms)))
        room = draft.rooms[slot]
        hosts: list[int] = []
        center, shape = room.center, node.ellipsoid
        if node.planes and room.planes:
            hosts = [room.planes[int(rng.integers(len(room.planes)))]]
            extent = draft.planes[hosts[0]].extent
            if extent is not None:
                u = float(rng.uniform(0.15, 0.85))
                x = (1.0 - u) * extent[0][0] + u * extent[1][0]
                y = (1.0 - u) * extent[0][1] + u * extent[1][1]
                center = (x, y, center[2])
            if shape is not None:
                shape = Ellipsoid(shape.axes, _along(draft.planes[hosts[0]].normal))
        else:
            x, y = rng.uniform(-1.0, 1.0, 2).tolist()
            center = (center[0] + x, center[1] + y, center[2])
        draft.objects.append(DraftObject(node.category, center, shape, [slot], hosts, None))


def _along(normal: Vec3) -> Vec4:
    """The turn about z that lays x along a wall with this normal."""
    half = 0.5 * (math.atan2(normal[1], normal[0]) - 0.5 * math.pi)
    return 0.0, 0.0, math.sin(half), math.cos(half)
