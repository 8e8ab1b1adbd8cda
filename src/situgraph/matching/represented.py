"""Whether a listed candidate already stands for every placement of a box."""

from __future__ import annotations

import math

from situgraph.matching.boxes import (
    AX,
    AY,
    PX,
    PY,
    TURN,
    YAW,
    centre,
    radius,
    reach_of,
    slack_of_room,
)
from situgraph.matching.compiled import part
from situgraph.matching.containment import may_be
from situgraph.matching.effort import exhausted
from situgraph.matching.explained import may_explain
from situgraph.matching.lookup import find
from situgraph.matching.nearby import TIE, peaks_near, same_place
from situgraph.matching.records import scratch
from situgraph.matching.slack import SLACK, give, wrapped
from situgraph.matching.strands import row_at, rows_near
from situgraph.matching.tables import WORK

NEAR = 1.0  # candidates nearer to a box than this may represent it, metres
JUDGED = 12  # comparisons of planes that a look whether a peak is near a box is worth, about


@part
def known_peak(case, box):
    """A peak that represents all feasible placements of the box, -1 for none.

    Of peaks that are the same only the highest becomes a candidate: whichever that is has to
    represent them too.
    """
    close, middle, last = case.found.close, scratch(3), -1
    centre(box, middle)
    reach = max(NEAR, case.limits.same_distance) + sway_of(box) + SLACK
    while True:
        m, count = 0, peaks_near(case, middle[1], middle[2], reach)
        while m < count and (close[m] <= last or not stands_for(case, close[m], box)):
            m += 1
        if m == count or exhausted(case):
            return -1
        last = close[m]
        if _others_stand(case, last, box):
            return last


@part
def _others_stand(case, k, box):
    """Whether those peaks that are the same as ``k``, and not lower, represent the box as well."""
    peaks, close = case.found.peak, case.found.close
    for n in range(peaks_near(case, peaks[k, 1], peaks[k, 2], case.limits.same_distance)):
        m = close[n]
        if m == k or peaks[m, 3] < peaks[k, 3] - TIE or not same_place(case, peaks[k], peaks[m]):
            continue
        if not stands_for(case, m, box):
            return False
    return True


@part
def none_higher(case, k):
    """Whether no peak can be higher than ``k``: all rooms explained, and no wall that has moved.

    With the same planes fitting there is one optimum; any other has a plane moved at least.
    """
    seen, limits = case.seen, case.limits
    most = seen.planes * limits.fit_peak + len(seen.storey) * limits.room_true
    return case.found.peak[k, 3] >= most - (limits.fit_peak - limits.moved_base)


@part
def stands_for(case, k, box):
    """Whether peak ``k`` represents all feasible placements of the box."""
    limits, middle, at = case.limits, scratch(3), case.found.peak[k]
    case.found.count[WORK] += JUDGED
    centre(box, middle)
    sway = sway_of(box)
    apart = math.hypot(at[1] - middle[1], at[2] - middle[2])
    turned = abs(wrapped(at[0] - middle[0]))
    if apart + sway <= limits.same_distance and turned + box[TURN] <= limits.same_yaw:
        return True
    near = apart <= NEAR + sway and turned <= limits.same_yaw + box[TURN]
    return near and represents(case, box, at)


@part
def sway_of(box):
    """How far the mean room centre moves inside the box."""
    return radius(box) + 2 * math.sin(box[TURN] / 2) * math.hypot(box[AX], box[AY])


@part
def represents(case, box, at):
    """Whether all pairs of planes that can fit in the box fit at the placement ``at`` as well."""
    here = reach_of(box)
    for r in range(len(case.seen.storey)):  # noqa: SIM110
        if not represents_room(case, box, here, at, r):
            return False
    return True


@part
def represents_room(case, box, here, at, r):
    """The same of the planes of room ``r``; ``here`` is the ``reach_of`` the box."""
    seen, plan, limits, finder = case.seen, case.plan, case.limits, case.finder
    storey = case.task.storeys[seen.storey[r]]
    if storey < 0:
        return True
    found = find(case, r, storey, here, False)
    if found < 0:
        return False
    cx, cy = seen.center[r, 0], seen.center[r, 1]
    slack = slack_of_room(case, box, here, r)
    x, y = box[PX] + slack.wx, box[PY] + slack.wy
    ca, sa = math.cos(at[0]), math.sin(at[0])
    tx, ty = at[1] + ca * cx - sa * cy, at[2] + sa * cx + ca * cy
    for k in range(found):
        a = finder.room[k]
        if not may_be(case, r, a):
            continue
        if not may_explain(case, r, a, box[YAW], x, y, slack):
            continue
        for i in range(seen.first[r], seen.first[r + 1]):
            top, rows = rows_near(case, a, i, box[YAW], x, y, limits.fit, slack)
            for m in range(rows):
                j = row_at(case, top, m)
                bend = wrapped(seen.angle[i] + box[YAW] - plan.row[j, 3])
                if abs(bend) > limits.angle + box[TURN] + SLACK:
                    continue
                nx, ny = plan.row[j, 0], plan.row[j, 1]
                off = abs(seen.distance[i] - (nx * x + ny * y + plan.row[j, 2]))
                if off > limits.fit + give(slack, nx, ny) + SLACK:
                    continue
                there = abs(wrapped(seen.angle[i] + at[0] - plan.row[j, 3]))
                reach = abs(seen.distance[i] - (nx * tx + ny * ty + plan.row[j, 2]))
                if there > limits.angle + SLACK or reach > limits.fit + SLACK:
                    return False
    return True
