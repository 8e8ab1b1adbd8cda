"""What the objects say of many placements: the compiled half of ``semantics``.

Each online object of an explained room is a first sight of a prior object, a second sight of one
that has been seen, or false; each prior object of a matched room was seen or missed (definition,
section 6). The likeliest assignment counts.
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from situgraph.matching.compiled import entry, kernel
from situgraph.matching.tables import Floats, Ints
from situgraph.matching.wall_errors import room_for_walls, shared_errors

ALONE, SAME, HALF, ASTRAY = range(4)  # how the rooms of a sight and of its object agree


class Planned(NamedTuple):
    """The plan's objects; lengths in metres from the index's origin."""

    category: Ints  # (m,)
    place: Floats  # (m, 2)
    plane_first: Ints  # (m + 1,) the prior planes each hangs on
    plane: Ints
    room_first: Ints  # (M + 1,) the objects of each prior room that counts
    item: Ints
    home_first: Ints  # (m + 1,) the prior rooms that count each is in
    home: Ints


class Sighted(NamedTuple):
    """The online objects; lengths from the mean room centre, map frame."""

    category: Ints  # (n,)
    place: Floats  # (n, 2)
    room_first: Ints  # (n + 1,) the countable rooms each is in
    room: Ints
    row_first: Ints  # (n + 1,) the plane rows each is on
    row: Ints
    hung: Ints  # (n,) 1 when it is on any plane


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
    bell: float  # peak of the density of the place against anywhere
    sharpness: float  # 1 / (2 sigma^2)
    disc: float  # the tail's
    radius: float
    shared: float  # share of the variance of the place that is common to a wall
    whole: float  # probability that a room was seen whole


class Links(NamedTuple):
    """Which online object may be which prior one at a placement, by online object."""

    first: Ints  # (n + 1,)
    item: Ints  # (k,) prior objects
    gain: Floats  # (k,) over being a second sight or false
    second: Ints  # (n,) the prior object each is a second sight of, else -1
    claim: Ints  # (n,) the link each object takes, -1 for none
    owner: Ints  # (m,) the online object that claims each prior one, -1 for none
    best: Floats  # (n,) of a chain of exchanges that leaves an object without its claim
    via: Ints  # (n,) the link by which the chain came


@entry
def weigh(sighted, planned, rates, prior_plane, rooms, rows, at, claims):
    """Log ratios (k,) of the objects at placements ``at`` (k, 3): yaw, x, y.

    ``rooms`` (k, N) and ``rows`` (k, P) are the correspondences, ``prior_plane`` the plane of each
    prior row. Into ``claims`` (k, n) goes the prior object of each online one, -1 for none.
    """
    n, m = len(sighted.category), len(planned.category)
    value = np.empty(len(at))
    links = Links(
        np.zeros(n + 1, dtype=np.int64),
        np.empty(64, dtype=np.int64),
        np.empty(64),
        np.empty(n, dtype=np.int64),
        np.empty(n, dtype=np.int64),
        np.full(m, -1, dtype=np.int64),
        np.empty(n),
        np.empty(n, dtype=np.int64),
    )
    tried = np.full(m, -1, dtype=np.int64)
    counted = np.full(m, -1, dtype=np.int64)
    found = np.full(len(planned.room_first) - 1, -1, dtype=np.int64)
    walls = room_for_walls(n, rows.shape[1])
    for k in range(len(at)):
        for a in rooms[k]:
            if a >= 0:
                found[a] = k
        total, links = _link(
            sighted, planned, rates, prior_plane, rooms[k], rows[k], at[k], links,
            tried, k * n, found, k,
        )  # fmt: skip
        total += _assign(links)
        total += shared_errors(sighted, planned, rates, prior_plane, rows[k], at[k], links, walls)
        total += _missed(planned, rates, rooms[k], links.owner, counted, k)
        for o in range(n):
            link = links.claim[o]
            claims[k, o] = -1
            if link >= 0:
                claims[k, o] = links.item[link]
                links.owner[links.item[link]] = -1
        value[k] = total
    return value


@kernel
def _link(sighted, planned, rates, prior_plane, room, row, at, links, tried, token, found, number):
    """List the possible claims; the sum if nothing is claimed, and the links, grown if need be.

    Of the prior rooms, those that are matched have ``found`` equal to ``number``.
    """
    c, s = math.cos(at[0]), math.sin(at[0])
    total, count = 0.0, 0
    for o in range(len(sighted.category)):
        mine = sighted.category[o]
        x = at[1] + c * sighted.place[o, 0] - s * sighted.place[o, 1]
        y = at[2] + s * sighted.place[o, 0] + c * sighted.place[o, 1]
        begin, here, rest = count, False, rates.false[mine]
        links.second[o] = -1
        for e in range(sighted.room_first[o], sighted.room_first[o + 1]):
            a = room[sighted.room[e]]
            if a < 0:
                continue
            here = True
            for f in range(planned.room_first[a], planned.room_first[a + 1]):
                q = planned.item[f]
                if tried[q] == token + o:
                    continue
                tried[q] = token + o
                dx, dy = x - planned.place[q, 0], y - planned.place[q, 1]
                near = _nearness(rates.bell, rates.sharpness, rates.disc, rates.radius, dx, dy)
                if near == -np.inf:
                    continue
                near -= rates.share[mine]
                first = near + rates.confusion[mine]
                if planned.category[q] == mine:
                    first = near + rates.hit[mine]
                    again = near + rates.duplicate[mine]
                    if again > rest:
                        rest, links.second[o] = again, q
                if sighted.hung[o] and planned.plane_first[q + 1] > planned.plane_first[q]:
                    same = _on_one_wall(
                        sighted.row_first, sighted.row, planned.plane_first, planned.plane,
                        prior_plane, row, o, q,
                    )  # fmt: skip
                    first += rates.same_wall[mine] if same else rates.other_wall[mine]
                joint = _joint(
                    sighted.room_first, sighted.room, planned.home_first, planned.home,
                    room, o, q, found, number,
                )  # fmt: skip
                if joint == SAME:
                    first += rates.same_join[mine]
                elif joint == HALF:
                    first += rates.half_join[mine]
                elif joint == ASTRAY:
                    first += rates.other_join[mine]
                if count == len(links.item):
                    links = _grown(links)
                links.item[count] = q
                links.gain[count] = first
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
    return total, links


@kernel
def _joint(room_first, rooms, home_first, home, room, o, q, found, number):
    """Whether ``o`` joins the matched rooms that ``q`` joins; ``ALONE`` where neither joins any."""
    matched = 0
    for e in range(home_first[q], home_first[q + 1]):
        if found[home[e]] == number:
            matched += 1
    here, astray = 0, False
    for e in range(room_first[o], room_first[o + 1]):
        a = room[rooms[e]]
        if a < 0:
            continue
        here += 1
        inside = False
        for f in range(home_first[q], home_first[q + 1]):
            inside = inside or home[f] == a
        astray = astray or not inside
    if max(here, matched) < 2:
        return ALONE
    if astray:
        return ASTRAY
    return SAME if here == matched else HALF


@kernel
def _grown(links):
    size = len(links.item)
    item, gain = np.empty(2 * size, dtype=np.int64), np.empty(2 * size)
    for e in range(size):
        item[e] = links.item[e]
        gain[e] = links.gain[e]
    return Links(
        links.first, item, gain, links.second, links.claim, links.owner, links.best, links.via
    )


@kernel
def _nearness(bell, sharpness, disc, radius, x, y):
    """Ln of the density of an object's place against anywhere in the clutter area."""
    square = x * x + y * y
    density = bell * math.exp(-square * sharpness)
    if square <= radius * radius:
        density += disc
    return math.log(density) if density > 0.0 else -np.inf


