"""Placements looked at one by one: what walls explain there, and what objects say."""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

from typing import Annotated, NamedTuple

from situgraph.matching.compiled import part
from situgraph.matching.sightings import Evidence, evidence_at, nothing_claimed
from situgraph.matching.tables import Case, Floats, Ints, IntTable, Table
from situgraph.matching.views import look


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
    claim: Annotated[Ints, "weighed", "objects"]  # which prior object each is, -1 for none


@part
def look_all(t):
    """Fill a ``Sights``."""
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
