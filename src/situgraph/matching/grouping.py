"""Sets that are put together: ``group[i]`` leads from each member to the first of its set."""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

from situgraph.matching.compiled import part


@part
def first_of(group, i):
    """The first member of the set of ``i``."""
    while group[i] != i:
        i = group[i]
    return i


@part
def join(group, i, k):
    """Put the sets of ``i`` and ``k`` together; whether they were two."""
    i, k = first_of(group, i), first_of(group, k)
    group[max(i, k)] = min(i, k)
    return i != k
