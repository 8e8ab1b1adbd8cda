"""What one placement explains, and its log likelihood ratio.

Sections 2 and 4 of ``docs/matching.md``.
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math

from situgraph.matching.compiled import part
from situgraph.matching.containment import room_allowed
from situgraph.matching.explained import explain
from situgraph.matching.homes import explain_plain
from situgraph.matching.lookup import Reach, find
from situgraph.matching.pairing import add_option, astray, contested, pair_up
from situgraph.matching.slack import Slack, residuals
from situgraph.matching.steady import is_steady, keep_steady, recall_steady
from situgraph.matching.tables import FIT, MISSING, MOVED, WORK

PARALLEL = 0.01  # sine of the angle between the planned faces of one wall, at most
LOOK = 8  # comparisons of planes that a look at a room is worth, about


@part
def look(case, spot, yaw, x, y, turn, loose):
    """Fill ``spot`` with what is explained when the mean room centre goes to ``(x, y)``.

    ``storeys[u]`` is the prior storey of online storey ``u``, -1 for none. ``turn`` and
    ``loose`` widen the residuals by radians and metres (0: strictly the definition). Returns how
    many rooms are explained.
    """
    at, slack = _reach(yaw, x, y, turn, loose)
    _gather(case, spot, at, slack, False, False)
    return _pair(case, spot, at, slack)


@part
def look_near(case, spot, yaw, x, y, keeps):
    """``look`` strictly, where rooms may be ``steady`` from earlier looks near by.

    Where it ``keeps`` what it finds, looks near here will be made.
    """
    at, slack = _reach(yaw, x, y, 0.0, 0.0)
    recalled = _gather(case, spot, at, slack, True, keeps)
    if recalled > 0 and contested(case):  # the scores decide, which are not kept
        _gather(case, spot, at, slack, False, False)
    return _pair(case, spot, at, slack)


@part
def _reach(yaw, x, y, turn, loose):
    """A placement as it is looked up, and by how much residuals are widened."""
    slack = Slack(turn, 1.0, 0.0, loose, loose, 0.0, 0.0, 0.0, 0.0)
    c, s = math.cos(yaw), math.sin(yaw)
    return Reach(yaw, turn, c, s, 0.0, 0.0, 0.0, 0.0, 0.0, x, y, 1.5 * loose), slack


@part
def look_whole(case, spot, yaw, x, y):
    """``look_near`` where all walls of all rooms that are explained fit; 0 elsewhere.

    Also where more rooms are unexplained than may be. ``spot`` is unfinished then.
    """
    at, slack = _reach(yaw, x, y, 0.0, 0.0)
    lost, recalled = 0.0, 0
    for r in range(len(case.seen.storey)):
        recalled += _gather_room(case, spot, r, at, slack, True, False)
        if case.options.count[r] == 0:
            lost += case.task.loss[r]
            if lost > case.task.budget:
                return 0
        else:
            for i in range(case.seen.first[r], case.seen.first[r + 1]):
                if spot.state[i] != FIT:
                    return 0
    if recalled > 0 and contested(case):
        _gather(case, spot, at, slack, False, False)
    return _pair(case, spot, at, slack)


@part
def nearly_explained(case, spot, r, place, loose):
    """The prior room that explains ``r`` when residuals are widened by so many metres, or -1.

    How it does, at this place (yaw, x, y), goes into ``spot``.
    """
    at, slack = _reach(place[0], place[1], place[2], 0.0, loose)
    _gather_room(case, spot, r, at, slack, False, False)
    return case.options.room[r, 0] if case.options.count[r] > 0 else -1


@part
def _gather(case, spot, at, slack, recalls, keeps):
    """The options of all rooms, and the planes of their first ones; returns how many are steady."""
    recalled = 0
    for r in range(len(case.seen.storey)):
        recalled += _gather_room(case, spot, r, at, slack, recalls, keeps)
    return recalled


@part
def _gather_room(case, spot, r, at, slack, recalls, keeps):
    """The same of one room; returns whether it is steady."""
    seen, finder, options, yaw = case.seen, case.finder, case.options, at.yaw
    storey = case.task.storeys[seen.storey[r]]
    options.count[r] = 0
    case.found.count[WORK] += LOOK
    if storey < 0:
        return False
    cx, cy = seen.center[r, 0], seen.center[r, 1]
    rx, ry = at.px + at.cos * cx - at.sin * cy, at.py + at.sin * cx + at.cos * cy
    if recalls and is_steady(case, r, storey, yaw, rx, ry):
        recall_steady(case, spot, r)
        _measure(case, spot, r, yaw, rx, ry)
        return True
    found, strict = find(case, r, storey, at, True), at.turn == 0.0 and at.spread == 0.0
    plain = strict and found == 1
    if not plain or not explain_plain(case, spot, r, finder.room[0], yaw, rx, ry):
        _choose(case, spot, r, found, yaw, rx, ry, slack)
    if keeps:
        keep_steady(case, spot, r, storey, yaw, rx, ry)
    return False


@part
def _choose(case, spot, r, found, yaw, x, y, slack):
    """The options of room ``r``, at ``(x, y)``, of so many in ``finder.room``."""
    options = case.options
    for k in range(found):
        a = case.finder.room[k]
        if room_allowed(case, r, a):
            score = explain(case, r, a, yaw, x, y, slack)
            if score > -math.inf:
                add_option(case, r, a, score - astray(case, a, x, y))
                if options.room[r, 0] == a:
                    _note(case, spot, r)
    if options.count[r] > 0:
        _measure(case, spot, r, yaw, x, y)


@part
def _pair(case, spot, at, slack):
    """Give each room one of its options; returns how many have one."""
    view, seen, options = spot, case.seen, case.options
    yaw, c, s, x, y = at.yaw, at.cos, at.sin, at.px, at.py
    count = pair_up(case, view.room)
    for r in range(len(seen.storey)):
        a = view.room[r]
        if a < 0:
            for i in range(seen.first[r], seen.first[r + 1]):
                view.state[i] = -1
                view.row[i] = -1
        elif a != options.room[r, 0]:
            cx, cy = seen.center[r, 0], seen.center[r, 1]
            rx, ry = x + c * cx - s * cy, y + s * cx + c * cy
            explain(case, r, a, yaw, rx, ry, slack)
            _note(case, spot, r)
            _measure(case, spot, r, yaw, rx, ry)
    return count


@part
def _note(case, spot, r):
    """Note how room ``r`` has been explained."""
    view = spot
    seen, bench = case.seen, case.bench
    begin = seen.first[r]
    for i in range(begin, seen.first[r + 1]):
        view.row[i] = bench.kept[i - begin]
        view.state[i] = bench.state[i - begin]


@part
def _measure(case, spot, r, yaw, x, y):
    """Measure the planes of room ``r``, whose centre is at ``(x, y)``."""
    for i in range(case.seen.first[r], case.seen.first[r + 1]):
        if spot.row[i] >= 0:
            spot.bend[i], spot.offset[i] = residuals(case, i, spot.row[i], yaw, x, y)


@part
def fixes(case, spot):
    """Whether the planes that fit are not all parallel."""
    view = spot
    seen, limits = case.seen, case.limits
    first = -1
    for i in range(len(view.state)):
        if view.state[i] != FIT:
            continue
        if first < 0:
            first = i
        elif abs(math.sin(seen.angle[i] - seen.angle[first])) >= limits.sine:
            return True
    case.found.count[WORK] += len(view.state) ** 2 // 4
    for i in range(len(view.state)):
        for k in range(i):
            both = view.state[i] == FIT and view.state[k] == FIT
            if both and abs(math.sin(seen.angle[i] - seen.angle[k])) >= limits.sine:
                return True
    return False


@part
def copy_view(source, target):
    """Copy the correspondences."""
    old, new = source, target
    for r in range(len(old.room)):
        new.room[r] = old.room[r]
    for i in range(len(old.row)):
        new.row[i] = old.row[i]
        new.state[i] = old.state[i]
        new.offset[i] = old.offset[i]
        new.bend[i] = old.bend[i]


@part
def count_planes(case, spot):
    """Count the occurrences of each distinct plane by state, and no more."""
    view = spot
    seen, tally = case.seen, case.tally
    for p in range(seen.planes):
        tally.missing[p] = 0
        tally.sums[p, 0] = tally.sums[p, 3] = 0.0
    for i in range(len(view.state)):
        p = seen.plane[i]
        if view.state[i] == FIT:
            tally.sums[p, 0] += 1
        elif view.state[i] == MOVED:
            tally.sums[p, 3] += 1
        elif view.state[i] == MISSING:
            tally.missing[p] += 1


@part
def tally_planes(case, spot):
    """Count the occurrences of each distinct plane by state, and sum their squared residuals.

    Returns how often a plane is moved.
    """
    view, seen, tally, moved = spot, case.seen, case.tally, 0
    case.found.count[WORK] += len(view.state)
    for p in range(seen.planes):
        tally.missing[p] = 0
        tally.sums[p, 0] = tally.sums[p, 1] = tally.sums[p, 2] = tally.sums[p, 3] = 0.0
    for i in range(len(view.state)):
        p = seen.plane[i]
        if view.state[i] == FIT:
            tally.sums[p, 0] += 1
            tally.sums[p, 1] += view.offset[i] * view.offset[i]
            tally.sums[p, 2] += view.bend[i] * view.bend[i]
        elif view.state[i] == MOVED:
            moved += 1
            if tally.sums[p, 3] == 0:
                for k in range(4, 9):
                    tally.sums[p, k] = 0.0
            tally.sums[p, 3] += 1
            tally.sums[p, 4] += view.bend[i] * view.bend[i]
            tally.sums[p, 5] += view.offset[i]
            tally.sums[p, 6] = view.row[i]
        elif view.state[i] == MISSING:
            tally.missing[p] += 1
    return moved


@part
def evidence(case, spot):
    """L of the walls: distinct planes, and rooms explained or not."""
    view = spot
    seen, limits, tally = case.seen, case.limits, case.tally
    total, often = 0.0, tally_planes(case, spot)
    for p in range(seen.planes):
        fits, moved = tally.sums[p, 0], tally.sums[p, 3]
        if fits > 0:
            total += limits.fit_peak - _mean(tally.sums[p, 1], fits) * limits.plane_weight
            total -= _mean(tally.sums[p, 2], fits) * limits.angle_weight
        elif moved > 0:
            total += limits.moved_base - _mean(tally.sums[p, 4], moved) * limits.angle_weight
        elif tally.missing[p] > 0:
            total += limits.missing
            continue
        total += tally.missing[p] * limits.missing_shared
    for r in range(len(view.room)):
        total += limits.room_true if view.room[r] >= 0 else limits.room_false
    return total + _moved_together(case) if often > 1 else total


@part
def _mean(total, count):
    """The mean of so many; most often it is one."""
    return total if count == 1.0 else total / count


@part
def unexplained(case, spot):
    """What the rooms say that are not explained: they may be like those of the plan."""
    total = 0.0
    for r in range(len(spot.room)):
        if spot.room[r] < 0:
            total += case.found.other[r]
    return total


@part
def _moved_together(case):
    """What moved planes of one wall spare, which moved as one: a largest spanning forest of them.

    Grown from any plane (Prim), always by the plane whose wall's other planes moved most alike.
    """
    seen, sums = case.seen, case.tally.sums
    total = 0.0
    while True:
        best = -1
        case.found.count[WORK] += seen.planes
        for p in range(seen.planes):
            out = _is_moved(case.tally, p) and sums[p, 7] == 0
            if out and (best < 0 or sums[p, 8] > sums[best, 8]):
                best = p
        if best < 0:
            return total
        sums[best, 7] = 1.0
        total += sums[best, 8]
        for p in range(seen.planes):
            if _is_moved(case.tally, p) and sums[p, 7] == 0:
                sums[p, 8] = max(sums[p, 8], _spared(case, p, best))


@part
def _is_moved(tally, p):
    return tally.sums[p, 0] == 0 and tally.sums[p, 3] > 0


@part
def _spared(case, p, q):
    """Ln of how much likelier moved plane ``p`` is beside moved plane ``q``; 0 unless one wall."""
    limits, tally = case.limits, case.tally
    side = one_wall(case, int(tally.sums[p, 6]), int(tally.sums[q, 6]))
    if side == 0.0:
        return 0.0
    apart = tally.sums[p, 5] / tally.sums[p, 3] - side * tally.sums[q, 5] / tally.sums[q, 3]
    likelier = limits.together * math.exp(-apart * apart * limits.apart_weight) + limits.alone
    return math.log(likelier) if likelier > 1.0 else 0.0


@part
def one_wall(case, j, m):
    """1 or -1 when two prior rows may be faces of one wall, of one side or of both; else 0."""
    one, two = case.plan.row[j], case.plan.row[m]
    if abs(one[0] * two[1] - one[1] * two[0]) > PARALLEL:
        return 0.0
    side = 1.0 if one[0] * two[0] + one[1] * two[1] > 0 else -1.0
    return side if abs(one[2] - side * two[2]) <= case.limits.thickness else 0.0
