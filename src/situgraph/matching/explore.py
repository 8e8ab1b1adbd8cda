"""Branch and bound in a box of placements: step 4 of section 7 of ``docs/matching.md``."""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math

from situgraph.matching.boxes import (
    AX,
    AY,
    HU,
    HV,
    SIDES,
    TURN,
    centre,
    extent,
    move_anchor,
    radius,
    shrink,
    squeeze,
    squeeze_on,
)
from situgraph.matching.compiled import part
from situgraph.matching.cover import (
    keep_left,
    longest_arm,
    nothing_left,
    outside,
    spread,
    strayed,
)
from situgraph.matching.effort import exhausted
from situgraph.matching.hypotheses import copy_box, split
from situgraph.matching.nearby import add_peak, is_highest, peaks_near
from situgraph.matching.optimum import optimum
from situgraph.matching.peaks import climb, feasible, rise
from situgraph.matching.records import scratch
from situgraph.matching.represented import NEAR, known_peak, none_higher
from situgraph.matching.settled import all_fit, settle, settled_by
from situgraph.matching.tables import BOXES, CUT, PEAKS, STAGE, WITHIN
from situgraph.matching.views import fixes, look, look_whole, unexplained
from situgraph.matching.wards import entrust

FINE = 0.005  # half widths below which no higher peak is looked for beside a known one, metres
GUESSES = 3  # least squares from relaxed correspondences


@part
def explore(case, start):
    """Branch and bound: until all of the box is known to be infeasible.

    Or represented by a peak.
    """
    found, limits, arm = case.found, case.limits, longest_arm(case)
    stack, box, at, left = found.stack, scratch(SIDES), scratch(3), scratch(SIDES)
    nothing_left(left)
    copy_box(start, stack[0])
    depth = 1
    while depth > 0:
        depth -= 1
        copy_box(stack[depth], box)
        found.count[BOXES] += 1
        if exhausted(case):
            break
        before = extent(box, arm)
        if not shrink(case, box):
            continue
        if settled_by(case, box):
            continue
        if not squeeze_on(case, box, arm, before):
            continue
        if box[AX] != 0.0 or box[AY] != 0.0:
            move_anchor(box)
            if not squeeze(case, box, arm):
                continue
        if found.count[STAGE] == WITHIN and outside(case, box):
            continue
        side, widest = 0, box[TURN] * arm
        if box[HU] > widest:
            side, widest = 1, box[HU]
        if box[HV] > widest:
            side, widest = 2, box[HV]
        known = known_peak(case, box)
        if known >= 0:
            spread(left, box)
            if widest < FINE or none_higher(case, known) or settled_by(case, box):
                entrust(case, known, box)
                continue
        peaks = found.count[PEAKS]
        state = _witness(case, box, arm, at)
        if state < 0:
            continue
        if state > 0:
            ascend(case, at)
        if known < 0 and found.count[PEAKS] > peaks:
            known = known_peak(case, box)
        if known >= 0:
            spread(left, box)
            entrust(case, known, box)
            continue
        if widest < (limits.peak_step if state > 0 else limits.smallest_step) / 2:
            spread(left, box)
            continue
        if depth + 2 > len(stack):
            found.count[CUT] = 1
            continue
        split(box, side, stack[depth], stack[depth + 1])
        depth += 2
    keep_left(case, left, arm)


@part
def _witness(case, box, arm, at):
    """Look for a feasible placement in or near the box: 1 found, 0 not found, -1 none can be.

    It is left in ``at``. The last is known from the correspondences with all residuals widened by
    what the box allows.
    """
    task = case.task
    centre(box, at)
    if feasible(case, case.one, at):
        return 1
    loose = radius(box) + 2 * math.sin(box[TURN] / 2) * arm
    turn = box[TURN]
    for k in range(GUESSES):
        count = look(case, case.one, at[0], at[1], at[2], turn, loose)
        if k == 0 and (count < task.least or not fixes(case, case.one)):
            return -1
        if count == 0:
            return 0
        optimum(case, case.one, at, 0.0, at)
        if not strayed(box, at) and feasible(case, case.one, at):
            return 1
        loose /= 2
    return 0


@part
def settles_at_once(case, box):
    """Whether the middle of a box far from known peaks leads to one that stands for all of it."""
    at = scratch(3)
    centre(box, at)
    if peaks_near(case, at[1], at[2], NEAR) > 0:
        return False
    count = look_whole(case, case.one, at[0], at[1], at[2])
    if count < case.task.least or not fixes(case, case.one) or not all_fit(case):
        return False
    return settle(case, at, climb(case, at)) and settled_by(case, box)


@part
def ascend(case, at):
    """Note the peak of a feasible placement, whose view is ``case.one``, and where it leads."""
    height = climb(case, at)
    highest = is_highest(case, at, height)
    add_peak(case, at, height, unexplained(case, case.one))
    if highest and not settle(case, at, height):
        top = rise(case, at, height)
        if top > height:
            settle(case, at, top)
