"""The faces and rooms a robot has seen, with moved, missing and noisy ones."""

from __future__ import annotations

import itertools
import math

import msgspec
import numpy as np
from numpy.typing import NDArray

from situgraph.geometry.poses import Array
from situgraph.plan.contacts import Index
from situgraph.plan.exploration import Walk
from situgraph.plan.sample_draft import Draft, DraftPlane, DraftRoom, triples
from situgraph.plan.sample_motion import RoomMotions
from situgraph.plan.sample_prior import PriorArrays
from situgraph.plan.sampler_config import SamplerConfig
from situgraph.scenegraph.graph import Vec2

Rng = np.random.Generator


class SeenPlanes(msgspec.Struct, frozen=True):
    """Faces of the explored rooms, each once, seen from the room that was entered first.

    ``row`` (k,) of the prior, ``slot`` (k,) in the walk's order, ``moved`` (k,) metres along the
    planned inward normal, ``kept`` (k,) whether the face is in the S-Graph. ``place`` finds a
    row's index among them.
    """

    row: Index
    slot: Index
    moved: Array
    kept: NDArray[np.bool_]
    place: dict[int, int]


def see_planes(walk: Walk, prior: PriorArrays, config: SamplerConfig, rng: Rng) -> SeenPlanes:
    """Choose which faces are seen, which walls stand elsewhere and which faces go missing."""
    place: dict[int, int] = {}
    slots: list[int] = []
    for slot, room in enumerate(walk.order):
        for p in prior.planes[room]:
            if p not in place:
                place[p] = len(place)
                slots.append(slot)
    rows = np.array(list(place), dtype=np.int64)
    slot_of = np.array(slots, dtype=np.int64)
    moved = _moved(rows, slot_of, walk, prior, place, config, rng)
    kept = rng.random(len(rows)) >= config.missing_planes
    if config.missing_planes > 0.0:
        _keep_a_corner(kept, walk, prior, place, rng)
    return SeenPlanes(rows, slot_of, moved, kept, place)


def add_planes(
    draft: Draft,
    seen: SeenPlanes,
    prior: PriorArrays,
    motions: RoomMotions,
    walk: Walk,
    down: float,
    config: SamplerConfig,
    rng: Rng,
) -> dict[int, int]:
    """Add the kept faces in map coordinates; gives the draft's index of each prior row.

    Noise turns a face about the middle of what is seen of it; ``down`` (m) is what map heights
    lack against the building's.
    """
    k = len(seen.row)
    noise = rng.normal(size=(5, k))
    planned = prior.normal[seen.row]
    anchor = prior.anchor[seen.row] + seen.moved[:, None] * planned[:, :2]
    at = motions.points(anchor, seen.slot)
    flat = motions.vectors(planned[:, :2], seen.slot)
    at = at + config.plane_offset_sigma * noise[0][:, None] * flat
    height = prior.center[np.array(walk.order)[seen.slot], 2] - down
    normal = _tilted(flat, planned[:, 2], config.plane_yaw_sigma * noise[1],
                     config.plane_tilt_sigma * noise[2])  # fmt: skip
    offset = -(normal[:, 0] * at[:, 0] + normal[:, 1] * at[:, 1] + normal[:, 2] * height)
    extent = _extents(seen, prior, motions, normal, offset, height, config.extent_sigma * noise[3:])

    index: dict[int, int] = {}
    planes = prior.graph.planes
    normals, offsets = triples(normal), offset.tolist()
    for i in np.flatnonzero(seen.kept).tolist():
        row = int(seen.row[i])
        index[row] = len(draft.planes)
        draft.planes.append(DraftPlane(normals[i], offsets[i], extent[i], planes[row].id))
    draft.missing_planes += [planes[row].id for row in seen.row[~seen.kept].tolist()]
    for i in np.flatnonzero(seen.moved).tolist():
        row = int(seen.row[i])
        draft.moved.append((planes[row].id, index.get(row), float(seen.moved[i])))
    return index


def add_rooms(
    draft: Draft,
    seen: SeenPlanes,
    index: dict[int, int],
    prior: PriorArrays,
    motions: RoomMotions,
    walk: Walk,
    down: float,
    config: SamplerConfig,
    rng: Rng,
) -> None:
    """Add the explored rooms; a moved wall takes the centre half its way along."""
    order = np.array(walk.order)
    slot = np.arange(len(order))
    center = prior.center[order].copy()
    shifted = np.flatnonzero(seen.moved).tolist()
    for i in shifted:
        center[seen.slot[i], :2] += 0.5 * seen.moved[i] * prior.normal[seen.row[i], :2]
    center[:, :2] = motions.points(center[:, :2], slot)
    center[:, 2] -= down
    center += config.center_sigma * rng.normal(size=center.shape)
    footprints = _footprints(walk, seen, prior, motions, config, rng)
    for i, (room, at) in enumerate(zip(walk.order, triples(center), strict=True)):
        planes = [index[p] for p in prior.planes[room] if p in index]
        node = prior.graph.rooms[room]
        draft.rooms.append(DraftRoom(at, planes, footprints.get(i), node.storey, node.id))


