"""All placements around a new peak are searched at once, for all groups that are yet to come.

Nearly every group finds a true place, each with a box of its own, and all of these boxes lie around
the same peak. Once all is searched there, whichever rooms are explained, they are left unseen.
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math

from situgraph.matching.boxes import SIDES
from situgraph.matching.compiled import part
from situgraph.matching.cover import longest_arm
from situgraph.matching.effort import exhausted
from situgraph.matching.explore import ascend, explore
from situgraph.matching.peaks import feasible
from situgraph.matching.records import scratch
from situgraph.matching.settled import FARTHEST, WIDEST, around
from situgraph.matching.slack import wrapped
from situgraph.matching.tables import MADE, PEAKS, SETTLED

WORTH = 4  # groups to come, for which it is worth while


@part
def survey(case, g, before):
    """Search all placements around the highest peak that group ``g`` has found.

    Its peaks are those from number ``before`` on. No room is required for that.
    """
    found, groups = case.found, case.groups
    if groups.told[MADE] - 1 - g < WORTH or exhausted(case):
        return
    top = _highest(found, before)
    if found.settled[top, 0] > 0.0:
        return
    box, turn = scratch(SIDES), WIDEST * case.limits.angle
    around(case, found.peak[top], FARTHEST, turn, box)
    _require(case, g, 0)
    _ascend_beside(case, found.peak[top])
    explore(case, box)
    _require(case, g, 1)
    if exhausted(case):
        return
    _note(found, top, _highest(found, before), turn)


@part
def _highest(found, before):
    """The highest peak from number ``before`` on."""
    top = before
    for k in range(before + 1, found.count[PEAKS]):
        if found.peak[k, 3] > found.peak[top, 3]:
            top = k
    return top


@part
def _ascend_beside(case, peak):
    """Climb from placements beside a peak, as every group would have done from others."""
    at, step, arm = scratch(3), case.limits.peak_step, longest_arm(case)
    for k in range(6):  # one way and the other, in yaw, x and y
        for c in range(3):
            at[c] = peak[c]
        off = step if k & 1 else -step
        at[k >> 1] += off / arm if k < 2 else off
        if feasible(case, case.one, at):
            ascend(case, at)


@part
def _require(case, g, value):
    """Require all rooms of group ``g``, or none any longer."""
    groups = case.groups
    for m in range(groups.first[g], groups.first[g + 1]):
        case.spans.required[groups.member[m]] = value


@part
def _note(found, middle, top, turn):
    """Note with a peak how far around it all is searched, of what was searched around another."""
    one, two = found.peak[middle], found.peak[top]
    far = FARTHEST - math.hypot(one[1] - two[1], one[2] - two[2])
    turn -= abs(wrapped(one[0] - two[0]))
    if far > 0.0 and turn > 0.0:
        found.settled[top, 0], found.settled[top, 1] = far, turn
        found.count[SETTLED] += 1
