"""Disjoint groups of online rooms, one of which every feasible placement explains as a whole.

A feasible placement leaves at most N - K rooms unexplained, so of N - K + 1 disjoint groups at
least one is explained wholly. Each group has an anchor, from which placements are hypothesised,
and partners near it, which reject most of them at once.
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

from typing import NamedTuple

import numpy as np

from situgraph.matching.compiled import kernel
from situgraph.matching.pointers import read
from situgraph.matching.tables import Ints


class Groups(NamedTuple):
    """``member[first[g]:first[g + 1]]`` are the rooms of group ``g``, its anchor first."""

    first: Ints
    member: Ints


@kernel
def form_groups(case, rarity, count):
    """At most ``count`` groups around rooms whose planes are not parallel, the rarest first.

    ``rarity`` (N,) tells how many prior rooms are alike. There are fewer groups when fewer rooms
    can be anchors.
    """
    seen = read(case.seen)
    rooms = len(seen.storey)
    group = np.full(rooms, -1, dtype=np.int64)
    anchors = np.empty(rooms, dtype=np.int64)
    made = 0
    while made < count:
        best = -1
        for r in range(rooms):
            if not seen.flat[r] and group[r] < 0 and (best < 0 or rarity[r] < rarity[best]):
                best = r
        if best < 0:
            break
        group[best] = made
        anchors[made] = best
        made += 1
    first = np.zeros(made + 1, dtype=np.int64)
    member = np.empty(rooms, dtype=np.int64)
    for g in range(made):
        first[g + 1] = 1
    left = rooms - made
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
    return Groups(first, member)


@kernel
def _apart(case, one, two):
    seen = read(case.seen)
    x = seen.center[one, 0] - seen.center[two, 0]
    y = seen.center[one, 1] - seen.center[two, 1]
    return x * x + y * y


@kernel
def _nearest(case, anchor, group):
    best = -1
    for r in range(len(group)):
        if group[r] < 0 and (best < 0 or _apart(case, anchor, r) < _apart(case, anchor, best)):
            best = r
    return best
