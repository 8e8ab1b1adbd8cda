"""What one search leaves for the next, of a graph that has grown since."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from situgraph.matching.boxes import AX, AY
from situgraph.matching.preparation import Inputs
from situgraph.matching.tables import Aim, Ints
from situgraph.matching.traces import Start, Traces


class Memory(NamedTuple):
    """A search for placements that explain at least so many rooms, and what it left."""

    inputs: Inputs
    least: int
    traces: Traces | None  # None where nothing was kept


def stands(memory: Memory | None, inputs: Inputs) -> bool:
    """Whether some room is exactly as it was; in a map that moves none is, and none will be."""
    return memory is None or bool((_rows(memory.inputs, inputs) >= 0).any())


def start_of(memory: Memory | None, inputs: Inputs, aim: Aim) -> Start | None:
    """What ``memory`` says of a search to come, None where that is nothing.

    A placement outside of the cover explains fewer of the former rooms than the former search was
    after, so it explains some of the new ones; of so many groups of them that it cannot miss all,
    it explains one. Rooms of parallel planes are no anchors of a group; and where there were
    enough of them to be explained alone, a placement that nothing fixed may be fixed by now.
    """
    if memory is None or memory.traces is None or not _same_plan(memory.inputs, inputs):
        return None
    row = _rows(memory.inputs, inputs)
    traces, shifts = memory.traces, len(inputs.mapping)
    former = memory.inputs.seen
    wanted = len(row) - len(former.storey) - aim.least + memory.least
    able = int((inputs.seen.flat[row < 0] == 0).sum())
    on = (
        traces.cover is not None
        and not inputs.flipped  # there, rooms lose unequally
        and int((row >= 0).sum()) == len(former.storey)
        and int(former.flat.sum()) < memory.least <= aim.least
        and wanted <= able
    )
    if not on:
        return Start(traces, row, False, 0, np.zeros((0, 0)), np.zeros(0, dtype=np.int64))
    assert traces.cover is not None
    cover = traces.cover.copy()
    cover[:, [AX, AY]] += memory.inputs.middle - inputs.middle
    first = np.searchsorted(traces.cover_shift, np.arange(shifts + 1))
    return Start(traces, row, True, max(wanted, 0), cover, first.astype(np.int64))


def _same_plan(former: Inputs, inputs: Inputs) -> bool:
    """Whether the storeys of the rooms go where they went."""
    return (
        former.index is inputs.index
        and former.config == inputs.config
        and np.array_equal(former.shifts, inputs.shifts)
        and np.array_equal(former.mapping, inputs.mapping)
    )


def _rows(former: Inputs, inputs: Inputs) -> Ints:
    """The row (N,) that each room had in the former search, -1 where it was not as it is now."""
    names = {former.online.rooms[k].id: r for r, k in enumerate(former.kept.tolist())}
    rooms = inputs.online.rooms
    row = np.array([names.get(rooms[k].id, -1) for k in inputs.kept.tolist()], dtype=np.int64)
    then, now = former.rooms, inputs.rooms
    planes = np.diff(now.first)
    same = (row >= 0) & (np.diff(then.first)[row] == planes)
    same &= (then.center[row] == now.center).all(axis=1)
    same &= former.seen.storey[row] == inputs.seen.storey
    # Row by row of the planes of these rooms.
    here = np.flatnonzero(np.repeat(same, planes))
    room = now.room[here]
    there = then.first[row[room]] + here - now.first[room]
    other = then.equation[then.source[there]] != now.equation[now.source[here]]
    same[room[other.any(axis=1)]] = False
    return np.where(same, row, -1)
