"""Scene graphs as tables: rooms of plan lines, as section 1 of ``docs/matching.md`` has them."""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math
from itertools import pairwise
from typing import Annotated, Any, NamedTuple

import numpy as np

from situgraph.errors import InputError
from situgraph.matching.blocks import Block
from situgraph.matching.compiled import entry, part
from situgraph.matching.config import MatchingConfig
from situgraph.matching.plain import square
from situgraph.matching.records import record_at
from situgraph.matching.tables import Floats, Ints, Limits, Seen, Table
from situgraph.scenegraph.graph import SceneGraph


def limits_of(config: MatchingConfig) -> Limits:
    """The constants of the search."""
    peak = (1 - config.p_moved - config.p_missing) * config.clutter_length
    together = config.p_together * 2 * config.moved_limit / config.p_moved
    values: dict[str, Any] = {
        "fit": config.plane_offset_tolerance,
        "moved": config.moved_limit,
        "angle": config.angle_tolerance,
        "sine": config.parallel_sine,
        "fit_peak": math.log(peak / (math.sqrt(2 * math.pi) * config.plane_sigma)),
        "moved_base": math.log(config.p_moved * config.clutter_length / (2 * config.moved_limit)),
        "together": together / (2 * math.sqrt(math.pi) * config.plane_sigma),
        "alone": 1 - config.p_together,
        "apart_weight": 1 / (4 * config.plane_sigma**2),
        "thickness": config.wall_thickness,
        "missing": math.log(config.p_missing),
        "missing_shared": math.log(config.p_missing_shared),
        "room_true": math.log(1 - config.p_false_room),
        "room_false": math.log(config.p_false_room),
        "plane_weight": 1 / (2 * config.plane_sigma**2),
        "angle_weight": 1 / (2 * config.angle_sigma**2),
        "same_distance": config.same_distance,
        "same_yaw": config.same_yaw,
        "smallest_step": config.smallest_step,
        "peak_step": config.peak_step,
        "max_boxes": config.max_boxes,
        "max_work": config.max_work,
    }
    return Limits(**values, slots=Block(Limits, {}, **values))


def raw_rooms(graph: SceneGraph) -> tuple[Floats, Floats, Ints, Ints]:
    """Room centres (R, 3), planes (P, 4), each room's plane rows, and how many each room has.

    Raises:
        InputError: a room names a plane that is not there.
    """
    row = {p.id: k for k, p in enumerate(graph.planes)}
    try:
        names = [row[p] for r in graph.rooms for p in r.planes]
    except KeyError as error:
        problem = f"a room names the plane {error.args[0]!r}, which is not there"
        raise InputError(graph.name or "scene graph", problem, "add the plane") from error
    centers = np.array([r.center for r in graph.rooms], dtype=np.float64).reshape(-1, 3)
    flat = [number for p in graph.planes for number in (*p.normal, p.offset)]
    planes = np.array(flat, dtype=np.float64).reshape(-1, 4)
    counts = np.array([len(r.planes) for r in graph.rooms], dtype=np.int64)
    return centers, planes, np.array(names, dtype=np.int64), counts


def storey_heights(graph: SceneGraph) -> Floats:
    """The elevation of each room's storey (R,)."""
    elevation = {s.id: s.elevation for s in graph.storeys}
    return np.array([elevation.get(r.storey, 0.0) if r.storey else 0.0 for r in graph.rooms])


class Reading(NamedTuple):
    """Rooms of a graph, and their lines."""

    center: Table  # (R, 3)
    planes: Table  # (P, 4)
    name: Ints  # (K,) plane rows of the rooms, one room after the other
    number: Ints  # (R,) how many each room has
    steepest: float
    kept: Annotated[Ints, "R"]
    first: Annotated[Ints, "R + 1"]
    normal: Annotated[Floats, "K", 2]
    distance: Annotated[Floats, "K"]
    source: Annotated[Ints, "K"]
    done: Annotated[Ints, 1]  # how many rooms count


class Lines(NamedTuple):
    """Rooms with two usable planes as lines in the plan."""

    center: Floats  # (R, 3) of all rooms
    kept: Ints  # (N,) the rooms that count
    first: Ints  # (N + 1,) the rows of each
    normal: Floats  # (P, 2)
    distance: Floats  # (P,) signed, of the room's centre
    source: Ints  # (P,) the plane
    block: Block  # of the ``Reading``


