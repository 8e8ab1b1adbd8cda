"""What Python calls: all peaks of a match, and the correspondences at placements."""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from situgraph.matching.boxes import SIDES
from situgraph.matching.compiled import entry, part
from situgraph.matching.containment import room_allowed
from situgraph.matching.hypotheses import fits_somewhere
from situgraph.matching.peaks import feasible, raised
from situgraph.matching.records import (
    WORD,
    address,
    allocated,
    arranged,
    layout,
    record_at,
    scratch,
    slots_of,
)
from situgraph.matching.represented import add_peak
from situgraph.matching.search import outline, search
from situgraph.matching.tables import (
    ANYWHERE,
    HELD,
    LEFT,
    PEAKS,
    STAGE,
    Aim,
    Bench,
    Case,
    Content,
    Finder,
    Floats,
    Found,
    Ground,
    Groups,
    Ints,
    IntTable,
    Limits,
    Options,
    Pairing,
    Plan,
    Seen,
    Spans,
    Table,
    Tally,
    Task,
    View,
    explaining,
)
from situgraph.matching.traces import Start, Traces, recall, traces_of
from situgraph.matching.views import look

WAITING = 64  # boxes of one pair of rooms that are put together
DEPTH = 256  # of the stack of boxes: each is halved until it is smaller than a millimetre
FOUND = 7  # the place of ``Found`` among the records a case has to work in
GROUND = 8  # and of ``Ground``
KEPT = {  # what is read and written outside of kernels: of which record, whether of two dimensions
    "alike": (FOUND, False),
    "like": (FOUND, True),
    "word": (GROUND, False),
    "base": (GROUND, False),
    "drawn": (GROUND, False),
}
ROOM = 1024  # for peaks, to begin with
COVER, MOST_COVER = 8, 4096  # boxes of a cover: for each prior room, at most


class Search(NamedTuple):
    """A search for all shifts of the storeys."""

    case: Case
    shifts: IntTable  # (k, U)
    shift: Ints  # (c,) of each peak
    place: Table  # (c, 4) yaw, x, y, L
    count: Ints  # type: ignore[assignment]  # (8,) ``PEAKS`` to ``STAGE``
    left: Table  # (k, SIDES) the cover
    left_shift: Ints  # (k,) of each of its boxes
    known: Table  # (g, SIDES) the cover of an earlier search
    known_first: Ints  # (shifts + 1,) where that of each shift begins; empty without one
    wanted: int  # groups of new rooms


class Sights(NamedTuple):
    """Placements to look at; ``View``'s fields, a placement a row."""

    case: Case
    shifts: IntTable
    shift: Ints  # (k,)
    place: Table  # (k, 3)
    room: IntTable
    row: IntTable
    state: IntTable
    offset: Table
    bend: Table


def find_peaks(
    seen: Seen,
    plan: Plan,
    limits: Limits,
    content: Content,
    shifts: Ints,
    aim: Aim,
    start: Start | None = None,
    *,
    traced: bool = False,
) -> tuple[Floats, Ints, Ints, Traces | None]:
    """All peaks (k, 5) for all shifts of the storeys: row of ``shifts``, yaw, x, y, L.

    And how many prior rooms are like each online room; what was done: peaks, hypotheses, boxes, 1
    when incomplete, comparisons of planes, boxes left; and, where ``traced``, what a later search
    can start from.
    """
    most = ROOM
    boxes = min(COVER * (len(plan.storey) + COVER), MOST_COVER) if traced else 0
    known, first, wanted = _NOTHING
    if start is not None and start.on:
        known, first, wanted = start.cover, start.first, start.wanted
    maps = len(shifts) if traced else 1
    while True:
        tables = (seen, plan, limits, content)
        case, kept = _case(*tables, shifts.shape[1], aim, most, boxes=boxes, maps=maps)
        kept["base"][0] = plan.row[0, 3] - seen.angle[0]
        if start is not None:
            recall(kept, start)
        shapes = (0, (0, 0), most, (most, 4), 8, (boxes, SIDES), boxes, (0, 0), 0, 0)
        values, _ = allocated(Search, shapes)
        search = Search(case, shifts, *values[2:7], known, first, wanted)  # type: ignore[call-arg]
        block = slots_of(Search, search)
        search_all(address(block))
        count = search.count
        if count[PEAKS] <= most:
            found = int(count[PEAKS])
            peaks = np.column_stack([search.shift[:found], search.place[:found]])
            alike: Ints = kept["alike"]
            traces = None
            if traced:
                traces = traces_of(kept, count, search.left, search.left_shift, len(shifts))
            return peaks, alike, count, traces
        most *= 16


def views_at(
    seen: Seen,
    plan: Plan,
    limits: Limits,
    content: Content,
    shifts: Ints,
    shift: Ints,
    at: Floats,
) -> View:
    """What is explained when the mean room centre goes to ``at`` (k, 3): yaw, x, y; strictly.

    Storeys are shifted by the rows ``shift`` (k,) of ``shifts``. Returns ``View``'s fields, a
    placement a row.
    """
    aim = explaining(0, len(seen.storey))
    case, _kept = _case(seen, plan, limits, content, shifts.shape[1], aim, 0)
    rooms, rows, n = len(seen.storey), len(seen.angle), len(at)
    values, _ = allocated(View, (n * rooms, n * rows, n * rows, n * rows, n * rows))
    made = View(values[0].reshape(n, rooms), *(v.reshape(n, rows) for v in values[1:]))
    at = np.ascontiguousarray(at, dtype=np.float64)
    shift = np.ascontiguousarray(shift, dtype=np.int64)
    block = slots_of(Sights, (case, shifts, shift, at, *made))
    look_all(address(block))
    return made


