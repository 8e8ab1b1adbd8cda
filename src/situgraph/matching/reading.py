"""Scene graphs as tables: rooms of plan lines, as section 1 of ``docs/matching.md`` has them."""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math
from itertools import accumulate, pairwise
from typing import Annotated, Any, NamedTuple, cast

import numpy as np

from situgraph.errors import InputError
from situgraph.matching.blocks import Block
from situgraph.matching.compiled import entry, part
from situgraph.matching.config import MatchingConfig
from situgraph.matching.plain import square
from situgraph.matching.records import record_at
from situgraph.matching.tables import Floats, Ints, Limits, Seen, Table
from situgraph.matching.ties import cross, ties
from situgraph.scenegraph.graph import SceneGraph


def limits_of(config: MatchingConfig, sigma: float) -> Limits:
    """The constants of the search; ``sigma`` (m) is the standard deviation of offsets."""
    peak = (1 - config.p_moved - config.p_missing) * config.clutter_length
    together = config.p_together * 2 * config.moved_limit / config.p_moved
    values: dict[str, Any] = {
        "fit": config.plane_offset_tolerance,
        "moved": config.moved_limit,
        "angle": config.angle_tolerance,
        "sine": config.parallel_sine,
        "fit_peak": math.log(peak / (math.sqrt(2 * math.pi) * sigma)),
        "moved_base": math.log(config.p_moved * config.clutter_length / (2 * config.moved_limit)),
        "together": together / (2 * math.sqrt(math.pi) * sigma),
        "alone": 1 - config.p_together,
        "apart_weight": 1 / (4 * sigma**2),
        "thickness": config.wall_thickness,
        "missing": math.log(config.p_missing),
        "missing_shared": math.log(config.p_missing_shared),
        "room_true": math.log(1 - config.p_false_room),
        "room_false": math.log(config.p_false_room),
        "other_room": config.p_other_room,
        "shape_gain": config.shape_gain,
        "plane_weight": 1 / (2 * sigma**2),
        "angle_weight": 1 / (2 * config.angle_sigma**2),
        "same_distance": config.same_distance,
        "same_yaw": config.same_yaw,
        "smallest_step": config.smallest_step,
        "peak_step": config.peak_step,
        "max_boxes": config.max_boxes,
        "max_work": config.max_work,
    }
    return Limits(**values, slots=Block(Limits, {}, **values))


class Constants:
    """The constants of searches in maps of any spread, made when they are first asked for."""

    def __init__(self, config: MatchingConfig) -> None:
        """By these settings."""
        self._config = config
        self._limits: dict[float, Limits] = {}

    def limits(self, sigma: float) -> Limits:
        """Those of this standard deviation of offsets (m)."""
        found = self._limits.get(sigma)
        if found is None:
            found = self._limits[sigma] = limits_of(self._config, sigma)
        return found


class Rooms(NamedTuple):
    """The rooms of a graph that count, those of two usable planes, as arrays."""

    center: Floats  # (N, 3)
    equation: Floats  # (p, 4) normal and offset of each plane of the graph
    kept: Ints  # (N,) which rooms of the graph they are
    first: Ints  # (N + 1,) the rows of each
    source: Ints  # (P,) the plane of each row

    @property
    def room(self) -> Ints:
        """The room of each row (P,)."""
        return np.repeat(np.arange(len(self.kept)), np.diff(self.first))


def read_rooms(graph: SceneGraph, tilt: float) -> Rooms:
    """The rooms that count; a plane is usable when its normal is as near to horizontal as ``tilt``.

    Raises:
        InputError: a room names a plane that is not there.
    """
    row = {p.id: k for k, p in enumerate(graph.planes)}
    try:
        named = [[row[p] for p in r.planes] for r in graph.rooms]
    except KeyError as error:
        problem = f"a room names the plane {error.args[0]!r}, which is not there"
        raise InputError(graph.name or "scene graph", problem, "add the plane") from error
    steepest = math.sin(tilt) + 1e-12
    steep = {k for k, p in enumerate(graph.planes) if abs(p.normal[2]) > steepest}
    if steep:
        named = [[k for k in planes if k not in steep] for planes in named]
    kept = [r for r, planes in enumerate(named) if len(planes) > 1]
    rows = [named[r] for r in kept]
    numbers: list[float] = []
    for p in graph.planes:
        numbers += p.normal
        numbers.append(p.offset)
    return Rooms(
        np.array([x for r in kept for x in graph.rooms[r].center], dtype=np.float64).reshape(-1, 3),
        np.fromiter(numbers, dtype=np.float64).reshape(-1, 4),
        np.array(kept, dtype=np.int64),
        np.array([0, *accumulate(map(len, rows))], dtype=np.int64),
        np.array([k for planes in rows for k in planes], dtype=np.int64),
    )


