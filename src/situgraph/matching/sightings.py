"""What the objects say of many placements: the compiled half of ``semantics``.

Each online object of an explained room is a first sight of a prior object, a second sight of one
that has been seen, or false; each prior object of a matched room was seen or missed (definition,
section 6). The likeliest assignment counts.
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from situgraph.matching.blocks import Block
from situgraph.matching.compiled import part
from situgraph.matching.tables import Floats, Ints, Table
from situgraph.matching.wall_errors import Walls, shared_errors

ALONE, SAME, HALF, ASTRAY = range(4)  # how the rooms of a sight and of its object agree


class Planned(NamedTuple):
    """The plan's objects; lengths in metres from the index's origin."""

    category: Ints  # (m,)
    place: Table  # (m, 2)
    plane_first: Ints  # (m + 1,) the prior planes each hangs on
    plane: Ints
    room_first: Ints  # (M + 1,) the objects of each prior room that counts
    item: Ints
    home_first: Ints  # (m + 1,) the prior rooms that count each is in
    home: Ints
    row_plane: Ints  # (Q,) the prior plane of each prior row
    slots: Block  # in memory


class Sighted(NamedTuple):
    """The online objects; lengths from the mean room centre, map frame."""

    category: Annotated[Ints, "objects"]
    hung: Annotated[Ints, "objects"]  # 1 when it is on any plane
    room_first: Annotated[Ints, "objects + 1"]  # the countable rooms each is in
    room: Annotated[Ints, "homes"]
    place: Annotated[Floats, "objects", 2]
    row_first: Annotated[Ints, "objects + 1"]  # the plane rows each is on
    row: Annotated[Ints, "hung rows"]


class Rates(NamedTuple):
    """Logarithms of the error rates by category (C,), and the shape of the error in place."""

    hit: Floats
    miss: Floats
    false: Floats
    duplicate: Floats
    confusion: Floats
    same_wall: Floats
    other_wall: Floats
    same_join: Floats
    half_join: Floats
    other_join: Floats
    share: Floats
    half_miss: Floats  # not seen, of a room seen by half
    most: Floats  # an upper bound on what one object adds
    bell: float  # peak of the density of the place against anywhere
    sharpness: float  # 1 / (2 sigma^2)
    disc: float  # the tail's
    radius: float
    shared: float  # share of the variance of the place that is common to a wall
    whole: float  # probability that a room was seen whole
    slots: Block  # in memory


class Links(NamedTuple):
    """Which online object may be which prior one at a placement, by online object."""

    first: Annotated[Ints, "objects + 1"]
    item: Annotated[Ints, "links"]  # prior objects
    gain: Annotated[Floats, "links"]  # over being a second sight or false
    second: Annotated[Ints, "objects"]  # the prior object each is a second sight of, else -1
    claim: Annotated[Ints, "objects"]  # the link each takes, -1 for none
    owner: Annotated[Ints, "planned"]  # the online object that claims it, -1 for none
    best: Annotated[Floats, "objects"]  # of a chain of exchanges that leaves it without its claim
    via: Annotated[Ints, "objects"]  # the link by which the chain came
    tried: Annotated[Ints, "planned"]  # the online object it was last compared with
    counted: Annotated[Ints, "planned"]  # the placement at which it was last counted
    found: Annotated[Ints, "M"]  # the placement at which each prior room was last matched


class Evidence(NamedTuple):
    """The objects of both graphs, and room to work in."""

    sighted: Sighted
    side: float  # 1, or -1 for the mirror image
    planned: Planned
    rates: Rates
    links: Links
    walls: Walls


@part
def nothing_claimed(t):
    """To be called once, before any placement is weighed."""
    for q in range(len(t.links.owner)):
        t.links.owner[q] = -1
    for i in range(len(t.walls.first)):
        t.walls.first[i] = -1


@part
def evidence_at(t, view, at, number, claim):
    """Log ratio of the objects of an ``Evidence`` at yaw, x, y; nan without room for the links.

    ``view`` are the correspondences there, ``number`` counts placements from 1. Into ``claim``
    (n,) goes the prior object of each online one, -1 for none.
    """
    links = t.links
    for r in range(len(view.room)):
        if view.room[r] >= 0:
            links.found[view.room[r]] = number
    total = _link(t, view, at, number)
    if math.isnan(total):
        return total
    total += _assign(links)
    total += shared_errors(t, view, at)
    total += _missed(t, view, number)
    for o in range(len(claim)):
        link = links.claim[o]
        claim[o] = -1
        if link >= 0:
            claim[o] = links.item[link]
            links.owner[links.item[link]] = -1
    return total


@part
def _link(t, view, at, number):
    """List the possible claims; the sum if nothing is claimed, nan when there is no room for them.

    Of the prior rooms, those that are matched have ``found`` equal to ``number``.
    """
    sighted, planned, rates, links = t.sighted, t.planned, t.rates, t.links
    n, most = len(sighted.category), len(links.item)
    c, s = math.cos(at[0]), math.sin(at[0])
    total, count = 0.0, 0
    for o in range(n):
        mine = sighted.category[o]
        x, y = t.side * sighted.place[o, 0], sighted.place[o, 1]
        px, py = at[1] + c * x - s * y, at[2] + s * x + c * y
        begin, here, rest = count, False, rates.false[mine]
        links.second[o] = -1
        for e in range(sighted.room_first[o], sighted.room_first[o + 1]):
            a = view.room[sighted.room[e]]
            if a < 0:
                continue
            here = True
            for f in range(planned.room_first[a], planned.room_first[a + 1]):
                q = planned.item[f]
                if links.tried[q] == number * n + o:
                    continue
                links.tried[q] = number * n + o
                near = _nearness(rates, px - planned.place[q, 0], py - planned.place[q, 1])
                if near == -math.inf:
                    continue
                near -= rates.share[mine]
                if planned.category[q] == mine and near + rates.duplicate[mine] > rest:
                    rest, links.second[o] = near + rates.duplicate[mine], q
                if count == most:
                    return math.nan
                links.item[count] = q
                links.gain[count] = near + _first_sight(t, view, o, q, number)
                count += 1
        kept = begin
        for e in range(begin, count):
            if links.gain[e] > rest:
                links.item[kept] = links.item[e]
                links.gain[kept] = links.gain[e] - rest
                kept += 1
        count = kept
        links.first[o + 1] = count
        if here:
            total += rest
    return total


@part
def _first_sight(t, view, o, q, number):
    """Log ratio of what ``o`` is, is on and joins, when it is the first sight of ``q``."""
    sighted, planned, rates = t.sighted, t.planned, t.rates
    mine = sighted.category[o]
    value = rates.hit[mine] if planned.category[q] == mine else rates.confusion[mine]
    if sighted.hung[o] and planned.plane_first[q + 1] > planned.plane_first[q]:
        same = _on_one_wall(sighted, planned, view, o, q)
        value += rates.same_wall[mine] if same else rates.other_wall[mine]
    joint = _joint(t, view, o, q, number)
    if joint == SAME:
        value += rates.same_join[mine]
    elif joint == HALF:
        value += rates.half_join[mine]
    elif joint == ASTRAY:
        value += rates.other_join[mine]
    return value


@part
def _joint(t, view, o, q, number):
    """Whether ``o`` joins the matched rooms that ``q`` joins; ``ALONE`` where neither joins any."""
    sighted, planned, found = t.sighted, t.planned, t.links.found
    begin, end = planned.home_first[q], planned.home_first[q + 1]
    matched = 0
    for e in range(begin, end):
        if found[planned.home[e]] == number:
            matched += 1
    here, astray = 0, False
    for e in range(sighted.room_first[o], sighted.room_first[o + 1]):
        a = view.room[sighted.room[e]]
        if a < 0:
            continue
        here += 1
        inside = False
        for f in range(begin, end):
            inside = inside or planned.home[f] == a
        astray = astray or not inside
    if max(here, matched) < 2:
        return ALONE
    if astray:
        return ASTRAY
    return SAME if here == matched else HALF


@part
def _nearness(rates, x, y):
    """Ln of the density of an object's place against anywhere in the clutter area."""
    square = x * x + y * y
    density = rates.bell * math.exp(-square * rates.sharpness)
    if square <= rates.radius * rates.radius:
        density += rates.disc
    return math.log(density) if density > 0.0 else -math.inf


