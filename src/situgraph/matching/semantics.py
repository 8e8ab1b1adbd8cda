"""Objects as evidence: the log ratio of a placement's objects to clutter (definition, section 6).

Each online object of an explained room is a first sight of a prior object, a second sight of one
that has been seen, or false; each prior object of a matched room was seen or missed. The likeliest
assignment counts. Objects of a category that the plan does not model are no evidence.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from situgraph.matching.config import MatchingConfig, ObjectRates
from situgraph.matching.tables import Floats, Ints
from situgraph.matching.views import View
from situgraph.scenegraph.graph import Object, SceneGraph

Bools = NDArray[np.bool_]
SEEN_SHARES = (0.0, 0.5)  # of a room that was not seen whole


class PlannedObjects(NamedTuple):
    """The objects of the plan that are evidence, as the search's tables name rooms and planes."""

    objects: tuple[Object, ...]
    place: Floats  # (m, 2) in the plan, relative to the index's origin
    share: dict[str, float]  # of each modelled category among them
    by_room: dict[int, list[int]]  # objects of each prior room that counts
    by_plane: dict[int, list[int]]  # objects on each prior plane


class SeenObjects(NamedTuple):
    """The online objects that are evidence; membership by countable room and by plane row."""

    objects: tuple[Object, ...]
    place: Floats  # (n, 2) relative to the mean room centre, map frame
    in_room: Bools  # (n, N)
    on_row: Bools  # (n, P)
    on_any: Bools  # (n,)


class Evidence(NamedTuple):
    """The log ratio, and which online object is which prior one."""

    value: float
    pairs: dict[str, str]


def planned_objects(
    prior: SceneGraph, kept: Ints, origin: Floats, config: MatchingConfig
) -> PlannedObjects:
    """The evidence a plan offers; ``kept`` are the rooms that count, ``origin`` the index's."""
    modelled = prior.modelled
    objects = tuple(o for o in prior.objects if o.category in modelled)
    counts: dict[str, int] = dict.fromkeys(sorted(modelled), 0)
    for item in objects:
        counts[item.category] += 1
    total = max(1, len(objects))
    share = {c: max(config.least_share, n / total) for c, n in counts.items()}
    rooms = {prior.rooms[k].id: a for a, k in enumerate(kept.tolist())}
    planes = {p.id: k for k, p in enumerate(prior.planes)}
    place = np.array([o.center[:2] for o in objects]).reshape(-1, 2) - origin
    return PlannedObjects(
        objects,
        place,
        share,
        _members((i, rooms.get(r)) for i, o in enumerate(objects) for r in o.rooms),
        _members((i, planes.get(p)) for i, o in enumerate(objects) for p in o.planes),
    )


def seen_objects(
    online: SceneGraph, kept: Ints, source: Ints, middle: Floats, planned: PlannedObjects
) -> SeenObjects:
    """The online objects of modelled categories that are in a room that counts."""
    rooms = {online.rooms[k].id: i for i, k in enumerate(kept.tolist())}
    objects = tuple(
        o
        for o in online.objects
        if o.category in planned.share and any(r in rooms for r in o.rooms)
    )
    numbers = {p.id: k for k, p in enumerate(online.planes)}
    in_room = np.zeros((len(objects), len(kept)), dtype=bool)
    on_row = np.zeros((len(objects), len(source)), dtype=bool)
    for i, item in enumerate(objects):
        in_room[i, [rooms[r] for r in item.rooms if r in rooms]] = True
        for plane in item.planes:
            on_row[i] |= source == numbers[plane]
    on_any = np.array([bool(o.planes) for o in objects], dtype=bool)
    place = np.array([o.center[:2] for o in objects]).reshape(-1, 2) - middle
    return SeenObjects(objects, place, in_room, on_row, on_any)


def evidence(
    seen: SeenObjects,
    planned: PlannedObjects,
    view: View,
    prior_plane: Ints,
    at: tuple[float, float, float],
    config: MatchingConfig,
) -> Evidence:
    """The evidence of the objects at a placement ``at`` (yaw, x, y) with correspondences ``view``.

    ``prior_plane`` gives the plane of each prior row.
    """
    room = view.room
    here = np.flatnonzero((seen.in_room & (room >= 0)).any(axis=1))
    there = sorted({q for a in room[room >= 0].tolist() for q in planned.by_room.get(a, ())})
    column = {q: j for j, q in enumerate(there)}
    planned_in = np.zeros((len(there), len(room)), dtype=bool)
    for k in np.flatnonzero(room >= 0).tolist():
        planned_in[[column[q] for q in planned.by_room.get(int(room[k]), ())], k] = True
    rest = np.array([math.log(_rates(seen.objects[i], config).false) for i in here])
    claims: dict[int, int] = {}
    value = float(rest.sum())
    if len(here) and there:
        first, second = _sights(
            seen, planned, view, prior_plane, at, here, there, column, planned_in, config
        )
        rest = np.maximum(rest, second.max(axis=1))
        value, claims = _assigned(first, rest)
    missed = _missed(planned, there, planned_in, room, set(claims.values()), config)
    pairs = {
        seen.objects[here[i]].id: planned.objects[there[j]].id for i, j in sorted(claims.items())
    }
    return Evidence(value + missed, pairs)


