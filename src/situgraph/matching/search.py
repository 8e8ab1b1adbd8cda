"""The search for all candidates: section 7 of ``docs/matching.md``."""

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
    narrow,
    possible,
    radius,
    shrink,
    slack_of,
)
from situgraph.matching.compiled import part
from situgraph.matching.containment import may_be
from situgraph.matching.explained import give, may_explain, wrapped
from situgraph.matching.ground import enough, lay, partners_lie
from situgraph.matching.groups import form_groups, sort_rooms
from situgraph.matching.hypotheses import (
    copy_box,
    join,
    next_pair_box,
    next_plain_box,
    pair_box,
    pair_of,
    pairs_of,
    split,
)
from situgraph.matching.peaks import climb, feasible, optimum
from situgraph.matching.plain import plain_pair
from situgraph.matching.records import scratch
from situgraph.matching.represented import represented
from situgraph.matching.tables import BOXES, CUT, PEAKS, TRIED, WORK
from situgraph.matching.views import (
    fixes,
    look,
)

ROUNDS = 8  # of shrinking one box
GAIN = 0.8  # a round that leaves more of the box is the last
GUESSES = 3  # least squares from relaxed correspondences
JOINED = 0.3  # half widths of a box put together of several, at most, metres
NEAR = 1.0  # candidates nearer to a box than this may represent it, metres


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


@part
def search(case):
    """Find the peaks of all feasible placements for one shift of the storeys."""
    seen, plan, spans, task, groups = case.seen, case.plan, case.spans, case.task, case.groups
    rooms = len(seen.storey)
    made = form_groups(case, rooms - task.least + 1)
    lay(case)
    for g in range(made):
        r = groups.member[groups.first[g]]
        storey = task.storeys[seen.storey[r]]
        for m in range(rooms):
            spans.required[m] = 0
        for m in range(groups.first[g], groups.first[g + 1]):
            spans.required[groups.member[m]] = 1
        if storey < 0:
            continue
        sort_rooms(case, r)
        for a in range(len(plan.storey)):
            if plan.storey[a] == storey and may_be(case, r, a) and not _exhausted(case):
                _hypotheses(case, g, r, a)
    if made < rooms - task.least + 1:
        _corridors(case, made)


@part
def _hypotheses(case, g, r, a):
    """All placements at which a pair of crossing planes of ``r`` finds ``a``, for group ``g``."""
    plan, found = case.plan, case.found
    box = scratch(SIDES)
    if plain_pair(case, r, a):
        _plain(case, g, r, a, box)
        return
    pairs, reach = pairs_of(case, r)
    waiting = 0
    for c in range(pairs):
        if _exhausted(case):
            return
        i, k = pair_of(case, r, c)
        found.count[WORK] += (plan.first[a + 1] - plan.first[a]) ** 2 // 4
        at = next_pair_box(case, r, i, k, a, 0, reach, box)
        while at >= 0:
            slack = slack_of(box, 0.0, 0.0)
            may = may_explain(case, r, a, box[YAW], box[PX], box[PY], slack)
            if may and (reach <= case.limits.fit or narrow(case, box, r, a)):
                if waiting == len(found.waiting):
                    _try_waiting(case, g, waiting)
                    waiting = 0
                waiting = _gather(case, box, waiting)
            at = next_pair_box(case, r, i, k, a, at, reach, box)
    _try_waiting(case, g, waiting)


@part
def _plain(case, g, r, a, box):
    """The same for plain rooms: at most four boxes for each quarter turn."""
    at = next_plain_box(case, r, a, 0, box)
    while at >= 0:
        _try(case, g, box)
        at = next_plain_box(case, r, a, at, box)


@part
def _gather(case, box, waiting):
    """Put a box to those that wait: into one that it lies beside, or as one more.

    The corners of a room find nearly the same placements, and their partners need one look only.
    Returns how many wait then.
    """
    for k in range(waiting):
        if join(case.found.waiting[k], box, JOINED):
            return waiting
    copy_box(box, case.found.waiting[waiting])
    return waiting + 1


@part
def _try_waiting(case, g, waiting):
    """Search the boxes that wait, but for those in which a partner cannot be explained."""
    for k in range(waiting):
        _try(case, g, case.found.waiting[k])


@part
def _try(case, g, start):
    """Search a box, but for one in which too few rooms can be explained; it stays as it is."""
    if _exhausted(case):
        return
    box = scratch(SIDES)
    copy_box(start, box)
    case.found.count[TRIED] += 1
    if partners_lie(case, box, g) and _partners(case, box, g) and enough(case, box, g):
        explore(case, box)


@part
def _exhausted(case):
    """Whether the search must be cut short."""
    count, limits = case.found.count, case.limits
    if count[BOXES] <= limits.max_boxes and count[WORK] <= limits.max_work:
        return False
    count[CUT] = 1
    return True


@part
def _partners(case, box, g):
    """Whether the other rooms of group ``g`` may be explained somewhere in the box."""
    groups = case.groups
    for k in range(groups.first[g] + 1, groups.first[g + 1]):
        if not possible(case, box, groups.member[k]):
            return False
    return True


@part
def _corridors(case, anchors):
    """Placements that explain no room but such of parallel planes: two of them in two directions.

    All anchors are unexplained then, so of this many corridors one at least is explained.
    """
    seen, limits, spans, task = (
        case.seen,
        case.limits,
        case.spans,
        case.task,
    )
    rooms = len(seen.storey)
    needed = rooms - task.least - anchors + 1
    box = scratch(SIDES)
    for r in range(rooms):
        if not seen.flat[r] or needed <= 0:
            continue
        needed -= 1
        for q in range(rooms):
            turn = abs(math.sin(seen.angle[seen.first[r]] - seen.angle[seen.first[q]]))
            # Of two directions that differ by the least sine, one differs half as
            # much from any third.
            if not seen.flat[q] or turn < 0.45 * limits.sine:
                continue
            for m in range(rooms):
                spans.required[m] = 0
            spans.required[r] = 1
            spans.required[q] = 1
            _crossing(case, r, q, box)


