"""A sampled S-Graph while it grows: nodes that know which prior node they come from."""

from __future__ import annotations

import msgspec
import numpy as np

from situgraph.geometry.poses import Array, Placement
from situgraph.plan.exploration import Walk
from situgraph.plan.sample_motion import RoomMotions
from situgraph.plan.sample_truth import MovedPlane, OnlineSample, SampleTruth
from situgraph.scenegraph.graph import (
    Ellipsoid,
    Object,
    Plane,
    Room,
    SceneGraph,
    Storey,
    Vec2,
    Vec3,
)


class DraftRoom(msgspec.Struct):
    """A room in map coordinates; ``planes`` are indices of the draft's planes."""

    center: Vec3
    planes: list[int]
    footprint: tuple[Vec2, ...] | None
    storey: str | None
    prior: str | None


class DraftPlane(msgspec.Struct):
    """A face in map coordinates; ``prior`` is None for a false one."""

    normal: Vec3
    offset: float
    extent: tuple[Vec2, Vec2] | None
    prior: str | None


class DraftObject(msgspec.Struct):
    """A detected object; ``copy`` marks a second instance of one already there."""

    category: str
    center: Vec3
    ellipsoid: Ellipsoid | None
    rooms: list[int]
    planes: list[int]
    prior: str | None
    copy: bool = False
    confused: bool = False
    wrong_wall: bool = False


class Draft(msgspec.Struct):
    """Everything of a sample, with indices in place of ids; true rooms come first, as explored."""

    rooms: list[DraftRoom] = []
    planes: list[DraftPlane] = []
    objects: list[DraftObject] = []
    moved: list[tuple[str, int | None, float]] = []
    missing_planes: list[str] = []
    missed_objects: list[str] = []


def finished(
    draft: Draft,
    prior: SceneGraph,
    walk: Walk,
    motions: RoomMotions,
    frame: Placement,
    placement: Placement,
    rng: np.random.Generator,
) -> OnlineSample:
    """Shuffle the nodes, give them names that say nothing, and write down the truth."""
    room, room_order = _names("r", len(draft.rooms), rng)
    plane, plane_order = _names("p", len(draft.planes), rng)
    item, item_order = _names("o", len(draft.objects), rng)
    seen = {r.storey for r in draft.rooms}
    levels = [s for s in prior.storeys if s.id in seen]
    level, level_order = _names("s", len(levels), rng)
    storey = {s.id: level[i] for i, s in enumerate(levels)}
    online = SceneGraph(
        kind="online",
        storeys=tuple(
            Storey(level[i], None, levels[i].elevation - frame.z, levels[i].height)
            for i in level_order
        ),
        rooms=tuple(_room(room[i], draft.rooms[i], plane, storey) for i in room_order),
        planes=tuple(
            Plane(plane[i], draft.planes[i].normal, draft.planes[i].offset, draft.planes[i].extent)
            for i in plane_order
        ),
        objects=tuple(_object(item[i], draft.objects[i], room, plane) for i in item_order),
    )
    things = list(zip(item, draft.objects, strict=True))
    own = motions.placements(frame.z)
    real = [i for i, r in enumerate(draft.rooms) if r.prior is not None]
    truth = SampleTruth(
        placement=placement,
        start=frame,
        room_placements={room[i]: own[i] for i in real},
        storeys={online_id: prior_id for prior_id, online_id in storey.items()},
        rooms={room[i]: r.prior for i, r in enumerate(draft.rooms) if r.prior is not None},
        planes={plane[i]: p.prior for i, p in enumerate(draft.planes) if p.prior is not None},
        objects={n: o.prior for n, o in things if o.prior is not None and not o.copy},
        duplicates={n: o.prior for n, o in things if o.prior is not None and o.copy},
        confused=tuple(n for n, o in things if o.confused),
        wrong_wall=tuple(n for n, o in things if o.wrong_wall),
        moved=tuple(
            MovedPlane(p, None if i is None else plane[i], offset) for p, i, offset in draft.moved
        ),
        missing_planes=tuple(draft.missing_planes),
        missed_objects=tuple(draft.missed_objects),
        false_rooms=tuple(room[i] for i, r in enumerate(draft.rooms) if r.prior is None),
        false_planes=tuple(plane[i] for i, p in enumerate(draft.planes) if p.prior is None),
        false_objects=tuple(n for n, o in things if o.prior is None),
        order=tuple(room[i] for i in real),
        walked=tuple(motions.walked.tolist()),
        contiguous=walk.contiguous,
    )
    return OnlineSample(online, truth)


def _names(letter: str, count: int, rng: np.random.Generator) -> tuple[list[str], list[int]]:
    """A name for each of ``count`` nodes, and the order in which to list them: that of names."""
    number = rng.permutation(count)
    return [f"{letter}{i}" for i in number.tolist()], np.argsort(number).tolist()


def _room(name: str, room: DraftRoom, plane: list[str], storey: dict[str, str]) -> Room:
    return Room(
        name,
        room.center,
        tuple(plane[p] for p in room.planes),
        None if room.storey is None else storey[room.storey],
        None,
        room.footprint,
    )


def _object(name: str, item: DraftObject, room: list[str], plane: list[str]) -> Object:
    return Object(
        name,
        item.category,
        item.center,
        item.ellipsoid,
        tuple(room[r] for r in item.rooms),
        tuple(plane[p] for p in item.planes),
    )


def triples(points: Array) -> list[Vec3]:
    """Rows (n, 3) as tuples of floats."""
    return [(x, y, z) for x, y, z in points.tolist()]