def _case(
    seen: Seen,
    plan: Plan,
    limits: Limits,
    content: Content,
    storeys: int,
    aim: Aim,
    peaks: int,
    *,
    boxes: int = 0,
    maps: int = 0,
) -> tuple[Any, dict[str, Any]]:
    """The block of a case, and what must be kept while it is used: ``KEPT`` by name, and more."""
    rooms, rows, prior = len(seen.storey), len(seen.angle), len(plan.storey)
    widest = int(np.diff(seen.first).max(initial=1))
    room_work = (rooms, rooms)
    plane_work = (widest, plan.widest + 1)
    columns = prior + rooms
    stacks = ((DEPTH, SIDES), (WAITING, SIDES))
    view = (rooms, rows, rows, rows, rows)
    words = 4 * maps * rooms * int(plan.cells.prod())
    work: list[tuple[Any, Any]] = [
        (Finder, (prior, prior, 1)),
        (Bench, (*[plane_work] * 3, widest, widest + 1, *[widest] * 5, *[plane_work[1]] * 6)),
        (Options, (room_work, room_work, rooms, prior)),
        (Pairing, (*[columns] * 7, *[rooms] * 3)),
        (Tally, ((seen.planes, 8), seen.planes)),
        (Spans, ((3, rooms), (3, rooms), rooms, rooms, *[widest] * 7, rooms)),
        (Groups, (rooms + 2, *[rooms] * 5, 2)),
        (
            Found,
            (
                (peaks, 4),
                8,
                rooms,
                *stacks,
                (rooms, prior // 64 + 1),
                (2, 4),
                (boxes, SIDES),
                (boxes, SIDES),
                (boxes, 3),
            ),
        ),
        (Ground, (words, 1, rooms, maps * rooms, 1)),
        (View, view),
        (View, view),
    ]
    room, block, begins = arranged(work)
    storey, judged = np.zeros(storeys, dtype=np.int64), np.zeros(rooms, dtype=np.int64)
    task = slots_of(Task, (aim.least, aim.budget, storey, judged, aim.loss))
    tables = (seen.slots, plan.slots, _limits(limits), content.slots, task)
    start = address(block)
    places = [*map(address, tables), *(start + WORD * k for k in begins)]
    kept = {"room": room, "block": block, "tables": (tables, storey, aim), "judged": judged}
    for name, (record, wide) in KEPT.items():
        declared = work[record][0]
        at = begins[record] + layout(declared)[name].slot
        first = (int(block[at]) - address(room)) // WORD
        size = int(block[at + 1]) * (int(block[at + 2]) if wide else 1)
        kept[name] = room[first : first + size].view(np.float64 if name == "base" else np.int64)
    return np.array(places, dtype=np.int64), kept


_NOTHING = (np.zeros((0, SIDES)), np.zeros(0, dtype=np.int64), 0)


@lru_cache(maxsize=16)
def _limits(limits: Limits) -> Any:
    return slots_of(Limits, limits)


@entry
def search_all(place):
    """Fill a ``Search``."""
    _search_all(record_at(place, Search))


@part
def _search_all(wanted):
    case = wanted.case
    task, found = case.task, case.found
    _shapes_alike(case)
    kept = left = 0
    for z in range(len(wanted.shifts)):
        for u in range(len(task.storeys)):
            task.storeys[u] = wanted.shifts[z, u]
        found.count[PEAKS] = found.count[LEFT] = found.count[HELD] = 0
        found.count[STAGE] = ANYWHERE
        _turn_to_maps(case, z)
        if len(wanted.known_first) > 0:
            begin, end = wanted.known_first[z], wanted.known_first[z + 1]
            outline(case, wanted.known, begin, end, wanted.wanted)
        search(case)
        _raise_all(case)
        for k in range(found.count[PEAKS]):
            if kept < len(wanted.shift) and k < len(found.peak):
                wanted.shift[kept] = z
                for c in range(4):
                    wanted.place[kept, c] = found.peak[k, c]
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
def _raise_all(case):
    """Add the higher peaks beside those found."""
    found, at = case.found, scratch(3)
    for k in range(min(found.count[PEAKS], len(found.peak))):
        for axis in range(3):
            at[axis] = found.peak[k, axis]
        feasible(case, case.one, at)
        height = raised(case, at, found.peak[k, 3])
        if height > found.peak[k, 3]:
            add_peak(case, at, height)


@part
def _shapes_alike(case):
    """Mark, for each online room, the allowed prior rooms that explain it in isolation.

    They are counted for rooms of more than two planes; of the others none is excluded.
    """
    seen, plan, alike, like = case.seen, case.plan, case.found.alike, case.found.like
    for r in range(len(seen.storey)):
        if case.task.judged[r]:
            continue
        few = seen.first[r + 1] - seen.first[r] < 3
        for a in range(len(plan.storey)):
            if room_allowed(case, r, a) and (few or fits_somewhere(case, r, a)):
                like[r, a >> 6] |= 1 << (a & 63)
                if not few:
                    alike[r] += 1


@entry
def look_all(place):
    """Fill a ``Sights``."""
    _look_all(record_at(place, Sights))


@part
def _look_all(sights):
    case, at = sights.case, sights.place
    task, view = case.task, case.one
    for k in range(len(sights.shift)):
        for u in range(len(task.storeys)):
            task.storeys[u] = sights.shifts[sights.shift[k], u]
        look(case, view, at[k, 0], at[k, 1], at[k, 2], 0.0, 0.0)
        for r in range(len(view.room)):
            sights.room[k, r] = view.room[r]
        for i in range(len(view.row)):
            sights.row[k, i] = view.row[i]
            sights.state[k, i] = view.state[i]
            sights.offset[k, i] = view.offset[i]
            sights.bend[k, i] = view.bend[i]
