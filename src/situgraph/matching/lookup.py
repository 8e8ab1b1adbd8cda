"""Which prior rooms might explain an online room that a box of placements puts somewhere.

A superset of the truth, by their corners (rooms that have some) or by lines (rooms of parallel
planes, which any room with the same lines explains, however far along them).
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math
from typing import NamedTuple

from situgraph.matching.compiled import part
from situgraph.matching.corners import ROUNDED, cell_of, quarter_of
from situgraph.matching.homes import sole_room
from situgraph.matching.slack import wrapped
from situgraph.matching.strands import LOOKUP, first_from
from situgraph.matching.tables import WORK

WIDEST = 6.0  # metres by which a corner may be off; of placements wider than that nothing is told
KEPT, KEPT_TURN = 0.25, 0.02  # metres and radians around a placement whose rooms are kept
MOST_KEPT = 16  # rooms
REACHED = 1e-6  # metres, for rounding
TURNED = 1e-6  # radians, the same


class Reach(NamedTuple):
    """Placements, as far as rooms are looked up for them.

    They turn by ``yaw`` up to ``turn`` more or less, and take the point ``(ax, ay)`` of the map to
    within ``spread`` of ``(px, py)``.
    """

    yaw: float
    turn: float
    cos: float  # of the yaw
    sin: float
    bend: float  # 1 - cos(turn)
    swing: float  # sin(turn)
    sweep: float  # 2 sin(turn / 2)
    ax: float
    ay: float
    px: float
    py: float
    spread: float


@part
def find(case, r, storey, at, all_if_wide):
    """Find rooms on ``storey`` that might explain ``r``; returns how many stand in ``finder.room``.

    Of placements ``at`` too wide for the index all rooms are returned, or -1 unless
    ``all_if_wide``.
    """
    seen, finder = case.seen, case.finder
    case.found.count[WORK] += LOOKUP
    cx, cy = seen.center[r, 0], seen.center[r, 1]
    ux, uy = cx - at.ax, cy - at.ay
    off = at.spread + at.sweep * math.sqrt(ux * ux + uy * uy)
    x, y = at.px + at.cos * ux - at.sin * uy, at.py + at.sin * ux + at.cos * uy
    if seen.flat[r]:
        if off > WIDEST and not all_if_wide:
            return -1
        return _by_line(case, r, storey, at.yaw, at.turn, x, y, off)
    home = sole_room(case, r, storey, at.yaw, at.turn, x, y, off)
    if home >= 0:
        finder.room[0] = home
        return 1
    if off <= KEPT / 2 and at.turn <= KEPT_TURN / 2:
        count = _kept(case, r, storey, at, x, y, off)
        if count < 0:
            bend, swing, sweep = 1 - math.cos(KEPT_TURN), math.sin(KEPT_TURN), KEPT_TURN
            turned = (at.yaw, KEPT_TURN, at.cos, at.sin, bend, swing, sweep)
            count = _by_corners(case, r, storey, Reach(*turned, cx, cy, x, y, KEPT))
            _keep(case, r, storey, at.yaw, x, y, count)
        if count >= 0:
            return count
    count = _by_corners(case, r, storey, at)
    return _everywhere(case, storey) if count < 0 and all_if_wide else count


@part
def _kept(case, r, storey, at, x, y, off):
    """How many rooms were found for ``r`` around placements that take it to ``(x, y)``.

    Up to ``off`` from there. They are put into ``finder.room``; -1 when it was not looked up there.
    """
    finder = case.finder
    home = finder.home[r]
    dx, dy, left = x - home[0], y - home[1], KEPT - off
    if home[3] != storey + 1 or abs(at.yaw - home[2]) + at.turn > KEPT_TURN:
        return -1
    if dx * dx + dy * dy > left * left:
        return -1
    for k in range(finder.count[r]):
        finder.room[k] = finder.kept[r, k]
    return finder.count[r]


@part
def _keep(case, r, storey, yaw, x, y, count):
    """Keep the rooms found around a placement: climbs and small boxes look there again."""
    finder = case.finder
    home = finder.home[r]
    home[3] = 0.0
    if count < 0 or count > MOST_KEPT:
        return
    home[0], home[1], home[2], home[3] = x, y, yaw, storey + 1
    finder.count[r] = count
    for k in range(count):
        finder.kept[r, k] = finder.room[k]


@part
def _by_corners(case, r, storey, at):
    """The rooms that have one of the corners by which ``r`` is looked up, -1 if it is too wide."""
    seen, plan, finder = case.seen, case.plan, case.finder
    finder.turn[0] += 1
    count = 0
    for k in range(seen.probe_first[r], seen.probe_first[r + 1]):
        ux, uy = seen.probe_arm[k, 0] - at.ax, seen.probe_arm[k, 1] - at.ay
        off, arm = seen.probe_reach[k] + at.spread, math.sqrt(ux * ux + uy * uy)
        if off + at.sweep * arm > WIDEST:
            return -1
        x, y = at.cos * ux - at.sin * uy, at.sin * ux + at.cos * uy
        angle = seen.angle[seen.probe[k, 0]] + at.yaw
        count = _by_corner(case, storey, at, x, y, arm, off, angle, count)
    case.found.count[WORK] += len(plan.large)
    for k in range(len(plan.large)):
        a = plan.large[k]
        if plan.storey[a] == storey and finder.last[a] != finder.turn[0]:
            finder.last[a] = finder.turn[0]
            finder.room[count] = a
            count += 1
    return count


@part
def _by_corner(case, storey, at, ux, uy, arm, off, angle, count):
    """Add to ``count`` rooms those with a corner whose first plane has about this direction.

    It is ``off`` at most from where placements ``at`` take the end of an arm ``(ux, uy)``, turned.
    """
    plan, finder = case.plan, case.finder
    x, y = at.px + ux, at.py + uy
    off += REACHED + ROUNDED * (abs(x) + abs(y))
    wide = off + abs(ux) * at.bend + abs(uy) * at.swing
    tall = off + abs(uy) * at.bend + abs(ux) * at.swing
    low, high = max(arm - off, 0.0), arm + off
    low, high = low * low, high * high
    turn = case.limits.angle + at.turn + TURNED
    x0, x1 = cell_of(plan, 0, x - wide), cell_of(plan, 0, x + wide)
    y0, y1 = cell_of(plan, 1, y - tall), cell_of(plan, 1, y + tall)
    first, last = quarter_of(plan, angle - turn), quarter_of(plan, angle + turn)
    for quarter in range(first, min(last, first + 3) + 1):
        top = (4 * storey + (quarter & 3)) * plan.corner_cells[1]
        for line in range(top + y0, top + y1 + 1):
            row = line * plan.corner_cells[0]
            begin, end = plan.corner_first[row + x0], plan.corner_first[row + x1 + 1]
            case.found.count[WORK] += 1 + end - begin
            for k in range(begin, end):
                dx, dy = plan.corner_place[k, 0] - x, plan.corner_place[k, 1] - y
                if abs(dx) > wide or abs(dy) > tall:
                    continue
                # However they turn, the corner stays as far from the arm's other end.
                vx, vy = dx + ux, dy + uy
                away = vx * vx + vy * vy
                if away < low or away > high:
                    continue
                a = plan.corner_room[k]
                if finder.last[a] == finder.turn[0]:
                    continue
                if abs(wrapped(plan.corner_angle[k] - angle)) <= turn:
                    finder.last[a] = finder.turn[0]
                    finder.room[count] = a
                    count += 1
    return count


@part
def _everywhere(case, storey):
    plan, finder = case.plan, case.finder
    count = 0
    case.found.count[WORK] += len(plan.storey) // 4
    for a in range(len(plan.storey)):
        if plan.storey[a] == storey:
            finder.room[count] = a
            count += 1
    return count


@part
def _by_line(case, r, storey, yaw, turn, x, y, slip):
    """Rooms that have the line of the room's first plane."""
    seen, plan, limits, finder = (
        case.seen,
        case.plan,
        case.limits,
        case.finder,
    )
    finder.turn[0] += 1
    i = seen.first[r]
    far = math.sqrt(x * x + y * y) + slip
    count = 0
    for b in range(plan.bin_first[storey], plan.bin_first[storey + 1]):
        spread = plan.bin_spread[b]
        bend = wrapped(seen.angle[i] + yaw - plan.bin_angle[b])
        if abs(bend) > limits.angle + turn + spread + 1e-9:
            continue
        nx, ny = math.cos(plan.bin_angle[b]), math.sin(plan.bin_angle[b])
        want = seen.distance[i] - nx * x - ny * y
        width = limits.fit + slip + spread * far + 1e-6
        k = first_from(plan.line_offset, plan.line_first[b], plan.line_first[b + 1], want - width)
        while k < plan.line_first[b + 1] and plan.line_offset[k] <= want + width:
            a = plan.line_room[k]
            if finder.last[a] != finder.turn[0]:
                finder.last[a] = finder.turn[0]
                finder.room[count] = a
                count += 1
            k += 1
        case.found.count[WORK] += LOOKUP
    case.found.count[WORK] += count
    return count
