"""What Python calls: all peaks of a match."""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from situgraph.matching.blocks import Block, Laid
from situgraph.matching.boxes import SIDES
from situgraph.matching.cases import Tables
from situgraph.matching.compiled import entry, part
from situgraph.matching.containment import room_allowed
from situgraph.matching.hypotheses import fits_somewhere
from situgraph.matching.plain import is_plain, mark_whole, whole
from situgraph.matching.records import record_at
from situgraph.matching.search import outline, search
from situgraph.matching.tables import (
    ANYWHERE,
    HELD,
    LEFT,
    PEAKS,
    SETTLED,
    STAGE,
    Aim,
    Case,
    Floats,
    Ints,
    IntTable,
    Table,
)
from situgraph.matching.traces import Start, Traces, recall, traces_of
from situgraph.matching.views import look, unexplained

ROOM, PEAKS_A_ROOM = 64, 2  # for peaks, to begin with: at least, for each prior room
COVER, MOST_COVER = 8, 4096  # boxes of a cover: for each prior room, at most


class Search(NamedTuple):
    """A search for all shifts of the storeys."""

    case: Case
    shifts: IntTable  # (k, U)
    shift: Annotated[Ints, "peaks"]
    place: Annotated[Floats, "peaks", 5]  # 0, yaw, x, y, L
    count: Annotated[Ints, 9]  # type: ignore[assignment]  # ``PEAKS`` to ``SETTLED``
    left: Annotated[Floats, "boxes", "sides"]  # the cover
    left_shift: Annotated[Ints, "boxes"]
    known: Table  # (g, SIDES) the cover of an earlier search
    known_first: Ints  # (shifts + 1,) where that of each shift begins; empty without one
    wanted: int  # groups of new rooms


def find_peaks(
    tables: Tables,
    shifts: Ints,
    aim: Aim,
    start: Start | None = None,
    *,
    traced: bool = False,
    former: Ints | None = None,
    shared: bool = False,
) -> tuple[Floats, Ints, Ints, Ints, Laid, Traces | None]:
    """All peaks (k, 5) for all shifts of the storeys: 0, yaw, x, y, L; and the rows of ``shifts``.

    And how many prior rooms are like each online room; what was done: peaks, hypotheses, boxes, 1
    when incomplete, comparisons of planes, boxes left; the ``Case``, which may be worked in again;
    and, where ``traced``, what a later search can start from. Maps may be ``shared`` with a search
    for the mirror image, to which they are those of the ``former``.
    """
    most = max(ROOM, PEAKS_A_ROOM * len(tables.plan.storey))
    boxes = min(COVER * (len(tables.plan.storey) + COVER), MOST_COVER) if traced else 0
    given = tables.given(aim) | {"former": former}
    known, first, wanted = None, None, 0
    if start is not None and start.on:
        known, first, wanted = start.cover, start.first, start.wanted
    maps = len(shifts) if traced else 1
    while True:
        sizes = tables.sizes(peaks=most, boxes=boxes, maps=maps, shared=shared)
        block = Block(
            Search, sizes, shifts=shifts, known=known, known_first=first, wanted=wanted, **given
        )
        if start is not None:
            recall(block, start)
        search_all(block.place)
        count: Ints = block.array("count").copy()
        if count[PEAKS] <= most:
            found = int(count[PEAKS])
            place, shift = block.array("place")[:found].copy(), block.array("shift")[:found].copy()
            alike: Ints = block.array("case.found.alike").copy()
            traces = traces_of(block, len(shifts)) if traced else None
            return place, shift, alike, count, block.record("case"), traces
        most *= 16


@entry
def search_all(place):
    """Fill a ``Search``."""
    _search_all(record_at(place, Search))


@part
def _search_all(wanted):
    case = wanted.case
    task, found = case.task, case.found
    _shapes_alike(case)
    _weigh_others(case)
    kept = left = 0
    for z in range(len(wanted.shifts)):
        for u in range(len(task.storeys)):
            task.storeys[u] = wanted.shifts[z, u]
        found.count[PEAKS] = found.count[LEFT] = found.count[HELD] = found.count[SETTLED] = 0
        found.count[STAGE] = ANYWHERE
        _turn_to_maps(case, z)
        if len(wanted.known_first) > 0:
            begin, end = wanted.known_first[z], wanted.known_first[z + 1]
            outline(case, wanted.known, begin, end, wanted.wanted)
        search(case)
        for k in range(found.count[PEAKS]):
            if kept < len(wanted.shift) and k < len(found.peak):
                wanted.shift[kept] = z
                for c in range(4):
                    wanted.place[kept, c + 1] = found.peak[k, c]
                wanted.place[kept, 4] += _rest(case, found.peak[k], found.rest[k])
            kept += 1
        for k in range(found.count[LEFT]):
            if left < len(wanted.left) and k < len(found.cover):
                wanted.left_shift[left] = z
                for c in range(SIDES):
                    wanted.left[left, c] = found.cover[k, c]
            left += 1
    for k in range(len(wanted.count)):
        wanted.count[k] = found.count[k]
    wanted.count[PEAKS], wanted.count[LEFT] = kept, left


@part
def _turn_to_maps(case, z):
    """Maps of the shift ``z``; where only those of one are kept, they are drawn again."""
    ground, rooms = case.ground, len(case.seen.storey)
    if z > 0 and len(ground.drawn) == rooms:
        for r in range(rooms):
            ground.drawn[r] = 0
    else:
        ground.part[0] = z * rooms


@part
def _weigh_others(case):
    """What each room says where it is not explained: it may be one like those of the plan."""
    seen, limits, found = case.seen, case.limits, case.found
    for r in range(len(found.other)):
        found.other[r] = 0.0
        if seen.shape[r] > 0:
            share = limits.other_room * found.alike[r] / len(case.plan.storey)
            found.other[r] = math.log1p(share * limits.shape_gain ** seen.shape[r])


@part
def _rest(case, peak, known):
    """What the rooms say that are not explained at a peak, looked at where that is not known.

    One so high explains all.
    """
    seen, limits = case.seen, case.limits
    rooms = len(seen.storey)
    most = seen.planes * limits.fit_peak + (rooms - 1) * limits.room_true + limits.room_false
    if case.task.least == rooms or peak[3] > most:
        return 0.0
    if not math.isnan(known):
        return known
    look(case, case.one, peak[0], peak[1], peak[2], 0.0, 0.0)
    return unexplained(case, case.one)


@part
def _shapes_alike(case):
    """Mark, for each online room, the allowed prior rooms that explain it in isolation.

    They are counted for rooms of more than two planes; of the others none is excluded.
    """
    seen, plan, alike, like = case.seen, case.plan, case.found.alike, case.found.like
    asked = len(case.content.room_need) > 0 or len(case.content.row_need) > 0
    for r in range(len(seen.storey)):
        if case.task.judged[r]:
            continue
        few = seen.first[r + 1] - seen.first[r] < 3
        by_width = not few and not asked and is_plain(case, r)
        if by_width:
            alike[r] = mark_whole(case, r)
        for a in range(len(plan.storey)):
            if by_width and whole(case, a):
                continue
            if room_allowed(case, r, a) and (few or fits_somewhere(case, r, a)):
                like[r, a >> 6] |= 1 << (a & 63)
                if not few:
                    alike[r] += 1
