"""Objects as evidence: the log ratio of a placement's objects to clutter (definition, section 6).

The objects of both graphs as tables; ``sightings`` weighs them. Objects of a category that the
plan does not model are no evidence.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np

from situgraph.matching.blocks import Block
from situgraph.matching.config import MatchingConfig
from situgraph.matching.sightings import Planned, Rates
from situgraph.matching.tables import Floats, Ints
from situgraph.scenegraph.graph import SceneGraph


class PlannedObjects(NamedTuple):
    """The objects of the plan that are evidence, as the search's tables name rooms and planes."""

    ids: tuple[str, ...]
    column: dict[str, int]  # of each modelled category
    share: Floats  # of each category among them
    table: Planned


class ListedObjects(NamedTuple):
    """The online objects that are evidence."""

    ids: list[str]
    spot: list[float]  # x, y and z of each, map frame
    entry: list[int]  # of each: category, 1 when it is on any plane, where its rooms and planes end
    room: list[int]  # the countable rooms each is in
    plane: list[int]  # the planes of the graph each is on


def planned_objects(
    prior: SceneGraph, kept: Ints, source: Ints, origin: Floats, config: MatchingConfig
) -> PlannedObjects:
    """The evidence a plan offers.

    ``kept`` are the rooms that count, ``source`` the planes of their rows, ``origin`` the index's.
    """
    column = {c: k for k, c in enumerate(sorted(prior.modelled))}
    objects = [o for o in prior.objects if o.category in column]
    rooms = {prior.rooms[k].id: a for a, k in enumerate(kept.tolist())}
    planes = {p.id: k for k, p in enumerate(prior.planes)}
    category = np.array([column[o.category] for o in objects], dtype=np.int64)
    counts = np.bincount(category, minlength=len(column))
    place = np.array([o.center[:2] for o in objects]).reshape(-1, 2) - origin
    homes = [[rooms[r] for r in o.rooms if r in rooms] for o in objects]
    held: list[list[int]] = [[] for _ in kept]
    for i, mine in enumerate(homes):
        for a in mine:
            held[a].append(i)
    made = (
        category,
        place,
        *_packed([planes[p] for p in o.planes if p in planes] for o in objects),
        *_packed(held),
        *_packed(homes),
        source,
    )
    table = Planned(*made, Block.of(Planned, made))
    share = np.maximum(config.least_share, counts / max(1, len(objects)))
    return PlannedObjects(tuple(o.id for o in objects), column, share, table)


def list_objects(
    online: SceneGraph, kept: list[int], row: dict[str, int], column: dict[str, int]
) -> ListedObjects:
    """The online objects of the categories in ``column`` that are in a room that counts.

    ``kept`` are those rooms, ``row`` the planes of the graph by id.
    """
    rooms = {online.rooms[k].id: r for r, k in enumerate(kept)}
    listed = ids, spot, entry, room, plane = ListedObjects([], [], [], [], [])
    for o in online.objects if column else ():
        category, begin = column.get(o.category), len(room)
        if category is None:
            continue
        for name in o.rooms:
            if name in rooms:
                room.append(rooms[name])
        if len(room) == begin:
            continue
        planes = o.planes
        for name in planes:
            if name in row:
                plane.append(row[name])
        ids.append(o.id)
        spot += o.center
        entry += (category, 1 if planes else 0, len(room), len(plane))
    return listed


def rates_of(planned: PlannedObjects, config: MatchingConfig) -> Rates:
    """The error rates of the plan's categories."""
    rates = [config.rates_of(c) for c in planned.column]
    miss = np.array([r.miss for r in rates])
    wrong = np.array([r.wrong_wall for r in rates])
    astray = np.array([r.wrong_join for r in rates])
    half = np.array([r.half_seen for r in rates])
    area, tail = config.clutter_area, config.object_tail_share
    values: dict[str, Any] = {
        "hit": np.log1p(-miss),
        "miss": np.log(miss),
        "false": np.log([r.false for r in rates]),
        "duplicate": np.log([r.duplicate for r in rates]),
        "confusion": np.log([r.confusion for r in rates]),
        "same_wall": np.log1p(-wrong),
        "other_wall": np.log(wrong),
        "same_join": np.log1p(-astray) + np.log1p(-half),
        "half_join": np.log1p(-astray) + np.log(half),
        "other_join": np.log(astray),
        "share": np.log(planned.share),
        "half_miss": np.log1p(miss) - math.log(2),
        "bell": area * (1 - tail) / (2 * math.pi * config.object_sigma**2),
        "sharpness": 1 / (2 * config.object_sigma**2),
        "disc": area * tail / (math.pi * config.object_tail_radius**2),
        "radius": config.object_tail_radius,
        "shared": config.object_shared,
        "whole": config.seen_whole,
    }
    near = math.log(values["bell"] + values["disc"]) - values["share"]
    seen = np.maximum(np.maximum(values["hit"], values["confusion"]), values["duplicate"])
    values["most"] = np.maximum(np.maximum(near + seen, values["false"]), 0.0)
    return Rates(**values, slots=Block(Rates, {}, **values))


def _packed(lists: Iterable[list[int]]) -> tuple[Ints, Ints]:
    """Lists one after the other: where each begins, and what they hold."""
    first, items = [0], []
    for one in lists:
        items += one
        first.append(len(items))
    return np.array(first, dtype=np.int64), np.array(items, dtype=np.int64)
