"""The tables of an online graph and of its mirror image, drawn in one piece of memory."""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math
from itertools import accumulate
from typing import Annotated, Any, NamedTuple

from situgraph.matching.blocks import Block
from situgraph.matching.compiled import entry, part
from situgraph.matching.plain import square
from situgraph.matching.reading import Listed
from situgraph.matching.records import record_at
from situgraph.matching.semantics import ListedObjects
from situgraph.matching.sightings import Rates, Sighted
from situgraph.matching.tables import Floats, Ints, Limits, Seen
from situgraph.matching.ties import cross, ties
from situgraph.matching.wall_errors import most_shared
from situgraph.scenegraph.graph import SceneGraph

LEAST_LOSS = 1e-9  # of a room, above zero


class Drafting(NamedTuple):
    """What is read of an online graph, and the tables that are drawn of it."""

    sighted: Sighted
    seen: Seen
    image: Seen
    limits: Limits
    rates: Rates  # where objects are listed
    normal: Annotated[Floats, "P", 2]  # in the plan
    number: Annotated[Ints, "all planes"]
    share: Annotated[Floats, "planes"]
    tie: Annotated[Ints, "P"]
    middle: Annotated[Floats, 2, 2]
    spread: Annotated[Floats, 1]  # rms distance of the centres from their mean
    loss: Annotated[Floats, "N"]  # what each room takes from the largest L (``bound``)
    ranked: Annotated[Floats, "N"]  # in order
    wall: Annotated[Ints, "objects"]  # of each the first on its wall
    size: Annotated[Floats, "objects"]  # how many are on that
    hanger: Annotated[Ints, "P"]  # the first object on each row, -1 for none
    rows: Annotated[Ints, "all planes"]  # where those of each plane end in
    ordered: Annotated[Ints, "P"]  # rows by plane
    # What is read, from here on, all numbers of a kind one after the other.
    center: Annotated[Floats, "N", 3]
    equation: Annotated[Floats, "all planes", 4]
    spot: Annotated[Floats, "objects", 3]
    kept: Annotated[Ints, "N"]
    first: Annotated[Ints, "N + 1"]
    source: Annotated[Ints, "P"]
    level: Annotated[Ints, "N"]  # storeys
    entry: Annotated[Ints, "objects", 4]
    home: Annotated[Ints, "homes"]
    hanging: Annotated[Ints, "hangings"]