@kernel
def _on_one_wall(row_first, rows, plane_first, plane, prior_plane, row, o, q):
    """Whether a plane of ``o`` corresponds to one of ``q``."""
    for e in range(row_first[o], row_first[o + 1]):
        j = row[rows[e]]
        if j < 0:
            continue
        for f in range(plane_first[q], plane_first[q + 1]):
            if plane[f] == prior_plane[j]:
                return True
    return False


@kernel
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
            links.best[o] = -np.inf
        links.best[start] = 0.0
        links.via[start] = -1
        gain, end, free = 0.0, start, -1
        changed = True
        while changed:
            changed = False
            for o in range(start + 1):
                reach = links.best[o]
                if reach == -np.inf:
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


@kernel
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


@kernel
def _missed(planned, rates, room, owner, counted, token):
    """What the prior objects without a sight cost, room by room; each room perhaps seen in part.

    An object of two matched rooms is counted in the first.
    """
    total = 0.0
    for r in range(len(room)):
        if room[r] < 0:
            continue
        whole, half, seen, hits = 0.0, 0.0, 0.0, 0
        for f in range(planned.room_first[room[r]], planned.room_first[room[r] + 1]):
            q = planned.item[f]
            if counted[q] == token:
                continue
            counted[q] = token
            c = planned.category[q]
            if owner[q] >= 0:
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
