"""The search for all candidates: section 7 of ``docs/matching.md``."""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math

from situgraph.matching.boxes import (
    AX,
    AY,
    PX,
    PY,
    SIDES,
    YAW,
    confine,
    move_anchor,
    narrow,
    slack_of,
    squeeze,
)
from situgraph.matching.compiled import part
from situgraph.matching.containment import may_be
from situgraph.matching.cover import (
    far_off,
    far_room,
    keep_region,
    longest_arm,
    sight,
)
from situgraph.matching.effort import exhausted
from situgraph.matching.explained import may_explain
from situgraph.matching.explore import explore, settles_at_once
from situgraph.matching.ground import enough, enough_in_middle, lay, partners_lie
from situgraph.matching.groups import NOWHERE, form_groups, sort_rooms
from situgraph.matching.hypotheses import (
    copy_box,
    join,
    next_pair_box,
    next_plain_box,
    pair_box,
    pair_of,
    pairs_of,
)
from situgraph.matching.nearby import forget_peaks
from situgraph.matching.plain import plain_pair
from situgraph.matching.records import scratch
from situgraph.matching.settled import settled_by
from situgraph.matching.sieve import sift
from situgraph.matching.sifted import may_lie, may_lie_by, sift_for
from situgraph.matching.survey import survey
from situgraph.matching.tables import (
    ANYWHERE,
    HELD,
    KEPT,
    MADE,
    OUTLINING,
    PEAKS,
    SIFTED,
    STAGE,
    TRIED,
    WITHIN,
    WORK,
)
from situgraph.matching.wards import reclaim

TRIAL = 12  # comparisons of planes that a box is worth of which maps tell that it is none, about
JOINED = 0.3  # half widths of a box put together of several, at most, metres


@part
def search(case):
    """Find the peaks of all feasible placements for one shift of the storeys."""
    if case.found.count[STAGE] == WITHIN and case.found.count[HELD] == 0:
        return
    forget_peaks(case)
    _line_up(case)
    lost = _form_groups(case)
    _search_groups(case)
    if lost <= case.task.budget:
        _corridors(case, lost)
    _reconsider(case)


@part
def _reconsider(case):
    """Search again what peaks stood for of which higher ones were found later."""
    box, found = scratch(SIDES), case.found
    for m in range(len(case.seen.storey)):
        case.spans.required[m] = 0
    changed = True
    while changed:
        changed = False
        for k in range(min(found.count[PEAKS], len(found.peak))):
            if not exhausted(case) and reclaim(case, k, box):
                explore(case, box)
                changed = True


@part
def outline(case, cover, begin, end, wanted):
    """Where feasible placements can be, after an earlier search left a cover: into ``region``.

    The cover are its boxes ``begin`` to ``end``; a feasible placement outside of it explains one of
    ``wanted`` groups of rooms that are new.
    """
    count = case.found.count
    count[STAGE] = OUTLINING
    for m in range(len(case.seen.storey)):
        case.spans.required[m] = 0
    _line_up(case)
    for k in range(begin, end):
        _hold(case, cover[k])
    if wanted > 0:
        _form_groups(case)  # by which it is told whether to sift
        form_groups(case, wanted - 1.0, True)
        _search_groups(case)
    count[STAGE] = WITHIN if count[HELD] <= len(case.found.region) else ANYWHERE


@part
def _form_groups(case):
    """The groups of which a placement explains one, and where their rooms may lie.

    Returns what ``form_groups`` does.
    """
    lost = form_groups(case, case.task.budget, False)
    lay(case)
    sift(case)
    return lost


@part
def _line_up(case):
    """The rooms in any order to begin with."""
    for r in range(len(case.spans.order)):
        case.spans.order[r] = r


@part
def _hold(case, start):
    """Add to the region what may be feasible of a box."""
    box, arm = scratch(SIDES), longest_arm(case)
    copy_box(start, box)
    if squeeze(case, box, arm):
        move_anchor(box)
        if squeeze(case, box, arm):
            keep_region(case, box, arm)


@part
def _search_groups(case):
    """All placements that explain one of the groups."""
    seen, plan, spans, task, groups = case.seen, case.plan, case.spans, case.task, case.groups
    rooms, told = len(seen.storey), case.sieve.told
    if told[SIFTED] and told[KEPT] == 0:
        return
    for g in range(groups.told[MADE]):
        r = groups.member[groups.first[g]]
        storey = task.storeys[seen.storey[r]]
        for m in range(rooms):
            spans.required[m] = 0
        for m in range(groups.first[g], groups.first[g + 1]):
            spans.required[groups.member[m]] = 1
        if storey < 0:
            continue
        sort_rooms(case, r)
        sift_for(case, g)
        case.found.count[WORK] += len(plan.storey)
        if case.found.count[STAGE] == WITHIN:
            sight(case, r)
        for a in range(len(plan.storey)):
            if plan.storey[a] == storey and may_be(case, r, a) and not exhausted(case):
                _hypotheses(case, g, r, a)


@part
def _hypotheses(case, g, r, a):
    """All placements at which a pair of crossing planes of ``r`` finds ``a``, for group ``g``."""
    plan, found = case.plan, case.found
    box = scratch(SIDES)
    if plain_pair(case, r, a):
        near = found.count[STAGE] != WITHIN or not far_room(case, r, a)
        if near and may_lie_by(case, r, a):
            _plain(case, g, r, a, box)
        return
    pairs, reach = pairs_of(case, r)
    waiting = 0
    for c in range(pairs):
        if exhausted(case):
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
    count = case.found.count
    if exhausted(case) or (count[STAGE] == WITHIN and far_off(case, start)):
        return
    count[TRIED] += 1
    count[WORK] += TRIAL
    if not may_lie(case, start):
        return
    box = scratch(SIDES)
    copy_box(start, box)
    if not partners_lie(case, box, g) or settled_by(case, box):
        return
    if not _partners(case, box, g) or settled_by(case, box):
        return
    outlining = count[STAGE] == OUTLINING
    if not outlining and enough_in_middle(case, start, g) and settles_at_once(case, start):
        return
    if not enough(case, box, g) or settled_by(case, box):
        return
    copy_box(start, box)  # where its middle lies decides which peaks are found: searched uncut
    if enough(case, box, g):
        if outlining:
            _hold(case, box)
        else:
            peaks = count[PEAKS]
            explore(case, box)
            if count[PEAKS] > peaks:
                survey(case, g, peaks)


@part
def _partners(case, box, g):
    """Cut from a box where a partner of group ``g`` cannot be explained; False if that is all."""
    for k in range(case.groups.first[g] + 1, case.groups.first[g + 1]):
        if not confine(case, box, case.groups.member[k]):
            return False
    return True


@part
def _corridors(case, lost):
    """Placements that explain no room but such of parallel planes: two of them in two directions.

    All others are unexplained then, which lose so much; of as many corridors as lose more with
    them than the budget, one at least is explained.
    """
    seen, limits, spans, task = (
        case.seen,
        case.limits,
        case.spans,
        case.task,
    )
    rooms = len(seen.storey)
    box = scratch(SIDES)
    for r in range(rooms):
        if not seen.flat[r] or case.groups.group[r] == NOWHERE or lost > task.budget:
            continue
        lost += task.loss[r]
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
        case.found.count[WORK] += len(plan.storey)
        for b in range(len(plan.storey)):
            if exhausted(case):
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