def plan_lines(centers: Floats, planes: Floats, names: Ints, counts: Ints, tilt: float) -> Lines:
    """The lines of the rooms that count."""
    block = Block(
        Reading,
        {"R": len(counts), "R + 1": len(counts) + 1, "K": len(names)},
        center=centers,
        planes=planes,
        name=names,
        number=counts,
        steepest=math.sin(tilt) + 1e-12,
    )
    read_lines(block.place)
    made = block.arrays()
    rooms = int(made["done"][0])
    rows = int(made["first"][rooms])
    return Lines(
        centers,
        made["kept"][:rooms],
        made["first"][: rooms + 1],
        made["normal"][:rows],
        made["distance"][:rows],
        made["source"][:rows],
        block,
    )


@entry
def read_lines(place):
    """Fill a ``Reading``."""
    _read_lines(record_at(place, Reading))


@part
def _read_lines(t):
    rooms, rows, at = 0, 0, 0
    for r in range(len(t.number)):
        begin = rows
        for k in range(at, at + t.number[r]):
            p = t.name[k]
            plane = t.planes[p]
            if abs(plane[2]) > t.steepest:
                continue
            flat = math.sqrt(plane[0] * plane[0] + plane[1] * plane[1])
            t.normal[rows, 0] = plane[0] / flat
            t.normal[rows, 1] = plane[1] / flat
            reach = plane[3]
            for axis in range(3):
                reach += plane[axis] * t.center[r, axis]
            t.distance[rows] = reach / flat
            t.source[rows] = p
            rows += 1
        at += t.number[r]
        if rows - begin < 2:
            rows = begin
            continue
        t.kept[rooms] = r
        rooms += 1
        t.first[rooms] = rows
    t.done[0] = rooms


class Drafting(NamedTuple):
    """An online graph's lines, and the table to be made of them."""

    seen: Seen
    lines: Reading
    limits: Limits
    storeys: Ints  # (R,)
    side: float  # -1 for the mirror image
    number: Annotated[Ints, "largest source + 1"]
    share: Annotated[Floats, "planes"]
    middle: Annotated[Floats, 2]


