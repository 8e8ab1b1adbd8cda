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
from situgraph.matching.search import add_peak, search
from situgraph.matching.tables import (
    PEAKS,
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
)
from situgraph.matching.views import look

WAITING = 64  # boxes of one pair of rooms that are put together
DEPTH = 256  # of the stack of boxes: each is halved until it is smaller than a millimetre
FOUND = 8  # the place of ``Found`` among the records a case has to work in
ROOM = 1024  # for peaks, to begin with


class Search(NamedTuple):
    """A search for all shifts of the storeys."""

    case: Case
    shifts: IntTable  # (k, U)
    shift: Ints  # (c,) of each peak
    place: Table  # (c, 4) yaw, x, y, L
    count: Ints  # type: ignore[assignment]  # (5,) peaks, hypotheses, boxes, incomplete, work


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
    seen: Seen, plan: Plan, limits: Limits, content: Content, shifts: Ints, least: int
) -> tuple[Floats, Ints, Ints]:
    """All peaks (k, 5) for all shifts of the storeys: row of ``shifts``, yaw, x, y, L.

    And how many prior rooms are like each online room; and what was done: peaks, hypotheses,
    boxes, 1 when incomplete, comparisons of planes.
    """
    most = ROOM
    while True:
        case, kept = _case(seen, plan, limits, content, shifts.shape[1], least, most)
        values, block = allocated(Search, (0, (0, 0), most, (most, 4), 5))
        block = np.array(block)
        block[0] = address(case)
        block[1:4] = address(shifts), *shifts.shape
        search_all(address(block))
        _, _, shift, place, count = values
        if count[PEAKS] <= most:
            found = int(count[PEAKS])
            peaks = np.column_stack([shift[:found], place[:found]])
            alike: Ints = kept["alike"]
            return peaks, alike, count
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
    case, _kept = _case(seen, plan, limits, content, shifts.shape[1], 0, 0)
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
    least: int,
    peaks: int,
) -> tuple[Any, dict[str, Any]]:
    """The block of a case, and what must be kept while it is used."""
    rooms, rows, prior = len(seen.storey), len(seen.angle), len(plan.storey)
    widest = int(np.diff(seen.first).max(initial=1))
    room_work = (rooms, rooms)
    plane_work = (widest, plan.widest + 1)
    columns = prior + rooms
    boxes = ((DEPTH, SIDES), (WAITING, SIDES))
    view = (rooms, rows, rows, rows, rows)
    words = 4 * rooms * int(plan.cells.prod()) if peaks else 0
    work: list[tuple[Any, Any]] = [
        (Task, (least, storeys)),
        (Finder, (prior, prior, 1)),
        (Bench, (*[plane_work] * 3, widest, widest + 1, *[widest] * 5, *[plane_work[1]] * 6)),
        (Options, (room_work, room_work, rooms, prior)),
        (Pairing, (*[columns] * 7, *[rooms] * 3)),
        (Tally, ((seen.planes, 8), seen.planes)),
        (Spans, ((3, rooms), (3, rooms), rooms, rooms, *[widest] * 7, rooms)),
        (Groups, (rooms + 2, *[rooms] * 5, 1)),
        (Found, ((peaks, 4), 5, rooms, *boxes, (rooms, prior // 64 + 1), (2, 4))),
        (Ground, (words, 1, rooms)),
        (View, view),
        (View, view),
    ]
    room, block, begins = arranged(work)
    tables = (seen.slots, plan.slots, _limits(limits), content.slots)
    start = address(block)
    places = [*map(address, tables), *(start + WORD * k for k in begins)]
    at = begins[FOUND] + layout(Found)["alike"].slot
    first = (int(block[at]) - address(room)) // WORD
    kept = {"room": room, "block": block, "tables": tables}
    kept["alike"] = room[first : first + rooms].view(np.int64)
    return np.array(places, dtype=np.int64), kept


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
    kept = 0
    for z in range(len(wanted.shifts)):
        for u in range(len(task.storeys)):
            task.storeys[u] = wanted.shifts[z, u]
        found.count[PEAKS] = 0
        search(case)
        _raise_all(case)
        for k in range(found.count[PEAKS]):
            if kept < len(wanted.shift) and k < len(found.peak):
                wanted.shift[kept] = z
                for c in range(4):
                    wanted.place[kept, c] = found.peak[k, c]
            kept += 1
    wanted.count[PEAKS] = kept
    for k in range(1, 5):
        wanted.count[k] = found.count[k]


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