def _sights(
    seen: SeenObjects,
    planned: PlannedObjects,
    view: View,
    prior_plane: Ints,
    at: tuple[float, float, float],
    here: Ints,
    there: Sequence[int],
    column: dict[int, int],
    planned_in: Bools,
    config: MatchingConfig,
) -> tuple[Floats, Floats]:
    """Log ratios (n, m) of online objects as first and as second sights of prior ones."""
    mine, theirs = [seen.objects[i] for i in here], [planned.objects[q] for q in there]
    possible = _shared(seen.in_room[here], planned_in)
    planned_on = np.zeros((len(there), len(view.row)), dtype=bool)
    for k in np.flatnonzero(view.row >= 0).tolist():
        on = planned.by_plane.get(int(prior_plane[view.row[k]]), ())
        planned_on[[column[q] for q in on if q in column], k] = True
    same_wall = _shared(seen.on_row[here], planned_on)
    both = seen.on_any[here][:, None] & np.array([bool(q.planes) for q in theirs])[None]
    alike = np.array([o.category for o in mine])[:, None] == np.array([q.category for q in theirs])
    rates = [_rates(o, config) for o in mine]
    share = np.array([planned.share[o.category] for o in mine])
    near = (
        _nearness(seen.place[here], planned.place[list(there)], at, config) - np.log(share)[:, None]
    )
    hit = np.log([1 - r.miss for r in rates])[:, None]
    confused = np.log([r.confusion for r in rates])[:, None]
    twice = np.log([r.duplicate for r in rates])[:, None]
    off = np.array([r.wrong_wall for r in rates])[:, None]
    wall = np.where(both, np.where(same_wall, np.log1p(-off), np.log(off)), 0.0)
    first = np.where(possible, near + np.where(alike, hit, confused) + wall, -np.inf)
    second = np.where(possible & alike, near + twice, -np.inf)
    return first, second


def _assigned(first: Floats, rest: Floats) -> tuple[float, dict[int, int]]:
    """The largest sum over the online objects, and which claims which.

    A first sight is worth more than a second, so each object may choose freely between a claim of
    its own and the best of the rest.
    """
    from scipy.optimize import linear_sum_assignment

    gain = np.maximum(first - rest[:, None], 0.0)
    rows, columns = linear_sum_assignment(gain, maximize=True)
    claims = {int(i): int(j) for i, j in zip(rows, columns, strict=True) if gain[i, j] > 0.0}
    return float(rest.sum()) + sum(float(gain[i, j]) for i, j in claims.items()), claims


def _missed(
    planned: PlannedObjects,
    there: Sequence[int],
    planned_in: Bools,
    room: Ints,
    claimed: set[int],
    config: MatchingConfig,
) -> float:
    """What the prior objects without a sight cost, room by room; each room perhaps seen in part."""
    counted = np.zeros(len(there), dtype=bool)
    total = 0.0
    for k in np.flatnonzero(room >= 0).tolist():
        own = np.flatnonzero(planned_in[:, k] & ~counted).tolist()
        counted[own] = True
        if not own:
            continue
        miss = np.array([_rates(planned.objects[there[j]], config).miss for j in own])
        hit = np.array([int(j) in claimed for j in own])
        whole = float(np.prod(np.where(hit, 1 - miss, miss)))
        part = float(
            np.mean([np.prod(np.where(hit, u * (1 - miss), 1 - u + u * miss)) for u in SEEN_SHARES])
        )
        chance = config.seen_whole * whole + (1 - config.seen_whole) * part
        total += math.log(chance) - float(np.log1p(-miss[hit]).sum())
    return total


def _nearness(
    mine: Floats, theirs: Floats, at: tuple[float, float, float], config: MatchingConfig
) -> Floats:
    """Ln G (n, m): the density of an object's place against anywhere in the clutter area."""
    c, s = math.cos(at[0]), math.sin(at[0])
    moved = mine @ np.array([[c, s], [-s, c]]) + np.array(at[1:])
    square = ((moved[:, None] - theirs[None]) ** 2).sum(axis=2)
    spread, radius = config.object_sigma**2, config.object_tail_radius**2
    bell = np.exp(-square / (2 * spread)) / (2 * math.pi * spread)
    disc = (square <= radius) / (math.pi * radius)
    tail = config.object_tail_share
    with np.errstate(divide="ignore"):
        nearness: Floats = np.log(config.clutter_area * ((1 - tail) * bell + tail * disc))
    return nearness


def _shared(first: Bools, second: Bools) -> Bools:
    """Whether rows of two membership tables (n, k), (m, k) have a column in common: (n, m)."""
    shared: Bools = first.astype(np.float32) @ second.astype(np.float32).T > 0.0
    return shared


def _rates(item: Object, config: MatchingConfig) -> ObjectRates:
    return config.category_rates.get(item.category, config.rates)


def _members(pairs: Iterable[tuple[int, int | None]]) -> dict[int, list[int]]:
    found: dict[int, list[int]] = {}
    for item, group in pairs:
        if group is not None:
            found.setdefault(group, []).append(item)
    return found