def seen_table(lines: Lines, storeys: Ints, limits: Limits, flipped: bool) -> tuple[Seen, Floats]:
    """The online rooms as the search wants them, and the mean of their centres (2,).

    ``storeys`` (R,) of all rooms; ``flipped``: of the mirror image (x to -x).
    """
    sources = lines.source.tolist()
    counts = [end - begin for begin, end in pairwise(lines.first.tolist())]
    planes, widest = len(set(sources)), max(counts, default=1)
    sizes = {
        "N": len(counts),
        "N + 1": len(counts) + 1,
        "P": len(sources),
        "planes": planes,
        "crossings": sum(n * (n - 1) // 2 for n in counts),
        "probes": 3 * len(counts),
        "largest source + 1": max(sources, default=-1) + 1,
    }
    block = Block(Seen, sizes, planes=planes, widest=widest)
    draft = Block(
        Drafting,
        sizes,
        seen=block,
        lines=lines.block,
        limits=limits.slots,
        storeys=storeys,
        side=-1.0 if flipped else 1.0,
    )
    draw_seen(draft.place)
    seen = Seen(**block.arrays(), planes=planes, widest=widest, slots=block)
    return seen, draft.array("middle")


@entry
def draw_seen(place):
    """Fill the table of a ``Drafting``."""
    _draw_seen(record_at(place, Drafting))


@part
def _draw_seen(t):
    seen, lines, middle = t.seen, t.lines, t.middle
    rooms = len(seen.storey)
    for k in range(rooms):
        center = lines.center[lines.kept[k]]
        middle[0] += t.side * center[0] / rooms
        middle[1] += center[1] / rooms
    for k in range(rooms):
        center = lines.center[lines.kept[k]]
        seen.center[k, 0] = t.side * center[0] - middle[0]
        seen.center[k, 1] = center[1] - middle[1]
        seen.storey[k] = t.storeys[lines.kept[k]]
        seen.first[k + 1] = lines.first[k + 1]
    for k in range(len(seen.angle)):
        seen.angle[k] = math.atan2(lines.normal[k, 1], t.side * lines.normal[k, 0])
        seen.distance[k] = lines.distance[k]
    _number(t)
    probes = 0
    for r in range(rooms):
        found = _probes(seen, r, t.limits.sine, probes)
        seen.flat[r] = 1 if found == 0 else 0
        strict = found == 0 or seen.first[r + 1] - seen.first[r] == 2
        seen.strict[r] = 1 if strict else 0
        for k in range(probes, probes + found):
            _place_probe(t, r, k)
        probes += found
        seen.probe_first[r + 1] = probes
        square(seen, r, t.limits.angle / 2, t.limits.angle, seen.plain[r])
    _shape(t)
    _crossings(t)


@part
def _place_probe(t, r, k):
    seen = t.seen
    i, j, arm = seen.probe[k, 0], seen.probe[k, 1], seen.probe_arm[k]
    _meeting(seen.angle, seen.distance, i, j, arm)
    length = math.sqrt(arm[0] * arm[0] + arm[1] * arm[1])
    arm[0] += seen.center[r, 0]
    arm[1] += seen.center[r, 1]
    seen.probe_reach[k] = _reach(seen.angle[j] - seen.angle[i], length, t.limits)


@part
def _number(t):
    """Distinct planes numbered in the order they are met."""
    number, count = t.number, 0
    for k in range(len(t.seen.plane)):
        p = t.lines.source[k]
        if number[p] == 0:
            count += 1
            number[p] = count
        t.seen.plane[k] = number[p] - 1


@part
def _shape(t):
    """Planes of each room but for two, four at most; a plane of k rooms counts 1 / k.

    And how many are in no other room.
    """
    seen = t.seen
    for k in range(len(seen.plane)):
        t.share[seen.plane[k]] += 1.0
    for r in range(len(seen.shape)):
        for i in range(seen.first[r], seen.first[r + 1]):
            seen.own[r] += t.share[seen.plane[i]] == 1.0
        if seen.first[r + 1] - seen.first[r] > 2:
            total = 0.0
            for i in range(seen.first[r], seen.first[r + 1]):
                total += 1.0 / t.share[seen.plane[i]]
            seen.shape[r] = max(0.0, min(4.0, total) - 2.0)


@part
def _crossings(t):
    """All pairs of planes of one room that are not parallel, the first one first."""
    seen, count = t.seen, 0
    for r in range(len(seen.storey)):
        for i in range(seen.first[r], seen.first[r + 1]):
            for j in range(i + 1, seen.first[r + 1]):
                if abs(math.sin(seen.angle[j] - seen.angle[i])) >= t.limits.sine:
                    seen.crossed[count, 0] = i
                    seen.crossed[count, 1] = j
                    count += 1
        seen.crossed_first[r + 1] = count


@part
def _meeting(angle, distance, i, j, out):
    """Where planes ``i`` and ``j`` meet, from the room's centre."""
    cross = math.sin(angle[j] - angle[i])
    out[0] = -(distance[i] * math.sin(angle[j]) - distance[j] * math.sin(angle[i])) / cross
    out[1] = -(distance[j] * math.cos(angle[i]) - distance[i] * math.cos(angle[j])) / cross


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
def _probes(seen, r, sine, at):
    """Corners such that, whatever single plane is missing, one of them is whole; their number.

    They go to ``seen.probe`` from row ``at`` on. None when all planes are parallel. A plane that is
    in every corner cannot be missing: then no two planes that fit would be left that are not
    parallel.
    """
    angle, distance, begin, end = seen.angle, seen.distance, seen.first[r], seen.first[r + 1]
    count = 0
    lost_i, lost_j = -1, -1
    for attempt in range(3):
        best, bi, bj = 0.0, -1, -1
        for i in range(begin, end):
            for j in range(begin, end):
                cross = math.sin(angle[j] - angle[i])
                if cross < sine:
                    continue
                if attempt == 1 and (i == lost_i or j == lost_i):
                    continue
                if attempt == 2 and (i == lost_j or j == lost_j):
                    continue
                other = lost_j if attempt == 1 else lost_i
                bonus = 10.0 if attempt == 1 and i != other and j != other else 0.0
                value = bonus + cross - 0.02 * (abs(distance[i]) + abs(distance[j]))
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