def plan_lines(rooms: Rooms) -> tuple[Floats, Floats]:
    """Each row as a line in the plan: its normal (P, 2), its distance of the room's centre (P,)."""
    plane, center = rooms.equation[rooms.source], rooms.center[rooms.room]
    flat = np.hypot(plane[:, 0], plane[:, 1])
    reach = np.einsum("ij,ij->i", plane[:, :3], center) + plane[:, 3]
    return plane[:, :2] / flat[:, None], reach / flat


def storey_heights(graph: SceneGraph) -> list[float]:
    """The elevation of each room's storey (R,)."""
    elevation = {s.id: s.elevation for s in graph.storeys}
    return [elevation.get(r.storey, 0.0) if r.storey else 0.0 for r in graph.rooms]


class Drafting(NamedTuple):
    """The rooms of an online graph, and the tables to be made of them and of their mirror image."""

    seen: Seen
    image: Seen
    limits: Limits
    room: Table  # (N, 3) centres
    equation: Table
    begin: Ints  # (N + 1,) ``Rooms.first``
    source: Ints
    level: Ints  # (N,) storeys
    normal: Annotated[Floats, "P", 2]  # in the plan
    number: Annotated[Ints, "all planes"]
    share: Annotated[Floats, "planes"]
    tie: Annotated[Ints, "P"]
    middle: Annotated[Floats, 2, 2]
    spread: Annotated[Floats, 1]  # rms distance of the centres from their mean


def seen_tables(rooms: Rooms, storeys: Ints, limits: Limits) -> tuple[Seen, Seen, Floats, float]:
    """The online rooms as the search wants them, and their mirror image (x to -x).

    And the means of their centres (2, 2), and their rms distance from it; ``storeys`` (N,) of the
    rooms.
    """
    first = rooms.first.tolist()
    counts = [end - begin for begin, end in pairwise(first)]
    planes = len(set(rooms.source.tolist()))
    sizes = {
        "N": len(counts),
        "N + 1": len(first),
        "P": first[-1],
        "planes": planes,
        "crossings": sum(n * (n - 1) // 2 for n in counts),
        "probes": 3 * len(counts),
        "all planes": len(rooms.equation),
    }
    block = Block(
        Drafting,
        sizes,
        limits=limits.slots,
        room=rooms.center,
        equation=rooms.equation,
        begin=rooms.first,
        source=rooms.source,
        level=storeys,
        planes=planes,
        widest=max(counts, default=1),
    )
    draw_seen(block.place)
    seen, image = (cast(Seen, block.record(name)) for name in ("seen", "image"))
    return seen, image, block.array("middle"), float(block.array("spread")[0])


@entry
def draw_seen(place):
    """Fill the tables of a ``Drafting``."""
    _draw_both(record_at(place, Drafting))


@part
def _draw_both(t):
    _number(t)
    _draw_seen(t, t.seen, 1.0, t.middle[0])
    t.seen.tied[0] = ties(t)
    t.spread[0] = _spread(t.seen)
    _draw_seen(t, t.image, -1.0, t.middle[1])


@part
def _draw_seen(t, seen, side, middle):
    rooms = len(seen.storey)
    for k in range(rooms):
        middle[0] += side * t.room[k, 0] / rooms
        middle[1] += t.room[k, 1] / rooms
    for k in range(rooms):
        seen.center[k, 0] = side * t.room[k, 0] - middle[0]
        seen.center[k, 1] = t.room[k, 1] - middle[1]
        seen.storey[k] = t.level[k]
        seen.first[k + 1] = t.begin[k + 1]
        for i in range(t.begin[k], t.begin[k + 1]):
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
    plane, center = t.equation[t.source[i]], t.room[k]
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
