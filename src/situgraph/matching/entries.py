"""What Python calls: all peaks of a match, and the correspondences at one placement."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from situgraph.matching.boxes import (
    SIDES,
    Spans,
    new_spans,
)
from situgraph.matching.compiled import entry, kernel
from situgraph.matching.containment import room_allowed
from situgraph.matching.explained import Bench, new_bench
from situgraph.matching.hypotheses import fits_somewhere
from situgraph.matching.lookup import Finder, new_finder
from situgraph.matching.pairing import Options, new_options
from situgraph.matching.peaks import feasible, raised
from situgraph.matching.pointers import pointer, read
from situgraph.matching.search import Found, add_peak, search
from situgraph.matching.tables import Case, Task
from situgraph.matching.views import (
    Tally,
    View,
    look,
    new_tally,
    new_view,
)


@kernel
def shapes_alike(case):
    """For each online room, how many prior rooms explain it in isolation."""
    seen, plan = read(case.seen), read(case.plan)
    rooms = len(seen.storey)
    alike = np.zeros(rooms, dtype=np.int64)
    boxes = np.empty((256, SIDES))
    for r in range(rooms):
        if seen.first[r + 1] - seen.first[r] < 3:
            continue
        for a in range(len(plan.storey)):
            if room_allowed(case, r, a) and fits_somewhere(case, r, a, boxes):
                alike[r] += 1
    return alike


class Room(NamedTuple):
    """Room to work in; one per match."""

    finder: Finder
    bench: Bench
    options: Options
    tally: Tally
    spans: Spans
    one: View
    two: View


@kernel
def new_room(seen, plan):
    """Room to work in for these tables."""
    rooms, rows = len(seen.storey), len(seen.angle)
    widest, broadest = 1, 1
    for r in range(rooms):
        widest = max(widest, seen.first[r + 1] - seen.first[r])
    for a in range(len(plan.storey)):
        broadest = max(broadest, plan.first[a + 1] - plan.first[a])
    return Room(
        new_finder(len(plan.storey)),
        new_bench(widest, broadest),
        new_options(rooms, len(plan.storey)),
        new_tally(seen.planes),
        new_spans(rooms, widest),
        new_view(rooms, rows),
        new_view(rooms, rows),
    )


@entry
def find_peaks(seen, plan, limits, content, shifts, least):
    """All peaks for all shifts of the storeys: (shift, yaw, x, y, L), shapes alike.

    What was done.
    """
    task = Task(least, np.empty(shifts.shape[1], dtype=np.int64))
    # What is pointed at must outlive the call below, so it is made here.
    return _find_peaks(seen, plan, limits, content, task, new_room(seen, plan), shifts)


@kernel
def _find_peaks(seen, plan, limits, content, task, room, shifts):
    case = Case(
        pointer(seen),
        pointer(plan),
        pointer(limits),
        pointer(content),
        pointer(task),
        pointer(room.finder),
        pointer(room.bench),
        pointer(room.options),
        pointer(room.tally),
        pointer(room.spans),
        pointer(room.one),
        pointer(room.two),
    )
    alike = shapes_alike(case)
    done = np.zeros(4, dtype=np.int64)
    out = np.empty((0, 5))
    for z in range(len(shifts)):
        count = np.zeros(4, dtype=np.int64)
        count[2] = done[2]
        task.storeys[:] = shifts[z]
        found = search(case, alike, Found(np.empty((16, 4)), count))
        found = _raise_all(case, found)
        more = np.empty((len(out) + count[0], 5))
        more[: len(out)] = out
        for k in range(count[0]):
            more[len(out) + k, 0] = z
            more[len(out) + k, 1:] = found.peak[k]
        out = more
        done[0] += count[0]
        done[1] += count[1]
        done[2] = count[2]
        done[3] = max(done[3], count[3])
    return out, alike, done


@kernel
def _raise_all(case, found):
    """Add the higher peaks beside those found."""
    at = np.empty(3)
    for k in range(found.count[0]):
        for axis in range(3):
            at[axis] = found.peak[k, axis]
        feasible(case, case.one, at)
        height = raised(case, at, found.peak[k, 3])
        if height > found.peak[k, 3]:
            found = add_peak(found, at, height)
    return found


@entry
def views_at(seen, plan, limits, content, mapping, shift, at):
    """What is explained when the mean room centre goes to ``at`` (k, 3): yaw, x, y; strictly.

    Storeys are shifted by the rows ``shift`` (k,) of ``mapping``. Returns ``View``'s fields, a
    placement a row.
    """
    task = Task(0, np.empty(mapping.shape[1], dtype=np.int64))
    rooms, rows = len(seen.storey), len(seen.angle)
    views = View(
        np.empty((len(at), rooms), dtype=np.int64),
        np.empty((len(at), rows), dtype=np.int64),
        np.empty((len(at), rows), dtype=np.int64),
        np.empty((len(at), rows)),
        np.empty((len(at), rows)),
    )
    _views_at(seen, plan, limits, content, task, new_room(seen, plan), mapping, shift, at, views)
    return views


@kernel
def _views_at(seen, plan, limits, content, task, room, mapping, shift, at, views):
    case = Case(
        pointer(seen),
        pointer(plan),
        pointer(limits),
        pointer(content),
        pointer(task),
        pointer(room.finder),
        pointer(room.bench),
        pointer(room.options),
        pointer(room.tally),
        pointer(room.spans),
        pointer(room.one),
        pointer(room.two),
    )
    for k in range(len(at)):
        for u in range(mapping.shape[1]):
            task.storeys[u] = mapping[shift[k], u]
        look(case, case.one, at[k, 0], at[k, 1], at[k, 2], 0.0, 0.0)
        for r in range(len(seen.storey)):
            views.room[k, r] = room.one.room[r]
        for i in range(len(seen.angle)):
            views.row[k, i] = room.one.row[i]
            views.state[k, i] = room.one.state[i]
            views.offset[k, i] = room.one.offset[i]
            views.bend[k, i] = room.one.bend[i]
