"""Disjoint groups of online rooms, one of which every feasible placement explains as a whole.

A feasible placement leaves at most N - K rooms unexplained, so of N - K + 1 disjoint groups at
least one is explained wholly. So it is where rooms lose unequally, once the groups together lose
more than a placement may. Each group has an anchor, from which placements are hypothesised,
and partners near it, which reject most of them at once.
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math

from situgraph.matching.compiled import part
from situgraph.matching.containment import may_be
from situgraph.matching.tables import MADE, MAPPED

FREE, ASIDE, NOWHERE = -1, -2, -3  # of no group: it may go to one, may not, nothing explains it


@part
def form_groups(case, budget, fresh):
    """Groups around rooms whose planes are not parallel, until they lose more than ``budget``.

    Those that save most effort first; ``fresh``: only of rooms that no earlier search knew. Returns
    what the anchors and the rooms that nothing explains lose together. Where that is not more, too
    few rooms can be anchors, and the groups are the anchors alone.
    """
    seen, groups, loss = case.seen, case.groups, case.task.loss
    rooms = len(seen.storey)
    group, anchors, first, member = groups.group, groups.anchor, groups.first, groups.member
    lost, made = 0.0, 0
    for r in range(rooms):
        group[r] = FREE
        if fresh and case.task.judged[r]:
            group[r] = ASIDE
        elif not _somewhere(case, r):
            group[r] = NOWHERE
            lost += loss[r]
    while lost <= budget:
        best, least = -1, math.inf
        for r in range(rooms):
            if not seen.flat[r] and group[r] == FREE:
                effort = _effort(case, r) / loss[r]
                if effort < least:
                    best, least = r, effort
        if best < 0:
            break
        group[best] = made
        anchors[made] = best
        lost += loss[best]
        made += 1
    groups.told[MADE] = made
    first[0] = 0
    for g in range(made):
        first[g + 1] = 1
    joined = lost > budget
    while joined:
        joined = False
        for g in range(made):
            near = _nearest(case, anchors[g])
            if near >= 0:
                group[near] = g
                first[g + 1] += 1
                joined = True
    for g in range(made):
        first[g + 1] += first[g]
        member[first[g]] = anchors[g]
        at = first[g] + 1
        for r in range(rooms):
            if group[r] == g and r != anchors[g]:
                k = at
                while k > first[g] + 1 and _apart(case, anchors[g], member[k - 1]) > _apart(
                    case, anchors[g], r
                ):
                    member[k] = member[k - 1]
                    k -= 1
                member[k] = r
                at += 1
    return lost


@part
def sort_rooms(case, anchor):
    """Into ``groups.order`` the rooms that have a map, the nearest to the anchor first."""
    groups, count = case.groups, 0
    for r in range(len(groups.order)):
        if not case.ground.known[r]:
            continue
        away, k = math.sqrt(_apart(case, anchor, r)), count
        while k > 0 and groups.apart[k - 1] > away:
            groups.apart[k] = groups.apart[k - 1]
            groups.order[k] = groups.order[k - 1]
            k -= 1
        groups.apart[k] = away
        groups.order[k] = r
        count += 1
    groups.told[MAPPED] = count
    center = case.seen.center
    for k in range(count):
        r = groups.order[k]
        groups.arm[k, 0] = center[r, 0] - center[anchor, 0]
        groups.arm[k, 1] = center[r, 1] - center[anchor, 1]


@part
def _effort(case, r):
    """About how many hypotheses room ``r`` makes as an anchor."""
    seen = case.seen
    planes = seen.first[r + 1] - seen.first[r]
    alike = case.found.alike[r] if planes > 2 else len(case.plan.storey)
    return alike * planes * planes


@part
def _apart(case, one, two):
    seen = case.seen
    x = seen.center[one, 0] - seen.center[two, 0]
    y = seen.center[one, 1] - seen.center[two, 1]
    return x * x + y * y


@part
def _nearest(case, anchor):
    """The nearest room that is in no group yet, and by which the group would lose no less."""
    group, loss, best = case.groups.group, case.task.loss, -1
    for r in range(len(group)):
        if group[r] != FREE or loss[r] < loss[anchor]:
            continue
        if best < 0 or _apart(case, anchor, r) < _apart(case, anchor, best):
            best = r
    return best


@part
def _somewhere(case, r):
    """Whether any prior room of its storey explains a room in isolation."""
    plan, storey = case.plan, case.task.storeys[case.seen.storey[r]]
    if storey >= 0:
        for a in range(len(plan.storey)):
            if plan.storey[a] == storey and may_be(case, r, a):
                return True
    return False
