"""What a search leaves for a later one of the same rooms and more, and how that begins with it."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

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


def recall(kept: dict[str, Any], start: Start) -> None:
    """Into a new case what is known of its rooms."""
    traces, rooms = start.traces, len(start.row)
    seen = np.flatnonzero(start.row >= 0)
    row = start.row[seen]
    kept["judged"][seen] = 1
    kept["alike"][seen] = traces.alike[row]
    kept["like"].reshape(rooms, -1)[seen] = traces.like[row]
    shifts = len(traces.drawn)
    if traces.base == kept["base"][0] and shifts * rooms == len(kept["drawn"]):
        kept["drawn"].reshape(shifts, rooms)[:, seen] = traces.drawn[:, row]
        kept["word"].reshape(shifts, rooms, -1)[:, seen] = traces.maps[:, row]


def traces_of(
    kept: dict[str, Any], count: Ints, left: Floats, left_shift: Ints, shifts: int
) -> Traces:
    """What a search leaves: ``count`` and its cover ``left``, with what is kept of its case."""
    rooms = len(kept["alike"])
    whole = not count[CUT] and count[LEFT] <= len(left)
    boxes = int(count[LEFT]) if whole else 0
    return Traces(
        kept["alike"],
        kept["like"].reshape(rooms, -1),
        kept["word"].reshape(shifts, rooms, -1),
        kept["drawn"].reshape(shifts, rooms),
        float(kept["base"][0]),
        left[:boxes].copy() if whole else None,
        left_shift[:boxes].copy(),
    )