@part
def _on_one_wall(sighted, planned, view, o, q):
    """Whether a plane of ``o`` corresponds to one of ``q``."""
    for e in range(sighted.row_first[o], sighted.row_first[o + 1]):
        j = view.row[sighted.row[e]]
        if j < 0:
            continue
        for f in range(planned.plane_first[q], planned.plane_first[q + 1]):
            if planned.plane[f] == planned.row_plane[j]:
                return True
    return False


@part
def _assign(links):
    """The largest sum of gains, each prior object claimed once; online objects one by one.

    A new object takes the best chain of exchanges: it claims what another one had, who claims
    something else, and so on to an object that is free or one that goes without.
    """
    total = 0.0
    n = len(links.claim)
    for o in range(n):
        links.claim[o] = -1
    for start in range(n):
        if links.first[start] == links.first[start + 1]:
            continue
        for o in range(start + 1):
            links.best[o] = -math.inf
        links.best[start] = 0.0
        links.via[start] = -1
        gain, end, free = 0.0, start, -1
        changed = True
        while changed:
            changed = False
            for o in range(start + 1):
                reach = links.best[o]
                if reach == -math.inf:
                    continue
                for e in range(links.first[o], links.first[o + 1]):
                    holder = links.owner[links.item[e]]
                    value = reach + links.gain[e]
                    if holder == o:
                        continue
                    if holder < 0:
                        if value > gain + 1e-12:
                            gain, end, free = value, o, e
                        continue
                    value -= links.gain[links.claim[holder]]
                    if value > links.best[holder] + 1e-12:
                        links.best[holder] = value
                        links.via[holder] = e * n + o
                        changed = True
                        if value > gain + 1e-12:
                            gain, end, free = value, holder, -1
        total += gain
        _exchange(links, start, end, free)
    return total


