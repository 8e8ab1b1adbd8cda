"""Peaks that stand for all placements around them, and beside which there is no higher one.

What leads to such a peak again is known before any room is looked up.
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math

from situgraph.matching.boxes import (
    AX,
    AY,
    HU,
    HV,
    PX,
    PY,
    SIDES,
    TURN,
    UX,
    UY,
    YAW,
    possible,
    reach_again,
    reach_of,
    slack_of_room,
)
from situgraph.matching.compiled import part
from situgraph.matching.cover import keep_left, longest_arm
from situgraph.matching.homes import sole_room
from situgraph.matching.nearby import TIE, add_peak, peak_at, peaks_near, same_place
from situgraph.matching.plain import COS, SIN
from situgraph.matching.records import scratch
from situgraph.matching.represented import represents_room
from situgraph.matching.slack import give, wrapped
from situgraph.matching.tables import FIT, SETTLED
from situgraph.matching.views import count_planes, unexplained
from situgraph.matching.wards import entrust

FARTHEST, WIDEST = 2.0, 1.02  # metres around a peak, and share of the angle tolerance
SETTLING = 3  # times that these are halved, at most


@part
def settled_by(case, box):
    """Whether all placements of a box are so near to a settled peak that it stands for them."""
    peaks, settled, close = case.found.peak, case.found.settled, case.found.close
    if case.found.count[SETTLED] == 0:
        return False
    at, ax, ay = reach_again(case, box), box[AX], box[AY]
    sway = at.spread + at.sweep * math.sqrt(ax * ax + ay * ay)
    if sway > FARTHEST:
        return False
    x, y = at.px - at.cos * ax + at.sin * ay, at.py - at.sin * ax - at.cos * ay
    for m in range(peaks_near(case, x, y, FARTHEST - sway)):
        k = close[m]
        dx, dy, far = peaks[k, 1] - x, peaks[k, 2] - y, settled[k, 0] - sway
        turned = abs(wrapped(peaks[k, 0] - at.yaw))
        if far >= 0.0 and dx * dx + dy * dy <= far * far and turned + at.turn <= settled[k, 1]:
            return True
    return False


@part
def settle(case, at, height):
    """Note a peak if it is the only one around, and how far: it stands for all placements there.

    None there is higher, so that nothing need be looked for. ``case.one`` must be its view. False,
    and nothing noted, when that cannot be told.
    """
    peaks, settled, close = case.found.peak, case.found.settled, case.found.close
    if not _is_whole(case, height):
        return False
    known = peak_at(case, at)
    if known >= 0 and settled[known, 0] > 0:
        return True
    for n in range(peaks_near(case, at[1], at[2], case.limits.same_distance)):
        k = close[n]
        if k != known and peaks[k, 3] >= height - TIE and same_place(case, peaks[k], at):
            return False
    box, (far, turn) = scratch(SIDES), (FARTHEST, WIDEST * case.limits.angle)
    for _ in range(SETTLING):
        around(case, at, far, turn, box)
        if _stands_around(case, box, at) and _no_more(case, box):
            add_peak(case, at, height, unexplained(case, case.one))
            known = peak_at(case, at)
            if known < 0:
                return False
            settled[known, 0], settled[known, 1] = far, turn
            case.found.count[SETTLED] += 1
            entrust(case, known, box)
            keep_left(case, box, longest_arm(case))
            return True
        far, turn = far / 2, turn / 2
    return False


@part
def all_fit(case):
    """Whether all walls of the explained rooms of ``case.one`` fit."""
    for i in range(len(case.one.state)):  # noqa: SIM110
        if case.one.state[i] > FIT:
            return False
    return True


@part
def _is_whole(case, height):
    """Whether all walls of the explained rooms of ``case.one`` fit, so well that none is higher.

    Any other peak of these rooms has a wall moved at least, or one room less.
    """
    seen, view, limits, tally = case.seen, case.one, case.limits, case.tally
    if not all_fit(case):
        return False
    count_planes(case, view)
    most = 0.0
    for p in range(seen.planes):
        if tally.sums[p, 0] > 0:
            most += limits.fit_peak
    for r in range(len(view.room)):
        most += limits.room_true if view.room[r] >= 0 else limits.room_false
    least = min(limits.fit_peak - limits.moved_base, limits.room_true - limits.room_false)
    return height >= most - least


@part
def around(case, at, far, turn, box):
    """The box of placements around a peak, along the walls of a room."""
    row = case.plan.row
    box[YAW], box[TURN], box[PX], box[PY] = at[0], turn, at[1], at[2]
    box[UX], box[UY] = row[0, 0], row[0, 1]
    box[HU] = box[HV] = far
    box[AX] = box[AY] = 0.0


@part
def _stands_around(case, box, at):
    """Whether a peak ``at`` the middle of the box represents it; ``case.one`` is its view."""
    here = reach_of(box)
    for r in range(len(case.one.room)):
        if not _stays(case, box, here, r) and not represents_room(case, box, here, at, r):
            return False
    return True


@part
def _stays(case, box, here, r):
    """Whether ``case.one`` explains ``r``, whose walls all fit there, and no other room may.

    Then no other walls can fit either.
    """
    storey, a = case.task.storeys[case.seen.storey[r]], case.one.room[r]
    if a < 0:
        return False
    slack, row = slack_of_room(case, box, here, r), case.plan.plain[a]
    away = max(give(slack, row[COS], row[SIN]), give(slack, -row[SIN], row[COS]))
    x, y = box[PX] + slack.wx, box[PY] + slack.wy
    return sole_room(case, r, storey, box[YAW], box[TURN], x, y, away) == a


@part
def _no_more(case, box):
    """Whether no other room than those of ``case.one`` may be explained in the box."""
    here = reach_of(box)
    for r in range(len(case.one.room)):
        if case.one.room[r] < 0 and possible(case, box, here, r):
            return False
    return True
