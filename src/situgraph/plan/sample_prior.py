"""A prior graph as the arrays that sampling needs, made once a building."""

from __future__ import annotations

import math

import msgspec
import numpy as np

from situgraph.geometry.poses import Array
from situgraph.plan.exploration import RoomLinks
from situgraph.plan.sampler_config import DetectionRates, SamplerConfig
from situgraph.scenegraph.graph import SceneGraph

RATES = DetectionRates.__struct_fields__

# Where a room names no storey its floor lies this far (m) below its centre.
HALF_HEIGHT = 1.4


class PriorArrays(msgspec.Struct, frozen=True):
    """Rows follow the prior's order of rooms, planes and objects; lengths in metres.

    ``normal`` (p, 3), ``offset`` (p,), ``anchor`` (p, 2): a point of the face; ``extent``
    (p, 2, 2): NaN where unknown; ``back``: the faces on the other side of each wall; ``center``
    (r, 3); ``floor`` (r,): heights of the floors; ``object_center`` (o, 3); ``rates`` (o, 5): the
    fields of DetectionRates in their order.
    """

    graph: SceneGraph
    normal: Array
    offset: Array
    anchor: Array
    extent: Array
    back: dict[int, list[int]]
    planes: list[list[int]]
    center: Array
    floor: Array
    footprint: list[Array | None]
    objects: list[list[int]]
    object_center: Array
    object_rooms: list[list[int]]
    object_planes: list[list[int]]
    rates: Array
    categories: tuple[str, ...]


def prior_arrays(prior: SceneGraph, links: RoomLinks, config: SamplerConfig) -> PriorArrays:
    """The arrays of ``prior``; relations to rooms and planes become rows."""
    room_row = {r.id: i for i, r in enumerate(prior.rooms)}
    plane_row = {p.id: i for i, p in enumerate(prior.planes)}
    nowhere = ((math.nan, math.nan), (math.nan, math.nan))
    extent = np.array([p.extent or nowhere for p in prior.planes], dtype=float).reshape(-1, 2, 2)
    normal = np.array([p.normal for p in prior.planes], dtype=float).reshape(-1, 3)
    offset = np.array([p.offset for p in prior.planes], dtype=float)
    objects: list[list[int]] = [[] for _ in prior.rooms]
    for i, item in enumerate(prior.objects):
        for room in item.rooms:
            objects[room_row[room]].append(i)
    elevation = {s.id: s.elevation for s in prior.storeys}
    planes = [[plane_row[p] for p in r.planes] for r in prior.rooms]
    rates = [config.detection.get(o.category, config.detection_default) for o in prior.objects]
    return PriorArrays(
        graph=prior,
        normal=normal,
        offset=offset,
        anchor=_anchors(planes, normal, offset, extent, links.center),
        extent=extent,
        back={plane_row[p]: [plane_row[q] for q in others] for p, others in links.back.items()},
        planes=planes,
        center=links.center,
        floor=np.array(
            [elevation.get(r.storey or "", r.center[2] - HALF_HEIGHT) for r in prior.rooms]
        ),
        footprint=[None if r.footprint is None else np.array(r.footprint) for r in prior.rooms],
        objects=objects,
        object_center=np.array([o.center for o in prior.objects], dtype=float).reshape(-1, 3),
        object_rooms=[[room_row[r] for r in o.rooms] for o in prior.objects],
        object_planes=[[plane_row[p] for p in o.planes] for o in prior.objects],
        rates=np.array([[getattr(r, f) for f in RATES] for r in rates]).reshape(-1, len(RATES)),
        categories=tuple(sorted(prior.categories | {"door", "window"})),
    )


def _anchors(
    planes: list[list[int]], normal: Array, offset: Array, extent: Array, center: Array
) -> Array:
    """A point of each face: the middle of its extent, else the foot of a room's centre on it."""
    anchor = np.asarray(extent.mean(axis=1), dtype=float)
    for room, rows in enumerate(planes):
        for p in rows:
            if math.isnan(anchor[p, 0]):
                height = float(normal[p] @ center[room] + offset[p])
                anchor[p] = center[room, :2] - height * normal[p, :2]
    return anchor
