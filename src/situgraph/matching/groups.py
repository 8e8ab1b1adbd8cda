"""Disjoint groups of online rooms, one of which every feasible placement explains as a whole.

A feasible placement leaves at most N - K rooms unexplained, so of N - K + 1 disjoint groups at
least one is explained wholly. Each group has an anchor, from which placements are hypothesised,
and partners near it, which reject most of them at once.
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math

from situgraph.matching.compiled import part

FREE, ASIDE = -1, -2  # rooms of no group: that may go to one, and that may not


@part
def form_groups(case, count, fresh):
    """At most ``count`` groups around rooms whose planes are not parallel, the rarest first.

    ``fresh``: only of rooms that no earlier search knew. Returns how many; there are fewer when
    fewer rooms can be anchors.
    """
    seen, groups = case.seen, case.groups
    rooms = len(seen.storey)
    group, anchors, first, member = groups.group, groups.anchor, groups.first, groups.member
    left = 0
    for r in range(rooms):
        group[r] = FREE
        if fresh and case.task.judged[r]:
            group[r] = ASIDE
        else:
            left += 1
    made = 0
    while made < count:
        best = -1
        for r in range(rooms):
            if (
                not seen.flat[r]
                and group[r] == FREE
                and (best < 0 or _effort(case, r) < _effort(case, best))
            ):
                best = r
        if best < 0:
            break
        group[best] = made
        anchors[made] = best
        made += 1
    first[0] = 0
    for g in range(made):
        first[g + 1] = 1
    left -= made
    while left > 0 and made > 0:
        for g in range(made):
            near = _nearest(case, anchors[g], group)
            if near >= 0:
                group[near] = g
                first[g + 1] += 1
                left -= 1
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
    return made


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
    groups.told[0] = count


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
def _nearest(case, anchor, group):
    best = -1
    for r in range(len(group)):
        if group[r] == FREE and (best < 0 or _apart(case, anchor, r) < _apart(case, anchor, best)):
            best = r
    return best