def drafted(
    online: SceneGraph,
    listed: Listed,
    levels: list[int],
    objects: ListedObjects,
    limits: Limits,
    rates: Rates | None,
) -> tuple[Block, dict[str, int]]:
    """A ``Drafting`` of the listed rooms, which are on these storeys, and objects; not bounded.

    And its sizes.
    """
    counts, source, rows = [*map(len, listed.planes)], [], [0] * len(listed.row)
    for planes in listed.planes:
        source += planes
    for plane in source:
        rows[plane] += 1
    known, widest = len(rows) - rows.count(0), max(counts, default=1)
    sizes = {
        "N": len(counts),
        "N + 1": len(counts) + 1,
        "P": len(source),
        "planes": known,
        "n": widest,
        "n + 1": widest + 1,
        "crossings": sum([n * (n - 1) // 2 for n in counts]),
        "probes": 3 * len(counts),
        "all planes": len(rows),
        "objects": len(objects.ids),
        "objects + 1": len(objects.ids) + 1,
        "homes": len(objects.room),
        "hangings": len(objects.plane),
        "hung rows": sum([rows[plane] for plane in objects.plane]),
    }
    given: dict[str, Any] = {"limits": limits.slots, "rates": rates.slots if rates else None}
    block = Block(Drafting, sizes, planes=known, widest=widest, **given)
    center: list[float] = []
    for room in listed.kept:
        center += online.rooms[room].center
    block.write("center", center + listed.equation + objects.spot, "d")
    rooms = [*listed.kept, *accumulate(counts, initial=0), *source, *levels]
    block.write("kept", rooms + objects.entry + objects.room + objects.plane, "q")
    draw(block.place)
    return block, sizes


@entry
def draw(place):
    """Fill the tables of a ``Drafting``."""
    _draw_all(record_at(place, Drafting))


@entry
def bound(place, constants, least):
    """Fill the bounds of a ``Drafting``, by the ``Limits`` at this address.

    Returns an upper bound on L, and how many rooms may be unexplained where L reaches ``least``.
    """
    t = record_at(place, Drafting)
    most = _bound(t, record_at(constants, Limits))
    return most, _spare(t, most - least)


@part
def _draw_all(t):
    _number(t)
    _draw_seen(t, t.seen, 1.0, t.middle[0])
    t.seen.tied[0] = t.image.tied[0] = ties(t)
    t.spread[0] = _spread(t.seen)
    _draw_seen(t, t.image, -1.0, t.middle[1])
    _draw_sighted(t, t.sighted, t.middle[0])


@part
def _draw_seen(t, seen, side, middle):
    rooms = len(seen.storey)
    for k in range(rooms):
        middle[0] += side * t.center[k, 0] / rooms
        middle[1] += t.center[k, 1] / rooms
    for k in range(rooms):
        seen.center[k, 0] = side * t.center[k, 0] - middle[0]
        seen.center[k, 1] = t.center[k, 1] - middle[1]
        seen.storey[k] = t.level[k]
        seen.first[k + 1] = t.first[k + 1]
        for i in range(t.first[k], t.first[k + 1]):
            _line(t, seen, side, k, i)
    probes = 0
    for r in range(rooms):
        found = _probes(t, seen, r, probes)
        seen.flat[r] = 1 if found == 0 else 0
        strict = found == 0 or seen.first[r + 1] - seen.first[r] == 2
        seen.strict[r] = 1 if strict else 0
        for k in range(probes, probes + found):
            _place_probe(t, seen, r, k)
        probes += found
        seen.probe_first[r + 1] = probes
        square(seen, r, t.limits.angle / 2, t.limits.angle, seen.plain[r])
    _shape(t, seen)
    _crossings(t, seen)


@part
def _spread(seen):
    """The rms distance of the rooms' centres from their mean."""
    total, rooms = 0.0, len(seen.storey)
    for k in range(rooms):
        total += seen.center[k, 0] ** 2 + seen.center[k, 1] ** 2
    return math.sqrt(total / max(rooms, 1))


@part
def _line(t, seen, side, k, i):
    """Row ``i``, of room ``k``."""
    plane, center = t.equation[t.source[i]], t.center[k]
    flat = math.sqrt(plane[0] * plane[0] + plane[1] * plane[1])
    reach = plane[0] * center[0] + plane[1] * center[1] + plane[2] * center[2] + plane[3]
    t.normal[i, 0] = side * plane[0] / flat
    t.normal[i, 1] = plane[1] / flat
    seen.angle[i] = math.atan2(plane[1], side * plane[0])
    seen.distance[i] = reach / flat
    seen.plane[i] = t.number[t.source[i]] - 1


@part
def _place_probe(t, seen, r, k):
    i, j, arm = seen.probe[k, 0], seen.probe[k, 1], seen.probe_arm[k]
    _meeting(t, seen, i, j, arm)
    length = math.sqrt(arm[0] * arm[0] + arm[1] * arm[1])
    arm[0] += seen.center[r, 0]
    arm[1] += seen.center[r, 1]
    seen.probe_reach[k] = _reach(seen.angle[j] - seen.angle[i], length, t.limits)


@part
def _number(t):
    """Distinct planes numbered in the order they are met, from 1 on; and how many rows each is."""
    number, count = t.number, 0
    for k in range(len(t.source)):
        p = t.source[k]
        if number[p] == 0:
            count += 1
            number[p] = count
        t.share[number[p] - 1] += 1.0


@part
def _shape(t, seen):
    """Planes of each room but for two, four at most; a plane of k rooms counts 1 / k.

    And how many are in no other room.
    """
    for r in range(len(seen.shape)):
        for i in range(seen.first[r], seen.first[r + 1]):
            seen.own[r] += t.share[seen.plane[i]] == 1.0
        if seen.first[r + 1] - seen.first[r] > 2:
            total = 0.0
            for i in range(seen.first[r], seen.first[r + 1]):
                total += 1.0 / t.share[seen.plane[i]]
            seen.shape[r] = max(0.0, min(4.0, total) - 2.0)


@part
def _crossings(t, seen):
    """All pairs of planes of one room that are not parallel, the first one first."""
    count = 0
    for r in range(len(seen.storey)):
        for i in range(seen.first[r], seen.first[r + 1]):
            for j in range(i + 1, seen.first[r + 1]):
                if abs(cross(t.normal, i, j)) >= t.limits.sine:
                    seen.crossed[count, 0] = i
                    seen.crossed[count, 1] = j
                    count += 1
        seen.crossed_first[r + 1] = count


@part
def _meeting(t, seen, i, j, out):
    """Where rows ``i`` and ``j`` meet, from the room's centre."""
    normal, distance, turn = t.normal, seen.distance, cross(t.normal, i, j)
    out[0] = -(distance[i] * normal[j, 1] - distance[j] * normal[i, 1]) / turn
    out[1] = -(distance[j] * normal[i, 0] - distance[i] * normal[j, 0]) / turn


@part
def _reach(turn, length, limits):
    """How far the plan's corner may lie from the placed one, for any residuals that are allowed.

    Along either normal it is off by the residual (at most ``moved``) and by what the tolerance on
    the direction does at the distance of the centre; the two make a parallelogram.
    """
    off = limits.moved + limits.angle * length + 1e-6
    narrowest = 1.0
    for k in range(-1, 2):
        half = turn / 2 + k * limits.angle
        narrowest = min(narrowest, abs(math.sin(half)), abs(math.cos(half)))
    return off / max(narrowest, 0.02)


@part
def _probes(t, seen, r, at):
    """Corners such that, whatever single plane is missing, one of them is whole; their number.

    They go to ``seen.probe`` from row ``at`` on. None when all planes are parallel. A plane that is
    in every corner cannot be missing: then no two planes that fit would be left that are not
    parallel.
    """
    begin, end = seen.first[r], seen.first[r + 1]
    count = 0
    lost_i, lost_j = -1, -1
    for attempt in range(3):
        best, bi, bj = 0.0, -1, -1
        for i in range(begin, end):
            for j in range(begin, end):
                turn = cross(t.normal, i, j)
                if turn < t.limits.sine:
                    continue
                if attempt == 1 and (i == lost_i or j == lost_i):
                    continue
                if attempt == 2 and (i == lost_j or j == lost_j):
                    continue
                other = lost_j if attempt == 1 else lost_i
                bonus = 10.0 if attempt == 1 and i != other and j != other else 0.0
                value = bonus + turn - 0.02 * (abs(seen.distance[i]) + abs(seen.distance[j]))
                if bi < 0 or value > best:
                    best, bi, bj = value, i, j
        if bi < 0:
            if attempt == 0:
                return 0
            continue
        seen.probe[at + count, 0] = bi
        seen.probe[at + count, 1] = bj
        count += 1
        if attempt == 0:
            lost_i, lost_j = bi, bj
        elif attempt == 1 and lost_j != bi and lost_j != bj:
            return count
    return count


@part
def _draw_sighted(t, sighted, middle):
    """The objects about the mean of the centres, and the rows of the planes they are on."""
    _order_rows(t)
    rooms = planes = count = 0
    for o in range(len(sighted.category)):
        sighted.place[o, 0] = t.spot[o, 0] - middle[0]
        sighted.place[o, 1] = t.spot[o, 1] - middle[1]
        sighted.category[o], sighted.hung[o] = t.entry[o, 0], t.entry[o, 1]
        for k in range(rooms, t.entry[o, 2]):
            sighted.room[k] = t.home[k]
        for k in range(planes, t.entry[o, 3]):
            plane = t.hanging[k]
            for e in range(t.rows[plane - 1] if plane > 0 else 0, t.rows[plane]):
                sighted.row[count] = t.ordered[e]
                count += 1
        rooms, planes = t.entry[o, 2], t.entry[o, 3]
        sighted.room_first[o + 1], sighted.row_first[o + 1] = rooms, count


@part
def _order_rows(t):
    """Rows by plane; ``t.rows`` is where those of each end."""
    for i in range(len(t.source)):
        t.rows[t.source[i]] += 1
    begin = 0
    for plane in range(len(t.rows)):
        begin += t.rows[plane]
        t.rows[plane] = begin - t.rows[plane]
    for i in range(len(t.source)):
        t.ordered[t.rows[t.source[i]]] = i
        t.rows[t.source[i]] += 1


@part
def _bound(t, limits):
    """An upper bound on L; and what each room at least takes from it when it is not explained.

    The latter is what its walls have which no other room shares (planes that others share may still
    fit in those), and its objects that are in no other room. It may be one like those of the plan.
    """
    seen, sighted = t.seen, t.sighted
    rooms = len(seen.storey)
    most = seen.planes * limits.fit_peak + rooms * max(limits.room_true, limits.room_false)
    for r in range(rooms):
        t.loss[r] = max(limits.room_true - limits.room_false, 0.0) + seen.own[r] * limits.fit_peak
        if seen.shape[r] > 0:
            t.loss[r] -= math.log1p(limits.other_room * limits.shape_gain ** seen.shape[r])
    if len(sighted.category) > 0:
        most += most_shared(t)
    for o in range(len(sighted.category)):
        value = t.rates.most[sighted.category[o]]
        most += value
        begin = sighted.room_first[o]
        if sighted.room_first[o + 1] == begin + 1:  # what is in several may be told in any
            t.loss[sighted.room[begin]] += value
    for r in range(rooms):
        most -= min(t.loss[r], 0.0)
        t.loss[r] = max(t.loss[r], LEAST_LOSS)
    return most


@part
def _spare(t, budget):
    """How many rooms may be unexplained; and cut to the median what each loses then.

    Rooms that lose more than most are not told apart, so that groups can be formed of any.
    """
    ranked, rooms = t.ranked, len(t.loss)
    for r in range(rooms):
        k = r
        while k > 0 and ranked[k - 1] > t.loss[r]:
            ranked[k] = ranked[k - 1]
            k -= 1
        ranked[k] = t.loss[r]
    spared, lost = 0, 0.0
    for r in range(rooms):
        lost += ranked[r]
        spared += lost <= budget
    median = (ranked[(rooms - 1) // 2] + ranked[rooms // 2]) / 2
    for r in range(rooms):
        t.loss[r] = min(t.loss[r], median)
    return spared
