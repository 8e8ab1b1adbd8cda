"""Placements looked at one by one: what walls explain there, and what objects say."""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

from typing import Annotated, Any, NamedTuple

import numpy as np

from situgraph.matching.blocks import Block, Laid
from situgraph.matching.cases import Tables
from situgraph.matching.compiled import entry, part
from situgraph.matching.records import record_at
from situgraph.matching.sightings import (
    Evidence,
    Planned,
    Rates,
    Sighted,
    evidence_at,
    nothing_claimed,
)
from situgraph.matching.tables import (
    Case,
    Floats,
    Ints,
    IntTable,
    Table,
    View,
    explaining,
)
from situgraph.matching.views import look

LINKS = 16  # an online object has to prior ones, to begin with


class Sights(NamedTuple):
    """Placements to look at; ``View``'s fields, a placement a row, and what objects say there."""

    case: Case
    shifts: IntTable
    shift: Ints  # (k,)
    at: Table  # (k, 3) yaw, x, y of the mean room centre in the plan
    room: Annotated[Ints, "views", "N"]  # k views, or none where nobody asks
    row: Annotated[Ints, "views", "P"]
    state: Annotated[Ints, "views", "P"]
    offset: Annotated[Floats, "views", "P"]
    bend: Annotated[Floats, "views", "P"]
    evidence: Evidence
    value: Annotated[Floats, "weighed"]  # of k placements, or none
    claim: Annotated[Ints, "weighed", "objects"]


def views_at(tables: Tables, shifts: Ints, shift: Ints, at: Floats) -> View:
    """What is explained when the mean room centre goes to ``at`` (k, 3): yaw, x, y; strictly.

    Storeys are shifted by the rows ``shift`` (k,) of ``shifts``. Returns ``View``'s fields, a
    placement a row.
    """
    sizes = {"views": len(at), "weighed": 0, "objects": 0, "objects + 1": 1, "planned": 0}
    nothing = dict.fromkeys((*Sighted._fields, "planned", "rates"))
    given = nothing | tables.given(explaining(0, len(tables.seen.storey)))
    block = _looked(tables, shifts, shift, at, sizes | {"links": 0}, given)
    return View(*map(block.array, View._fields))


def weigh(
    tables: Tables,
    shifts: Ints,
    sighted: Sighted,
    planned: Planned,
    rates: Rates,
    shift: Ints,
    at: Floats,
    case: Laid | None,
) -> tuple[Floats, Ints]:
    """Log ratios (k,) of the objects at such placements, and which prior object each is (k, n).

    The prior object is -1 for none. It is worked in the ``case`` of a search, where there is one.
    """
    objects = len(sighted.category)
    sizes = {
        "views": 0,
        "weighed": len(at),
        "objects": objects,
        "objects + 1": objects + 1,
        "planned": len(planned.category),
        "links": LINKS * objects,
    }
    given = sighted._asdict() | {"planned": planned.slots, "rates": rates.slots}
    if case is None:
        given |= tables.given(explaining(0, len(tables.seen.storey)))
    else:
        given["case"] = case
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
    look_all(block.place)
    return block


@entry
def look_all(place):
    """Fill a ``Sights``."""
    _look_all(record_at(place, Sights))


@part
def _look_all(t):
    case, view = t.case, t.case.one
    nothing_claimed(t.evidence)
    for k in range(len(t.shift)):
        for u in range(len(case.task.storeys)):
            case.task.storeys[u] = t.shifts[t.shift[k], u]
        place = t.at[k]
        look(case, view, place[0], place[1], place[2], 0.0, 0.0)
        if len(t.room) > 0:
            _keep(t, view, k)
        if len(t.value) > 0:
            t.value[k] = evidence_at(t.evidence, view, place, k + 1, t.claim[k])


@part
def _keep(t, view, k):
    """The correspondences of placement ``k``."""
    for r in range(len(view.room)):
        t.room[k, r] = view.room[r]
    for i in range(len(view.row)):
        t.row[k, i] = view.row[i]
        t.state[k, i] = view.state[i]
        t.offset[k, i] = view.offset[i]
        t.bend[k, i] = view.bend[i]
