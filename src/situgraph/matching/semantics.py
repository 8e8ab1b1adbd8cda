"""Objects as evidence: the log ratio of a placement's objects to clutter (definition, section 6).

The objects of both graphs as tables; ``sightings`` weighs them. Objects of a category that the
plan does not model are no evidence.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import accumulate, chain, pairwise
from typing import Any, NamedTuple

import numpy as np

from situgraph.matching.blocks import Block
from situgraph.matching.config import MatchingConfig
from situgraph.matching.sightings import Planned, Rates, Sighted
from situgraph.matching.tables import Floats, Ints
from situgraph.matching.wall_errors import most_shared
from situgraph.scenegraph.graph import SceneGraph


class PlannedObjects(NamedTuple):
    """The objects of the plan that are evidence, as the search's tables name rooms and planes."""

    ids: tuple[str, ...]
    column: dict[str, int]  # of each modelled category
    share: Floats  # of each category among them
    table: Planned


class SeenObjects(NamedTuple):
    """The online objects that are evidence."""

    ids: tuple[str, ...]
    table: Sighted
    only: list[int]  # the room each is in, where that is one; else -1
    rows: int  # of planes that objects may be on


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


def seen_objects(
    online: SceneGraph,
    kept: Ints,
    source: Ints,
    middle: Floats,
    planned: PlannedObjects,
    flipped: bool,
) -> SeenObjects:
    """The online objects of modelled categories that are in a room that counts.

    ``flipped``: of the mirror image, of which ``middle`` is the mean room centre.
    """
    rooms = {online.rooms[k].id: i for i, k in enumerate(kept.tolist())}
    rows: dict[str, list[int]] = {}
    for k, plane in enumerate(source.tolist()):
        rows.setdefault(online.planes[plane].id, []).append(k)
    ids: list[str] = []
    place: list[float] = []
    category: list[int] = []
    hung: list[int] = []
    only: list[int] = []
    room_first, row_first = [0], [0]
    room: list[int] = []
    row: list[int] = []
    for o in online.objects:
        column = planned.column.get(o.category)
        if column is None:
            continue
        begin = len(room)
        for name in o.rooms:
            if name in rooms:
                room.append(rooms[name])
        if len(room) == begin:
            continue
        for name in o.planes:
            row += rows.get(name, ())
        ids.append(o.id)
        category.append(column)
        x, y, _ = o.center
        place += (-x if flipped else x, y)
        hung.append(1 if o.planes else 0)
        only.append(room[begin] if len(room) == begin + 1 else -1)
        room_first.append(len(room))
        row_first.append(len(row))
    at = np.fromiter(place, dtype=np.float64).reshape(-1, 2) - middle
    whole = _pieces((category, room_first, room, row_first, row, hung))
    return SeenObjects(tuple(ids), Sighted(whole[0], at, *whole[1:]), only, len(source))


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


def most_evidence(seen: SeenObjects, rates: Rates) -> tuple[list[float], float]:
    """An upper bound on the log ratio: what each online object adds, and what walls add.

    Each is at its place and on its wall, or of no account. Prior objects that were missed only
    lower the sum, and so does a wall whose objects are told apart.
    """
    table = seen.table
    together = most_shared(table.row_first, table.row, seen.rows, rates.shared)
    return rates.most[table.category].tolist(), float(together)


def _pieces(lists: Sequence[list[int]]) -> list[Ints]:
    """Each list as an array; they are made at once, which is faster."""
    ends = [*accumulate(map(len, lists), initial=0)]
    whole = np.fromiter(chain.from_iterable(lists), np.int64, ends[-1])
    return [whole[begin:end] for begin, end in pairwise(ends)]


def _packed(lists: Iterable[list[int]]) -> tuple[Ints, Ints]:
    """Lists one after the other: where each begins, and what they hold."""
    first, items = [0], []
    for one in lists:
        items += one
        first.append(len(items))
    return np.array(first, dtype=np.int64), np.array(items, dtype=np.int64)
