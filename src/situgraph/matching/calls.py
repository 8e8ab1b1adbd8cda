"""What the compiled search is asked, and what it answers."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from situgraph.matching.blocks import Block, Laid, Space
from situgraph.matching.cases import Tables
from situgraph.matching.entries import Search, run
from situgraph.matching.sightings import Planned, Rates
from situgraph.matching.sights import Sights
from situgraph.matching.tables import PEAKS, WORK, Aim, Floats, Ints, View, explaining
from situgraph.matching.traces import Start, Traces

ROOM = 64  # for peaks, to begin with, at least
NOTHING_KNOWN = {"former_cover": None, "former_first": None, "wanted": 0, "spent": 0}
LINKS = 16  # an online object has to prior ones, to begin with
SHARED = "case.ground.shared"
NO_OBJECTS: dict[str, Any] = {"sighted": None, "side": 1.0, "planned": None, "rates": None}
NOTHING_WEIGHED = {"weighed": 0, "objects": 0, "objects + 1": 1, "planned": 0, "links": 0}


class Objects(NamedTuple):
    """The objects that are evidence; of the mirror image, where ``side`` is -1."""

    seen: int  # how many are online
    sighted: Laid  # a ``Sighted``
    side: float
    planned: Planned
    rates: Rates

    def given(self) -> dict[str, Any]:
        """What the block of an ``Evidence`` is given."""
        return {
            "sighted": self.sighted,
            "side": self.side,
            "planned": self.planned.slots,
            "rates": self.rates.slots,
        }

    def sizes(self, placements: int, links: int) -> dict[str, int]:
        """The sizes of an ``Evidence``, and of what it says of so many placements."""
        return {
            "weighed": placements,
            "objects": self.seen,
            "objects + 1": self.seen + 1,
            "planned": len(self.planned.category),
            "links": links * self.seen,
        }


class Peaks(NamedTuple):
    """What a search found, for all shifts of the storeys."""

    place: Floats  # (k, 5) height, yaw, x, y, L
    shift: Ints  # (k,) rows of the shifts
    walls: Floats  # (k,) L by the walls alone
    alike: Ints  # (N,) how many prior rooms explain each online room in isolation
    similar: float  # what that says for another building, of similar rooms wall to wall
    done: list[int]  # peaks, hypotheses, boxes, 1 when incomplete, steps, boxes left
    room: Block | None  # in which it worked


def find_peaks(
    tables: Tables,
    shifts: Ints,
    heights: Floats,
    aim: Aim,
    objects: Objects | None,
    *,
    start: Start | None = None,
    traces: Traces | None = None,
    boxes: int = 0,
    space: Space | None = None,
    room: Block | None = None,
) -> Peaks:
    """All peaks by the walls, weighed by ``objects`` where there are any.

    For all ``shifts`` of the storeys, by these ``heights`` (k,). Of a graph that grows: from a
    ``start``, with ``traces`` of its rooms, in this ``space``, leaving a cover of so many
    ``boxes``. ``room`` is that of the search for what was seen, where this one is for its mirror
    image: it is worked in again, and the maps it left are used.
    """
    given = tables.given(aim) | (objects.given() if objects else NO_OBJECTS)
    given |= {"shifts": shifts, "heights": heights, "weighs": bool(objects)} | NOTHING_KNOWN
    if start is not None:
        given |= {"former_cover": start.cover, "former_first": start.first, "wanted": start.wanted}
    prior, links = tables.room["M"], LINKS
    # A room by itself may lie in four places of each of the plan.
    most = max(ROOM, prior * (2 if tables.room["N"] > 1 else 4))
    # Maps may be shared with the search for the mirror image.
    shared = not traces and len(shifts) == 1
    if room is not None:
        maps_left = room.array(SHARED)
        room.again(SHARED, **given | {"former": maps_left if len(maps_left) else None})
    while True:
        if room is None:
            sizes = tables.sizes(peaks=most, boxes=boxes, maps=not traces, shared=shared)
            sizes |= objects.sizes(most, links) if objects else NOTHING_WEIGHED
            room = Block(Search, sizes, space, **given | (traces.given() if traces else {}))
        run(room.place, False)
        place, done = room.array("place"), room.array("count").tolist()
        similar, weighed = room.array("told").tolist()
        found = done[PEAKS]
        if found > len(place):
            most = 16 * len(place)
        elif math.isnan(weighed):
            links *= LINKS
        else:
            walls, shift = room.array("walls")[:found].copy(), room.array("shift")[:found].copy()
            alike = room.field("case.found", "alike")[: tables.room["N"]].copy()
            return Peaks(place[:found].copy(), shift, walls, alike, similar, done, room)
        room, given["spent"] = None, done[WORK]


def views_at(tables: Tables, shifts: Ints, shift: Ints, at: Floats) -> View:
    """What is explained when the mean room centre goes to ``at`` (k, 3): yaw, x, y; strictly.

    Storeys are shifted by the rows ``shift`` (k,) of ``shifts``. Returns ``View``'s fields, a
    placement a row.
    """
    given = NO_OBJECTS | tables.given(explaining(0, tables.room["N"]))
    sizes = NOTHING_WEIGHED | {"views": len(at)}
    block = _looked(tables, shifts, shift, at, sizes, given)
    return View(*map(block.array, View._fields))


def weigh(
    tables: Tables, shifts: Ints, objects: Objects, shift: Ints, at: Floats
) -> tuple[Floats, Ints]:
    """Log ratios (k,) of the objects at such placements, and which prior object each is (k, n).

    The prior object is -1 for none.
    """
    sizes = objects.sizes(len(at), LINKS) | {"views": 0}
    given = objects.given() | tables.given(explaining(0, tables.room["N"]))
    while True:
        block = _looked(tables, shifts, shift, at, sizes, given)
        value: Floats = block.array("value")
        if not np.isnan(value).any():
            return value, block.array("claim")
        sizes["links"] *= LINKS


def _looked(
    tables: Tables,
    shifts: Ints,
    shift: Ints,
    at: Floats,
    sizes: dict[str, int],
    given: dict[str, Any],
) -> Block:
    """A ``Sights``, filled."""
    block = Block(
        Sights,
        tables.sizes() | sizes,
        shifts=shifts,
        shift=np.ascontiguousarray(shift, dtype=np.int64),
        at=np.ascontiguousarray(at, dtype=np.float64),
        **given,
    )
    run(block.place, True)
    return block
