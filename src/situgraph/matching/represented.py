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
    radius,
    slack_of,
)
from situgraph.matching.compiled import part
from situgraph.matching.containment import may_be
from situgraph.matching.explained import SLACK, give, may_explain, wrapped
from situgraph.matching.lookup import find
from situgraph.matching.tables import PEAKS


@part
def represented(case, box, at):
    """Whether all pairs of planes that can fit in the box fit at the placement ``at`` as well."""
    seen, plan, limits, finder, task = (
        case.seen,
        case.plan,
        case.limits,
        case.finder,
        case.task,
    )
    c, s = math.cos(box[YAW]), math.sin(box[YAW])
    ca, sa = math.cos(at[0]), math.sin(at[0])
    for r in range(len(seen.storey)):
        storey = task.storeys[seen.storey[r]]
        if storey < 0:
            continue
        found = find(
            case,
            r,
            storey,
            box[YAW],
            box[TURN],
            box[AX],
            box[AY],
            box[PX],
            box[PY],
            radius(box),
            False,
        )
        if found < 0:
            return False
        cx, cy = seen.center[r, 0], seen.center[r, 1]
        gx, gy = cx - box[AX], cy - box[AY]
        wx, wy = c * gx - s * gy, s * gx + c * gy
        x, y = box[PX] + wx, box[PY] + wy
        slack = slack_of(box, wx, wy)
        tx, ty = at[1] + ca * cx - sa * cy, at[2] + sa * cx + ca * cy
        for k in range(found):
            a = finder.room[k]
            if not may_be(case, r, a):
                continue
            if not may_explain(case, r, a, box[YAW], x, y, slack):
                continue
            for i in range(seen.first[r], seen.first[r + 1]):
                for j in range(plan.first[a], plan.first[a + 1]):
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


@part
def add_peak(case, at, height):
    """Note a peak, unless it is known; where there is no room for it, it is only counted."""
    peaks, count = case.found.peak, case.found.count
    for k in range(min(count[PEAKS], len(peaks))):
        if (
            abs(peaks[k, 1] - at[1]) + abs(peaks[k, 2] - at[2]) < 1e-4
            and abs(wrapped(peaks[k, 0] - at[0])) < 1e-4
        ):
            return
    if count[PEAKS] < len(peaks):
        for k in range(3):
            peaks[count[PEAKS], k] = at[k]
        peaks[count[PEAKS], 3] = height
    count[PEAKS] += 1
