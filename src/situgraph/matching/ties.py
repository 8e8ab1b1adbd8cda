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
        for q in range(r):
            for i in range(seen.first[r], seen.first[r + 1]):
                for k in range(seen.first[q], seen.first[q + 1]):
                    if abs(cross(t.normal, i, k)) <= least and _tied(t, r, q, i, k):
                        count += join(group, i, k)
    return count


@part
def _tied(t, r, q, i, k):
    """Whether the parallel walls ``i`` of room ``r`` and ``k`` of room ``q`` stand as one wall."""
    seen, normal, limits = t.seen, t.normal, t.limits
    # Both lines are read halfway between the two rooms.
    x = (seen.center[q, 0] - seen.center[r, 0]) / 2
    y = (seen.center[q, 1] - seen.center[r, 1]) / 2
    one = seen.distance[i] + normal[i, 0] * x + normal[i, 1] * y
    two = seen.distance[k] - normal[k, 0] * x - normal[k, 1] * y
    if normal[i, 0] * normal[k, 0] + normal[i, 1] * normal[k, 1] > 0.0:
        return abs(one - two) <= limits.fit
    return -limits.fit <= -(one + two) <= limits.thickness
