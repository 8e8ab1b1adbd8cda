"""What each peak stood for while the search went on, to be looked at again if that was too much.

A box is dropped when a peak represents it, and all peaks of the same place that are not lower do
as well: whichever is the highest becomes the candidate. A higher one can be found later, in
another box, and represent less.
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

from situgraph.matching.compiled import part
from situgraph.matching.cover import nothing_left, spread
from situgraph.matching.hypotheses import copy_box
from situgraph.matching.nearby import TIE, same_place
from situgraph.matching.represented import none_higher, stands_for
from situgraph.matching.tables import PEAKS, WORK


@part
def entrust(case, k, box):
    """Note that a box, anchored at the mean centre, was dropped on account of peak ``k``."""
    ward, since = case.found.ward, case.found.since
    if none_higher(case, k):
        return
    if since[k] == 0:
        nothing_left(ward[k])
        since[k] = case.found.count[PEAKS]
    spread(ward[k], box)


@part
def reclaim(case, k, box):
    """Take from peak ``k`` what it stood for, if a peak found since should and does not.

    It is left in ``box``; False when nothing has to be searched again.
    """
    peaks, ward, since = case.found.peak, case.found.ward, case.found.since
    if since[k] == 0:
        return False
    case.found.count[WORK] += max(0, case.found.count[PEAKS] - since[k]) // 2
    for m in range(since[k], min(case.found.count[PEAKS], len(peaks))):
        if peaks[m, 3] < peaks[k, 3] - TIE or not same_place(case, peaks[k], peaks[m]):
            continue
        if not stands_for(case, m, ward[k]):
            copy_box(ward[k], box)
            since[k] = 0
            return True
    return False
