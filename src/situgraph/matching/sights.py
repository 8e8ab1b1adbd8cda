"""Placements looked at one by one: what walls explain there, and what objects say."""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

from typing import Annotated, Any, NamedTuple

import numpy as np

from situgraph.matching.blocks import Block
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
    """Placements to look at; ``View``'s fields, a placement a row."""

    case: Case
    shifts: IntTable
    shift: Ints  # (k,)
    at: Table  # (k, 3) yaw, x, y of the mean room centre in the plan
    room: Annotated[Ints, "k", "N"]
    row: Annotated[Ints, "k", "P"]
    state: Annotated[Ints, "k", "P"]
    offset: Annotated[Floats, "k", "P"]
    bend: Annotated[Floats, "k", "P"]


class Weighing(NamedTuple):
    """Placements to look at, and to weigh objects at."""

    case: Case
    shifts: IntTable
    shift: Ints  # (k,)
    at: Table  # (k, 3)
    evidence: Evidence
    value: Annotated[Floats, "k"]
    claim: Annotated[Ints, "k", "objects"]


def views_at(tables: Tables, shifts: Ints, shift: Ints, at: Floats) -> View:
    """What is explained when the mean room centre goes to ``at`` (k, 3): yaw, x, y; strictly.

    Storeys are shifted by the rows ``shift`` (k,) of ``shifts``. Returns ``View``'s fields, a
    placement a row.
    """
    block = Block(Sights, _sizes(tables, shifts, at), **_given(tables, shifts, shift, at))
    look_all(block.place)
    return View(*map(block.array, View._fields))


def weigh(
    tables: Tables,
    shifts: Ints,
    sighted: Sighted,
    planned: Planned,
    rates: Rates,
    shift: Ints,
    at: Floats,
) -> tuple[Floats, Ints]:
    """Log ratios (k,) of the objects at such placements, and which prior object each is (k, n).

    The prior object is -1 for none.
    """
    objects, links = len(sighted.category), LINKS * len(sighted.category)
    sizes = _sizes(tables, shifts, at) | {
        "objects": objects,
        "objects + 1": objects + 1,
        "planned": len(planned.category),
    }
    given = _given(tables, shifts, shift, at) | sighted._asdict()
    while True:
        block = Block(
            Weighing,
            sizes | {"links": links},
            planned=planned.slots,
            rates=rates.slots,
            **given,
        )
        weigh_all(block.place)
        value: Floats = block.array("value")
        if not np.isnan(value).any():
            return value, block.array("claim")
        links *= LINKS


def _sizes(tables: Tables, shifts: Ints, at: Floats) -> dict[str, int]:
    return tables.sizes(shifts.shape[1]) | {"k": len(at)}


def _given(tables: Tables, shifts: Ints, shift: Ints, at: Floats) -> dict[str, Any]:
    return tables.given(explaining(0, len(tables.seen.storey))) | {
        "shifts": shifts,
        "shift": np.ascontiguousarray(shift, dtype=np.int64),
        "at": np.ascontiguousarray(at, dtype=np.float64),
    }


@entry
def look_all(place):
    """Fill a ``Sights``."""
    _look_all(record_at(place, Sights))


@part
def _look_all(t):
    view = t.case.one
    for k in range(len(t.shift)):
        _look(t, k)
        for r in range(len(view.room)):
            t.room[k, r] = view.room[r]
        for i in range(len(view.row)):
            t.row[k, i] = view.row[i]
            t.state[k, i] = view.state[i]
            t.offset[k, i] = view.offset[i]
            t.bend[k, i] = view.bend[i]


@entry
def weigh_all(place):
    """Fill a ``Weighing``."""
    _weigh_all(record_at(place, Weighing))


@part
def _weigh_all(t):
    nothing_claimed(t.evidence)
    for k in range(len(t.shift)):
        _look(t, k)
        at = t.at[k]
        t.value[k] = evidence_at(t.evidence, t.case.one, at[0], at[1], at[2], k + 1, t.claim[k])


@part
def _look(t, k):
    """What is explained at placement ``k``, into ``case.one``."""
    case, at = t.case, t.at[k]
    for u in range(len(case.task.storeys)):
        case.task.storeys[u] = t.shifts[t.shift[k], u]
    look(case, case.one, at[0], at[1], at[2], 0.0, 0.0)
