"""What the searches of a growing graph leave for the next one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from situgraph.matching.blocks import Space
from situgraph.matching.boxes import AX, AY
from situgraph.matching.preparation import Inputs
from situgraph.matching.reading import begins
from situgraph.matching.tables import Aim, Floats, Ints
from situgraph.matching.traces import Start, Traces


class Left(NamedTuple):
    """What a search left."""

    inputs: Inputs
    aim: Aim
    empty: bool  # whether nothing can be what it was after
    cover: Floats | None  # (k, SIDES); None where the search was cut short, or it was too much
    shift: Ints | None  # (k,) of the storeys, by rows


@dataclass(eq=False)
class Memory:
    """What is kept between the searches of a graph, or of its mirror image."""

    left: Left | None
    traces: Traces
    space: Space

    def rows(self, inputs: Inputs) -> Ints:
        """The row (N,) that each room had in the last search, -1 where it was not as it is now."""
        if self.left is None or not _same_plan(self.left.inputs, inputs):
            return np.full(inputs.count, -1)
        return _rows(self.left.inputs, inputs)

    def start(self, inputs: Inputs, row: Ints, aim: Aim) -> Start | None:
        """Where a search has to look, None for everywhere.

        A placement outside of the cover explains fewer of the former rooms than the former search
        was after, so it explains some of the new ones; of so many groups of them that it cannot
        miss all, it explains one. Rooms of parallel planes are no anchors of a group; and where
        there were enough of them to be explained alone, a placement that nothing fixed may be fixed
        by now.
        """
        left = self.left
        if left is None or left.cover is None or left.shift is None or not _all_there(left, row):
            return None
        wanted = len(row) - len(left.aim.loss) - aim.least + left.aim.least
        able = int((inputs.seen.flat[row < 0] == 0).sum())
        if aim.least < left.aim.least or wanted > able:
            return None
        cover = left.cover.copy()
        cover[:, [AX, AY]] += left.inputs.middle - inputs.middle
        first = np.searchsorted(left.shift, np.arange(len(inputs.mapping) + 1))
        return Start(max(wanted, 0), cover, first.astype(np.int64))

    def rules_out(self, inputs: Inputs, aim: Aim) -> bool:
        """Whether the last search tells that nothing can be what ``aim`` is after.

        It found nothing; and what it was after includes, of its own rooms, what is asked of them
        now, whichever are unexplained.
        """
        left = self.left
        if left is None or not left.empty:
            return False
        row = self.rows(inputs)
        if not _all_there(left, row) or aim.least - int((row < 0).sum()) < left.aim.least:
            return False
        then, now = left.aim.loss[row[row >= 0]], aim.loss[row >= 0]
        more = float(np.maximum(then - now, 0.0).sum())
        share = float((then / now).max(initial=0.0))
        return min(aim.budget + more, aim.budget * share) <= left.aim.budget


def _all_there(left: Left, row: Ints) -> bool:
    """Whether all former rooms are there, and so many crossed ones that something was fixed."""
    former = left.inputs.seen
    return int((row >= 0).sum()) == len(former.flat) and int(former.flat.sum()) < left.aim.least


def _same_plan(former: Inputs, inputs: Inputs) -> bool:
    """Whether the storeys of the rooms go where they went."""
    return (
        former.index is inputs.index
        and (former.config is inputs.config or former.config == inputs.config)
        and np.array_equal(former.shifts, inputs.shifts)
        and np.array_equal(former.mapping, inputs.mapping)
    )


def _rows(former: Inputs, inputs: Inputs) -> Ints:
    """The row (N,) that each room had in the former search, -1 where it was not as it is now."""
    old, new = former.online, inputs.online
    if (
        begins(new.rooms, old.rooms)
        and begins(new.planes, old.planes)
        and new.storeys == old.storeys
    ):  # the usual case, quickly
        row = np.arange(inputs.count)
        row[former.count :] = -1
        return row
    then, now = former.rooms, inputs.rooms
    number = {old.rooms[k].id: r for r, k in enumerate(then.kept.tolist())}
    row = np.array([number.get(new.rooms[k].id, -1) for k in now.kept.tolist()], dtype=np.int64)
    each = np.diff(now.first)
    same = (row >= 0) & (np.diff(then.first)[row] == each)
    same &= (then.center[row] == now.center).all(axis=1)
    same &= former.seen.storey[row] == inputs.seen.storey
    # Row by row of the planes of these rooms.
    here = np.flatnonzero(np.repeat(same, each))
    room = now.room[here]
    there = then.first[row[room]] + here - now.first[room]
    other = then.equation[then.source[there]] != now.equation[now.source[here]]
    same[room[other.any(axis=1)]] = False
    return np.where(same, row, -1)
