"""A sample as it was earlier: after its first few rooms."""

from __future__ import annotations

from collections.abc import Iterable

import msgspec
import numpy as np

from situgraph.geometry.poses import best_placement
from situgraph.plan.sample_truth import OnlineSample, SampleTruth
from situgraph.scenegraph.graph import SceneGraph


def first_rooms(sample: OnlineSample, prior: SceneGraph, rooms: int) -> OnlineSample:
    """What the robot of ``sample`` had after the first ``rooms`` rooms of its walk.

    Ids, frame and noise stay, so that samples of growing size tell one story. Of the false rooms
    a share that goes with the rooms is kept. ``truth.placement`` is fitted anew where the map
    bends. ``prior`` is the graph that was sampled.
    """
    truth, online = sample.truth, sample.online
    order = truth.order[:rooms]
    share = len(order) / max(1, len(truth.order))
    false_rooms = truth.false_rooms[: round(share * len(truth.false_rooms))]
    kept = {*order, *false_rooms}
    room_nodes = tuple(r for r in online.rooms if r.id in kept)
    planes = {p for r in room_nodes for p in r.planes}
    objects = tuple(
        msgspec.structs.replace(
            o,
            rooms=tuple(r for r in o.rooms if r in kept),
            planes=tuple(p for p in o.planes if p in planes),
        )
        for o in online.objects
        if kept & set(o.rooms)
    )
    levels = {r.storey for r in room_nodes}
    graph = online.replace(
        storeys=tuple(s for s in online.storeys if s.id in levels),
        rooms=room_nodes,
        planes=tuple(p for p in online.planes if p.id in planes),
        objects=objects,
    )
    return OnlineSample(graph, _earlier(truth, graph, prior, order, false_rooms))


def _earlier(
    truth: SampleTruth,
    graph: SceneGraph,
    prior: SceneGraph,
    order: tuple[str, ...],
    false_rooms: tuple[str, ...],
) -> SampleTruth:
    seen = {truth.rooms[r] for r in order}
    in_view = {p for r in seen for p in prior.room_by_id[r].planes}
    items = set(graph.object_by_id)
    placement = truth.placement
    if truth.placement != truth.start:
        center = np.array([graph.room_by_id[r].center[:2] for r in order])
        own = [truth.room_placements[r] for r in order]
        placement = best_placement(own, center, truth.placement.z)
    return msgspec.structs.replace(
        truth,
        placement=placement,
        room_placements={r: truth.room_placements[r] for r in order},
        storeys=_only(truth.storeys, graph.storey_by_id),
        rooms={r: truth.rooms[r] for r in order},
        planes=_only(truth.planes, graph.plane_by_id),
        objects=_only(truth.objects, items),
        duplicates=_only(truth.duplicates, items),
        confused=tuple(o for o in truth.confused if o in items),
        wrong_wall=tuple(o for o in truth.wrong_wall if o in items),
        moved=tuple(
            msgspec.structs.replace(m, online=m.online if m.online in graph.plane_by_id else None)
            for m in truth.moved
            if m.prior in in_view
        ),
        missing_planes=tuple(p for p in truth.missing_planes if p in in_view),
        missed_objects=tuple(
            o for o in truth.missed_objects if seen & set(prior.object_by_id[o].rooms)
        ),
        false_rooms=false_rooms,
        false_planes=tuple(p for p in truth.false_planes if p in graph.plane_by_id),
        false_objects=tuple(o for o in truth.false_objects if o in items),
        order=order,
        walked=truth.walked[: len(order)],
    )


def _only(mapping: dict[str, str], ids: Iterable[str]) -> dict[str, str]:
    kept = set(ids)
    return {a: b for a, b in mapping.items() if a in kept}