@part
def _crossing(case, r, q, box):
    """All placements that explain the corridors ``r`` and ``q``."""
    seen, plan, task = case.seen, case.plan, case.task
    one, two = task.storeys[seen.storey[r]], task.storeys[seen.storey[q]]
    i, k = seen.first[r], seen.first[q]
    box[AX], box[AY] = seen.center[r, 0], seen.center[r, 1]
    wx, wy = seen.center[q, 0] - box[AX], seen.center[q, 1] - box[AY]
    for a in range(len(plan.storey)):
        if plan.storey[a] != one or not may_be(case, r, a):
            continue
        for b in range(len(plan.storey)):
            if _exhausted(case):
                return
            if plan.storey[b] != two or not may_be(case, q, b):
                continue
            for j in range(plan.first[a], plan.first[a + 1]):
                for m in range(plan.first[b], plan.first[b + 1]):
                    if not pair_box(case, i, k, j, m, wx, wy, case.limits.fit, box):
                        continue
                    case.found.count[TRIED] += 1
                    slack = slack_of(box, 0.0, 0.0)
                    if may_explain(case, r, a, box[YAW], box[PX], box[PY], slack):
                        explore(case, box)


@part
def explore(case, start):
    """Branch and bound: until all of the box is known to be infeasible.

    Or represented by a peak.
    """
    seen, limits = case.seen, case.limits
    arm = 1.0
    for r in range(len(seen.storey)):
        arm = max(arm, math.hypot(seen.center[r, 0], seen.center[r, 1]))
    found = case.found
    stack, box, at = found.stack, scratch(SIDES), scratch(3)
    copy_box(start, stack[0])
    depth = 1
    while depth > 0:
        depth -= 1
        copy_box(stack[depth], box)
        found.count[BOXES] += 1
        if _exhausted(case):
            break
        if found.count[PEAKS] > len(found.peak):  # to be searched again with more room
            break
        if not _squeeze(case, box, arm):
            continue
        if box[AX] != 0.0 or box[AY] != 0.0:
            _move_anchor(box)
            if not _squeeze(case, box, arm):
                continue
        if _known(case, box):
            continue
        before = found.count[PEAKS]
        state = _witness(case, box, arm, at)
        if state < 0:
            continue
        if state > 0:
            height = climb(case, at)
            add_peak(case, at, height)
            if found.count[PEAKS] > before and _known(case, box):
                continue
        side, widest = 0, box[TURN] * arm
        if box[HU] > widest:
            side, widest = 1, box[HU]
        if box[HV] > widest:
            side, widest = 2, box[HV]
        if widest < (limits.peak_step if state > 0 else limits.smallest_step) / 2:
            continue
        if depth + 2 > len(stack):
            found.count[CUT] = 1
            continue
        split(box, side, stack[depth], stack[depth + 1])
        depth += 2


@part
def _move_anchor(box):
    """Anchor the box at the mean room centre instead: it holds what it held, and more."""
    at = scratch(3)
    _centre(box, at)
    wx, wy = at[1] - box[PX], at[2] - box[PY]
    slack = slack_of(box, wx, wy)
    box[HU], box[HV] = give(slack, box[UX], box[UY]), give(slack, -box[UY], box[UX])
    box[PX], box[PY] = at[1], at[2]
    box[AX] = box[AY] = 0.0


@part
def _squeeze(case, box, arm):
    """Shrink a box while it pays; False when nothing is left."""
    for _ in range(ROUNDS):
        before = box[TURN] * arm + box[HU] + box[HV]
        if not shrink(case, box):
            return False
        if box[TURN] * arm + box[HU] + box[HV] > GAIN * before:
            break
    return True


@part
def _centre(box, out):
    """The placement (yaw, x, y of the mean room centre) in the middle of a box."""
    c, s = math.cos(box[YAW]), math.sin(box[YAW])
    out[0] = wrapped(box[YAW])
    out[1] = box[PX] - c * box[AX] + s * box[AY]
    out[2] = box[PY] - s * box[AX] - c * box[AY]


@part
def _known(case, box):
    """Whether a peak represents all feasible placements of the box."""
    limits = case.limits
    found, middle = case.found, scratch(3)
    _centre(box, middle)
    sway = radius(box) + 2 * math.sin(box[TURN] / 2) * math.hypot(box[AX], box[AY])
    for k in range(min(found.count[PEAKS], len(found.peak))):
        at = found.peak[k]
        apart = math.hypot(at[1] - middle[1], at[2] - middle[2])
        turned = abs(wrapped(at[0] - middle[0]))
        if apart + sway <= limits.same_distance and turned + box[TURN] <= limits.same_yaw:
            return True
        near = apart <= NEAR + sway and turned <= limits.same_yaw + box[TURN]
        if near and represented(case, box, at):
            return True
    return False


@part
def _witness(case, box, arm, at):
    """Look for a feasible placement in or near the box: 1 found, 0 not found, -1 none can be.

    It is left in ``at``. The last is known from the correspondences with all residuals widened by
    what the box allows.
    """
    task = case.task
    _centre(box, at)
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
        optimum(case, case.one, at, at)
        if feasible(case, case.one, at):
            return 1
        loose /= 2
    return 0