@part
def _exchange(links, start, end, free):
    """Hand the claims on along the chain from ``start`` to ``end``, who takes ``free`` or none."""
    n = len(links.claim)
    link, o = free, end
    while True:
        came = links.via[o]
        links.claim[o] = link
        if link >= 0:
            links.owner[links.item[link]] = o
        if o == start:
            break
        link, o = came // n, came % n


@part
def _missed(t, view, number):
    """What the prior objects without a sight cost, room by room; each room perhaps seen in part.

    An object of two matched rooms is counted in the first.
    """
    planned, rates, links = t.planned, t.rates, t.links
    total = 0.0
    for r in range(len(view.room)):
        a = view.room[r]
        if a < 0:
            continue
        whole, half, seen, hits = 0.0, 0.0, 0.0, 0
        for f in range(planned.room_first[a], planned.room_first[a + 1]):
            q = planned.item[f]
            if links.counted[q] == number:
                continue
            links.counted[q] = number
            c = planned.category[q]
            if links.owner[q] >= 0:
                hits += 1
                seen += rates.hit[c]
                whole += rates.hit[c]
                half += rates.hit[c] - math.log(2.0)
            else:
                whole += rates.miss[c]
                half += rates.half_miss[c]
        top = 0.0 if hits == 0 else max(whole, half)
        chance = rates.whole * math.exp(whole - top)
        chance += (1.0 - rates.whole) / 2 * math.exp(half - top)
        if hits == 0:
            chance += (1.0 - rates.whole) / 2
        total += top + math.log(chance) - seen
    return total