def _footprints(
    walk: Walk,
    seen: SeenPlanes,
    prior: PriorArrays,
    motions: RoomMotions,
    config: SamplerConfig,
    rng: Rng,
) -> dict[int, tuple[Vec2, ...]]:
    """Outlines in the map by place in the walk, for the rooms whose prior has one."""
    outlines = {i: prior.footprint[room] for i, room in enumerate(walk.order)}
    known = {i: o for i, o in outlines.items() if o is not None and config.footprints}
    if not known:
        return {}
    for i in set(seen.slot[np.flatnonzero(seen.moved)].tolist()) & known.keys():
        known[i] = _moved_outline(known[i], walk.order[i], seen, prior)
    sizes = [len(o) for o in known.values()]
    drawn = motions.points(np.concatenate(list(known.values())), np.repeat(list(known), sizes))
    drawn = drawn + config.plane_offset_sigma * rng.normal(size=drawn.shape)
    corners = iter([(x, y) for x, y in drawn.tolist()])
    return {i: tuple(itertools.islice(corners, size)) for i, size in zip(known, sizes)}


def _moved(
    rows: Index,
    slots: Index,
    walk: Walk,
    prior: PriorArrays,
    place: dict[int, int],
    config: SamplerConfig,
    rng: Rng,
) -> Array:
    """Offsets (k,): a wall moves as one, so the faces on its two sides go opposite ways."""
    moved = np.zeros(len(rows))
    if config.moved_walls == 0.0:
        return moved
    chosen = rng.random(len(rows)) < config.moved_walls
    size = rng.uniform(config.moved_min, config.moved_max, len(rows))
    offset = np.where(rng.random(len(rows)) < 0.5, size, -size)
    decided = np.zeros(len(rows), dtype=bool)
    for i, row in enumerate(rows.tolist()):
        if decided[i]:
            continue
        decided[i] = True
        others = [place[q] for q in prior.back.get(row, ()) if q in place]
        others = [j for j in others if not decided[j]]
        decided[others] = True
        if chosen[i]:
            moved[i] = offset[i]
            moved[others] = -offset[i]
    # A wall does not move across a shaft that is hardly wider than the offset.
    center = prior.center[np.array(walk.order)[slots]]
    depth = np.einsum("ij,ij->i", prior.normal[rows], center) + prior.offset[rows]
    return np.where(np.abs(moved) < 0.5 * np.abs(depth), moved, 0.0)


def _keep_a_corner(
    kept: NDArray[np.bool_], walk: Walk, prior: PriorArrays, place: dict[int, int], rng: Rng
) -> None:
    """Leave each room two faces that are not parallel, where it has them: else it is no room."""
    for room in walk.order:
        here = prior.planes[room]
        normal = prior.normal[here]
        cross = np.abs(np.outer(normal[:, 0], normal[:, 1]) - np.outer(normal[:, 1], normal[:, 0]))
        on = np.array([kept[place[p]] for p in here], dtype=bool)
        if cross[np.ix_(on, on)].max(initial=0.0) > 0.5 or cross.max(initial=0.0) <= 0.5:
            continue
        for a in rng.permutation(len(here)).tolist():
            b = int(np.argmax(cross[a]))
            if cross[a, b] > 0.5:
                kept[place[here[a]]] = kept[place[here[b]]] = True
                break


def _tilted(flat: Array, rise: Array, yaw: Array, tilt: Array) -> Array:
    """Unit normals (k, 3) from plan directions (k, 2) and z components, after small turns."""
    c, s = np.cos(yaw), np.sin(yaw)
    x, y = c * flat[:, 0] - s * flat[:, 1], s * flat[:, 0] + c * flat[:, 1]
    normal = np.stack([x, y, rise + np.tan(tilt)], axis=1)
    return np.asarray(normal / np.linalg.norm(normal, axis=1, keepdims=True))


def _extents(
    seen: SeenPlanes,
    prior: PriorArrays,
    motions: RoomMotions,
    normal: Array,
    offset: Array,
    height: Array,
    along: Array,
) -> list[tuple[tuple[float, float], tuple[float, float]] | None]:
    """Ends of the faces on the planes as seen, each moved along the wall by noise (2, k)."""
    flat = normal[:, :2]
    length2 = np.einsum("ij,ij->i", flat, flat)
    wall = np.stack([-flat[:, 1], flat[:, 0]], axis=1)
    ends = []
    for side in range(2):
        point = motions.points(prior.extent[seen.row, side], seen.slot)
        away = np.einsum("ij,ij->i", flat, point) + normal[:, 2] * height + offset
        point = point - (away / length2)[:, None] * flat + along[side][:, None] * wall
        ends.append(point.tolist())
    return [
        None if math.isnan(a[0]) else ((a[0], a[1]), (b[0], b[1]))
        for a, b in zip(ends[0], ends[1], strict=True)
    ]


def _moved_outline(outline: Array, room: int, seen: SeenPlanes, prior: PriorArrays) -> Array:
    """The footprint with its moved walls: corners go with the faces that meet in them."""
    corner = outline.copy()
    for p in prior.planes[room]:
        offset = seen.moved[seen.place[p]]
        if offset != 0.0:
            normal = prior.normal[p, :2]
            on = np.abs(outline @ normal + prior.offset[p]) < 1e-3
            corner[on] += offset * normal
    return corner
