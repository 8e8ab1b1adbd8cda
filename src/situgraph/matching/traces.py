"""What a search leaves for a later one of the same rooms and more, and how that begins with it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from situgraph.matching.blocks import Block
from situgraph.matching.tables import CUT, LEFT, Floats, Ints


class Traces(NamedTuple):
    """What a search leaves for a later one that sees some of its rooms again."""

    alike: Ints  # (N,)
    like: Ints  # (N, words)
    maps: Ints  # (shifts, N, words) (``Ground.word``)
    drawn: Ints  # (shifts, N)
    base: float  # of the maps
    cover: Floats | None  # (k, SIDES); None where the search was cut short
    cover_shift: Ints  # (k,)


class Start(NamedTuple):
    """What is known before a search."""

    traces: Traces
    row: Ints  # (N,) of each room in the traces, -1 when it is new
    on: bool  # whether the cover and so many groups of new rooms hold all that is feasible
    wanted: int
    cover: Floats  # (k, SIDES) anchored for this search
    first: Ints  # (shifts + 1,)


def recall(block: Block, start: Start) -> None:
    """Into the block of a new ``Search`` what is known of its rooms."""
    traces, rooms = start.traces, len(start.row)
    seen = np.flatnonzero(start.row >= 0)
    row = start.row[seen]
    ground, drawn = block.array("case.ground.word"), block.array("case.ground.drawn")
    block.array("case.task.judged")[seen] = 1
    block.array("case.found.alike")[seen] = traces.alike[row]
    block.array("case.found.like")[seen] = traces.like[row]
    shifts = len(traces.drawn)
    if traces.base == block.field("case.ground", "base") and shifts * rooms == len(drawn):
        drawn.reshape(shifts, rooms)[:, seen] = traces.drawn[:, row]
        ground.reshape(shifts, rooms, -1)[:, seen] = traces.maps[:, row]


def traces_of(block: Block, shifts: int) -> Traces:
    """What the ``Search`` of a block leaves."""
    count, left, alike = map(block.array, ("count", "left", "case.found.alike"))
    whole = not count[CUT] and count[LEFT] <= len(left)
    boxes = int(count[LEFT]) if whole else 0
    return Traces(
        alike,
        block.array("case.found.like"),
        block.array("case.ground.word").reshape(shifts, len(alike), -1),
        block.array("case.ground.drawn").reshape(shifts, len(alike)),
        block.field("case.ground", "base"),
        left[:boxes].copy() if whole else None,
        block.array("left_shift")[:boxes].copy(),
    )
