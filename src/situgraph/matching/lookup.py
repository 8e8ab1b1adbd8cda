"""Which prior rooms might explain an online room that a box of placements puts somewhere.

A superset of the truth, by the corner hash (rooms with a corner) or by lines (rooms of parallel
planes, which any room with the same lines explains, however far along them).
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math
from typing import NamedTuple

from situgraph.matching.compiled import part
from situgraph.matching.corners import (
    FAR_CELL,
    FAR_REACH,
    NEAR_CELL,
    NEAR_REACH,
    bucket,
    sector_of,
)
from situgraph.matching.slack import wrapped
from situgraph.matching.strands import first_from

REACHED = 1e-6  # metres, for rounding


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
    seen, plan, finder = case.seen, case.plan, case.finder
    finder.turn[0] += 1
    c, s, ax, ay, px, py = at.cos, at.sin, at.ax, at.ay, at.px, at.py
    if seen.flat[r]:
        ux, uy = seen.center[r, 0] - ax, seen.center[r, 1] - ay
        slip = at.spread + at.sweep * math.sqrt(ux * ux + uy * uy)
        x, y = px + c * ux - s * uy, py + s * ux + c * uy
        if slip > FAR_REACH and not all_if_wide:
            return -1
        return _by_line(case, r, storey, at.yaw, at.turn, x, y, slip)
    count = 0
    for k in range(seen.probe_first[r], seen.probe_first[r + 1]):
        ux, uy = seen.probe_arm[k, 0] - ax, seen.probe_arm[k, 1] - ay
        x, y = px + c * ux - s * uy, py + s * ux + c * uy
        reach = seen.probe_reach[k] + at.spread
        reach += at.sweep * math.sqrt(ux * ux + uy * uy)
        sector = sector_of(seen.angle[seen.probe[k, 0]] + at.yaw)
        if reach <= NEAR_REACH:
            h = bucket(storey, sector, math.floor(x / NEAR_CELL), math.floor(y / NEAR_CELL))
            start, corner, tag = plan.near_start, plan.near_corner, plan.near_tag
        elif reach <= FAR_REACH:
            h = bucket(storey, sector, math.floor(x / FAR_CELL), math.floor(y / FAR_CELL))
            start, corner, tag = plan.far_start, plan.far_corner, plan.far_tag
        elif not all_if_wide:
            return -1
        else:
            return _everywhere(case, storey)
        farthest = (reach + REACHED) ** 2
        b = h & (len(start) - 2)
        name = (h >> 24) & 0xFFFF
        for e in range(start[b], start[b + 1]):
            if tag[e] != name:
                continue
            dx, dy = plan.corner_place[corner[e], 0] - x, plan.corner_place[corner[e], 1] - y
            a = plan.corner_room[corner[e]]
            if dx * dx + dy * dy <= farthest and finder.last[a] != finder.turn[0]:
                finder.last[a] = finder.turn[0]
                finder.room[count] = a
                count += 1
    for k in range(len(plan.large)):
        a = plan.large[k]
        if plan.storey[a] == storey and finder.last[a] != finder.turn[0]:
            finder.last[a] = finder.turn[0]
            finder.room[count] = a
            count += 1
    return count


@part
def _everywhere(case, storey):
    plan, finder = case.plan, case.finder
    count = 0
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
    return count
