"""Scene graphs as tables: rooms of plan lines, as section 1 of ``docs/matching.md`` has them."""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math

import numpy as np

from situgraph.errors import InputError
from situgraph.matching.compiled import entry, kernel
from situgraph.matching.config import MatchingConfig
from situgraph.matching.tables import Floats, Ints, Limits, Seen
from situgraph.scenegraph.graph import SceneGraph


def limits_of(config: MatchingConfig) -> Limits:
    """The constants of the search."""
    peak = (1 - config.p_moved - config.p_missing) * config.clutter_length
    return Limits(
        fit=config.plane_offset_tolerance,
        moved=config.moved_limit,
        angle=config.angle_tolerance,
        sine=config.parallel_sine,
        fit_peak=math.log(peak / (math.sqrt(2 * math.pi) * config.plane_sigma)),
        moved_base=math.log(config.p_moved * config.clutter_length / (2 * config.moved_limit)),
        missing=math.log(config.p_missing),
        missing_shared=math.log(config.p_missing_shared),
        room_true=math.log(1 - config.p_false_room),
        room_false=math.log(config.p_false_room),
        plane_weight=1 / (2 * config.plane_sigma**2),
        angle_weight=1 / (2 * config.angle_sigma**2),
        same_distance=config.same_distance,
        same_yaw=config.same_yaw,
        smallest_step=config.smallest_step,
        peak_step=config.peak_step,
        max_boxes=config.max_boxes,
    )


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
    planes = np.array([(*p.normal, p.offset) for p in graph.planes], dtype=np.float64).reshape(
        -1, 4
    )
    counts = np.array([len(r.planes) for r in graph.rooms], dtype=np.int64)
    return centers, planes, np.array(names, dtype=np.int64), counts


def storey_heights(graph: SceneGraph) -> Floats:
    """The elevation of each room's storey (R,)."""
    elevation = {s.id: s.elevation for s in graph.storeys}
    return np.array([elevation.get(r.storey, 0.0) if r.storey else 0.0 for r in graph.rooms])


@entry
def plan_lines(centers, planes, names, counts, tilt):
    """Rooms with two usable planes as lines in the plan.

    Returns which rooms count, ``first``, and for each room's usable planes the normal (Q, 2), the
    signed distance of the room's centre (Q,), the row in ``planes`` (Q,).
    """
    kept = np.empty(len(counts), dtype=np.int64)
    first = np.zeros(len(counts) + 1, dtype=np.int64)
    normal = np.empty((len(names), 2))
    distance = np.empty(len(names))
    source = np.empty(len(names), dtype=np.int64)
    steepest = math.sin(tilt) + 1e-12
    rooms, rows, at = 0, 0, 0
    for r in range(len(counts)):
        begin = rows
        for k in range(at, at + counts[r]):
            p = names[k]
            if abs(planes[p, 2]) > steepest:
                continue
            flat = math.sqrt(planes[p, 0] ** 2 + planes[p, 1] ** 2)
            normal[rows, 0] = planes[p, 0] / flat
            normal[rows, 1] = planes[p, 1] / flat
            reach = planes[p, 3]
            for axis in range(3):
                reach += planes[p, axis] * centers[r, axis]
            distance[rows] = reach / flat
            source[rows] = p
            rows += 1
        at += counts[r]
        if rows - begin < 2:
            rows = begin
            continue
        kept[rooms] = r
        rooms += 1
        first[rooms] = rows
    return kept[:rooms], first[: rooms + 1], normal[:rows], distance[:rows], source[:rows]


