"""What Python calls: all peaks of a match, and the correspondences at placements."""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

from typing import Annotated, Any, NamedTuple

import numpy as np

from situgraph.matching.blocks import Block
from situgraph.matching.boxes import SIDES
from situgraph.matching.compiled import entry, part
from situgraph.matching.containment import room_allowed
from situgraph.matching.hypotheses import fits_somewhere
from situgraph.matching.records import record_at
from situgraph.matching.search import outline, search
from situgraph.matching.tables import (
    ANYWHERE,
    HELD,
    LEFT,
    PEAKS,
    STAGE,
    Aim,
    Case,
    Content,
    Floats,
    Ints,
    IntTable,
    Limits,
    Plan,
    Seen,
    Table,
    View,
    explaining,
)
from situgraph.matching.traces import Start, Traces, recall, traces_of
from situgraph.matching.views import look

WAITING = 64  # boxes of one pair of rooms that are put together
DEPTH = 256  # of the stack of boxes: each is halved until it is smaller than a millimetre
ROOM = 1024  # for peaks, to begin with
COVER, MOST_COVER = 8, 4096  # boxes of a cover: for each prior room, at most


class Search(NamedTuple):
    """A search for all shifts of the storeys."""

    case: Case
    shifts: IntTable  # (k, U)
    shift: Annotated[Ints, "peaks"]
    place: Annotated[Floats, "peaks", 5]  # 0, yaw, x, y, L
    count: Annotated[Ints, 8]  # type: ignore[assignment]  # ``PEAKS`` to ``STAGE``
    left: Annotated[Floats, "boxes", "sides"]  # the cover
    left_shift: Annotated[Ints, "boxes"]
    known: Table  # (g, SIDES) the cover of an earlier search
    known_first: Ints  # (shifts + 1,) where that of each shift begins; empty without one
    wanted: int  # groups of new rooms


class Sights(NamedTuple):
    """Placements to look at; ``View``'s fields, a placement a row."""

    case: Case
    shifts: IntTable
    shift: Ints  # (k,)
    place: Table  # (k, 3)
    room: Annotated[Ints, "k", "N"]
    row: Annotated[Ints, "k", "P"]
    state: Annotated[Ints, "k", "P"]
    offset: Annotated[Floats, "k", "P"]
    bend: Annotated[Floats, "k", "P"]


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
) -> tuple[Floats, Ints, Ints, Ints, Traces | None]:
    """All peaks (k, 5) for all shifts of the storeys: 0, yaw, x, y, L; and the rows of ``shifts``.

    And how many prior rooms are like each online room; what was done: peaks, hypotheses, boxes, 1
    when incomplete, comparisons of planes, boxes left; and, where ``traced``, what a later search
    can start from.
    """
    most = ROOM
    boxes = min(COVER * (len(plan.storey) + COVER), MOST_COVER) if traced else 0
    given = given_of(seen, plan, limits, content, aim)
    known, first, wanted = None, None, 0
    if start is not None and start.on:
        known, first, wanted = start.cover, start.first, start.wanted
    maps = len(shifts) if traced else 1
    while True:
        sizes = sizes_of(seen, plan, shifts.shape[1], most, boxes=boxes, maps=maps)
        block = Block(
            Search, sizes, shifts=shifts, known=known, known_first=first, wanted=wanted, **given
        )
        block.array("case.ground.base")[0] = plan.row[0, 3] - seen.angle[0]
        if start is not None:
            recall(block, start)
        search_all(block.place)
        count: Ints = block.array("count").copy()
        if count[PEAKS] <= most:
            found = int(count[PEAKS])
            place, shift = block.array("place")[:found].copy(), block.array("shift")[:found].copy()
            alike: Ints = block.array("case.found.alike").copy()
            traces = traces_of(block, len(shifts)) if traced else None
            return place, shift, alike, count, traces
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
    sizes = sizes_of(seen, plan, shifts.shape[1], 0) | {"k": len(at)}
    block = Block(
        Sights,
        sizes,
        shifts=shifts,
        shift=np.ascontiguousarray(shift, dtype=np.int64),
        place=np.ascontiguousarray(at, dtype=np.float64),
        **given_of(seen, plan, limits, content, explaining(0, len(seen.storey))),
    )
    look_all(block.place)
    return View(*map(block.array, View._fields))


def given_of(seen: Seen, plan: Plan, limits: Limits, content: Content, aim: Aim) -> dict[str, Any]:
    """What the block of a ``Case`` is given."""
    return {
        "seen": seen.slots,
        "plan": plan.slots,
        "limits": limits.slots,
        "content": content.slots,
        "least": aim.least,
        "budget": aim.budget,
        "loss": aim.loss,
    }


def sizes_of(
    seen: Seen, plan: Plan, storeys: int, peaks: int, *, boxes: int = 0, maps: int = 0
) -> dict[str, int]:
    """The sizes of a ``Case``; ``maps``: of so many shifts they are kept."""
    rooms, prior = len(seen.storey), len(plan.storey)
    wide, tall = plan.cells.tolist()
    return {
        "N": rooms,
        "N + 2": rooms + 2,
        "P": len(seen.angle),
        "M": prior,
        "M + N": prior + rooms,
        "U": storeys,
        "n": seen.widest,
        "n + 1": seen.widest + 1,
        "m": plan.widest + 1,
        "planes": seen.planes,
        "peaks": peaks,
        "depth": DEPTH,
        "waiting": WAITING,
        "sides": SIDES,
        "like": prior // 64 + 1,
        "boxes": boxes,
        "maps": maps * rooms,
        "words": 4 * maps * rooms * wide * tall,
    }


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
        for k in range(found.count[PEAKS]):
            if kept < len(wanted.shift) and k < len(found.peak):
                wanted.shift[kept] = z
                for c in range(4):
                    wanted.place[kept, c + 1] = found.peak[k, c]
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
