"""How much a search may do: boxes, and steps about as long as a comparison of two planes.

What a kernel does is counted where it is done, so that the answer does not depend on the machine.
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

from situgraph.matching.compiled import part
from situgraph.matching.tables import BOXES, CUT, PEAKS, WORK


@part
def count_pairs(case, r, a):
    """Count that all planes of online room ``r`` are held against all of prior room ``a``."""
    seen, plan = case.seen, case.plan
    planes, rows = seen.first[r + 1] - seen.first[r], plan.first[a + 1] - plan.first[a]
    case.found.count[WORK] += planes * rows


@part
def exhausted(case):
    """Whether the search must end here: cut short, or begun again with more room for peaks."""
    count, limits = case.found.count, case.limits
    if count[PEAKS] > len(case.found.peak):
        return True
    if count[BOXES] <= limits.max_boxes and count[WORK] <= limits.max_work:
        return False
    count[CUT] = 1
    return True
