"""How rooms stand wall to wall: definition, section 4, outside the plan."""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math

from situgraph.matching.compiled import part
from situgraph.matching.grouping import join


@part
def cross(normal, i, k):
    """The sine of the angle from one of the normals (P, 2) to another."""
    return normal[i, 0] * normal[k, 1] - normal[i, 1] * normal[k, 0]


@part
def ties(t):
    """How many of the walls' places of a ``Drafting`` say nothing new, as rooms stand wall to wall.

    Walls of two rooms tie the rooms when they are parallel and stand on one line, or back to back
    and no farther apart than a wall is thick. Counted are those that join what no other has
    joined, along each direction by itself.
    """
    seen, group, least = t.seen, t.tie, math.sin(t.limits.angle)
    for i in range(len(group)):
        group[i] = i
    for r in range(len(seen.storey)):
        for i in range(seen.first[r], seen.first[r + 1]):
            for k in range(seen.first[r], i):
                if abs(cross(t.normal, i, k)) <= least:
                    join(group, i, k)
    count = 0
    for r in range(len(seen.storey)):
        for i in range(seen.first[r], seen.first[r + 1]):
            for q in range(r):
                count += _tie(t, r, q, i, least)
    return count


@part
def _tie(t, r, q, i, least):
    """Join wall ``i`` of room ``r`` with the walls of room ``q`` as which it stands; how many."""
    seen, normal, distance, limits, count = t.seen, t.normal, t.seen.distance, t.limits, 0
    # Both lines are read halfway between the two rooms.
    x = (seen.center[q, 0] - seen.center[r, 0]) / 2
    y = (seen.center[q, 1] - seen.center[r, 1]) / 2
    nx, ny = normal[i, 0], normal[i, 1]
    one = distance[i] + nx * x + ny * y
    for k in range(seen.first[q], seen.first[q + 1]):
        mx, my = normal[k, 0], normal[k, 1]
        if abs(nx * my - ny * mx) > least:
            continue
        two = distance[k] - mx * x - my * y
        if nx * mx + ny * my > 0.0:
            tied = abs(one - two) <= limits.fit
        else:
            tied = -limits.fit <= -(one + two) <= limits.thickness
        if tied:
            count += join(t.tie, i, k)
    return count