@entry
def seen_table(centers, kept, first, normal, distance, source, storeys, limits):
    """The online rooms as the search wants them, and the mean of their centres (2,)."""
    rooms, rows = len(kept), len(distance)
    middle = np.zeros(2)
    for k in range(rooms):
        middle += centers[kept[k], :2] / rooms
    center = np.empty((rooms, 2))
    storey = np.empty(rooms, dtype=np.int64)
    for k in range(rooms):
        center[k] = centers[kept[k], :2] - middle
        storey[k] = storeys[kept[k]]
    angle = np.empty(rows)
    for k in range(rows):
        angle[k] = math.atan2(normal[k, 1], normal[k, 0])
    plane, planes = _numbered(source)
    strict, flat = np.zeros(rooms, dtype=np.bool_), np.zeros(rooms, dtype=np.bool_)
    probe_first = np.zeros(rooms + 1, dtype=np.int64)
    probe = np.empty((3 * rooms, 2), dtype=np.int64)
    probes = 0
    for r in range(rooms):
        found = _probes(angle, distance, first[r], first[r + 1], limits.sine, probe[probes:])
        flat[r] = found == 0
        strict[r] = flat[r] or first[r + 1] - first[r] == 2
        probes += found
        probe_first[r + 1] = probes
    arm, reach = np.empty((probes, 2)), np.empty(probes)
    for r in range(rooms):
        for k in range(probe_first[r], probe_first[r + 1]):
            i, j = probe[k]
            _meeting(angle, distance, i, j, arm[k])
            length = math.sqrt(arm[k, 0] ** 2 + arm[k, 1] ** 2)
            arm[k] += center[r]
            reach[k] = _reach(angle[j] - angle[i], length, limits)
    crossed_first, crossed = _crossings(first, angle, limits.sine)
    table = Seen(
        center,
        first,
        angle,
        distance,
        plane,
        planes,
        strict,
        flat,
        storey,
        _shape(first, plane, planes),
        crossed_first,
        crossed,
        probe_first,
        probe[:probes],
        arm,
        reach,
    )
    return table, middle


@kernel
def _numbered(source):
    """Distinct planes numbered in the order they are met."""
    most = 0
    for p in source:
        most = max(most, p + 1)
    number = np.full(most, -1, dtype=np.int64)
    plane = np.empty(len(source), dtype=np.int64)
    count = 0
    for k in range(len(source)):
        if number[source[k]] < 0:
            number[source[k]] = count
            count += 1
        plane[k] = number[source[k]]
    return plane, count


@kernel
def _shape(first, plane, planes):
    """Planes of each room but for two, four at most; a plane of k rooms counts 1 / k."""
    share = np.zeros(planes)
    for p in plane:
        share[p] += 1.0
    shape = np.zeros(len(first) - 1)
    for r in range(len(shape)):
        if first[r + 1] - first[r] > 2:
            for i in range(first[r], first[r + 1]):
                shape[r] += 1.0 / share[plane[i]]
            shape[r] = max(0.0, min(4.0, shape[r]) - 2.0)
    return shape


@kernel
def _crossings(first, angle, sine):
    """All pairs of planes of one room that are not parallel, the first one first."""
    most = 0
    for r in range(len(first) - 1):
        n = first[r + 1] - first[r]
        most += n * (n - 1) // 2
    pairs = np.empty((most, 2), dtype=np.int64)
    begin = np.zeros(len(first), dtype=np.int64)
    count = 0
    for r in range(len(first) - 1):
        for i in range(first[r], first[r + 1]):
            for j in range(i + 1, first[r + 1]):
                if abs(math.sin(angle[j] - angle[i])) >= sine:
                    pairs[count, 0] = i
                    pairs[count, 1] = j
                    count += 1
        begin[r + 1] = count
    return begin, pairs[:count]


@kernel
def _meeting(angle, distance, i, j, out):
    """Where planes ``i`` and ``j`` meet, from the room's centre."""
    cross = math.sin(angle[j] - angle[i])
    out[0] = -(distance[i] * math.sin(angle[j]) - distance[j] * math.sin(angle[i])) / cross
    out[1] = -(distance[j] * math.cos(angle[i]) - distance[i] * math.cos(angle[j])) / cross


@kernel
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


@kernel
def _probes(angle, distance, begin, end, sine, out):
    """Corners such that, whatever single plane is missing, one of them is whole; their number.

    None when all planes are parallel. A plane that is in every corner cannot be missing: then no
    two planes that fit would be left that are not parallel.
    """
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
        out[count, 0] = bi
        out[count, 1] = bj
        count += 1
        if attempt == 0:
            lost_i, lost_j = bi, bj
        elif attempt == 1 and lost_j not in (bi, bj):
            return count
    return count
