"""The best assignment of the planes of a room that has many, by shortest augmenting paths.

That at most one plane is missing is one more counterpart, which only one plane can have. So this
is the plain assignment problem (Jonker and Volgenant's method, on the counterparts alone).
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math

from situgraph.matching.compiled import part
from situgraph.matching.tables import WORK

UNMET, OPEN, DONE = range(3)  # a counterpart in a search for a path


@part
def assign_planes(case, n, a):
    """Choose a counterpart for each plane on the bench (into ``pick``), all distinct.

    Returns whether there is such a choice.
    """
    bench, plan = case.bench, case.plan
    columns = plan.first[a + 1] - plan.first[a] + 1
    for j in range(columns):
        bench.owner[j] = -1
        bench.price[j] = 0.0
        bench.done[j] = UNMET
    for i in range(n):  # noqa: SIM110
        if not _add_plane(case, i, plan.first[a], columns):
            return False
    return True


@part
def _add_plane(case, start, first, columns):
    """Find the cheapest path from plane ``start`` to a free counterpart, and exchange along it."""
    bench = case.bench
    i, length, end, met = start, 0.0, -1, 0
    bench.rent[start] = 0.0
    while end < 0:
        for k in range(bench.count[i]):
            row = bench.row[i, k]
            j = row - first if row >= 0 else columns - 1
            if bench.done[j] == UNMET:
                bench.done[j], bench.near[j] = OPEN, math.inf
                bench.close[met] = j
                met += 1
            reach = length - bench.value[i, k] - bench.rent[i] - bench.price[j]
            if bench.done[j] == OPEN and reach < bench.near[j]:
                bench.near[j] = reach
                bench.way[j] = i
                bench.choice[j] = k
        best = _nearest(bench, met)
        case.found.count[WORK] += met + bench.count[i]
        if best < 0:
            break
        length = bench.near[best]
        bench.done[best] = DONE
        if bench.owner[best] < 0:
            end = best
        else:
            i = bench.owner[best]
    bench.rent[start] += length
    for m in range(met):
        j = bench.close[m]
        if bench.done[j] == DONE and j != end and end >= 0:
            bench.rent[bench.owner[j]] += length - bench.near[j]
            bench.price[j] -= length - bench.near[j]
        bench.done[j] = UNMET
    if end < 0:
        return False
    i = -1
    while i != start:
        i = bench.way[end]
        bench.owner[end] = i
        bench.pick[i] = bench.choice[end]
        following = bench.column[i]
        bench.column[i] = end
        end = following
    return True


@part
def _nearest(bench, met):
    """The counterpart nearest by of those met and not done, -1 when there is none."""
    best = -1
    for m in range(met):
        j = bench.close[m]
        if bench.done[j] == OPEN and (
            best < 0
            or bench.near[j] < bench.near[best]
            or (bench.near[j] == bench.near[best] and j < best)
        ):
            best = j
    return best
