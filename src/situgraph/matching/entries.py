"""What Python calls: the search for all peaks of a match, and looks at placements."""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from situgraph.matching.boxes import SIDES
from situgraph.matching.compiled import entry, part
from situgraph.matching.containment import room_allowed
from situgraph.matching.hypotheses import fits_somewhere
from situgraph.matching.plain import is_plain, mark_whole, whole
from situgraph.matching.records import record_at
from situgraph.matching.search import outline, search
from situgraph.matching.sightings import Evidence, evidence_at, nothing_claimed
from situgraph.matching.sights import Sights, look_all
from situgraph.matching.tables import (
    ANYWHERE,
    HELD,
    LEFT,
    PEAKS,
    SETTLED,
    SIFTED,
    STAGE,
    WORK,
    Case,
    Floats,
    Ints,
    IntTable,
    Table,
)
from situgraph.matching.views import look, unexplained


class Search(NamedTuple):
    """A search for all shifts of the storeys."""

    case: Case
    shifts: IntTable  # (k, U)
    heights: Floats  # (k,)
    shift: Annotated[Ints, "peaks"]
    place: Annotated[Floats, "peaks", 5]  # height, yaw, x, y, L with what objects say
    walls: Annotated[Floats, "peaks"]  # L without
    count: Annotated[Ints, 9]  # type: ignore[assignment]  # ``PEAKS`` to ``SETTLED``
    left: Annotated[Floats, "boxes", "sides"]  # the cover
    left_shift: Annotated[Ints, "boxes"]
    former_cover: Table  # (g, SIDES) the cover of an earlier search
    former_first: Ints  # (shifts + 1,) where that of each shift begins; empty without one
    wanted: int  # groups of new rooms
    spent: int  # steps of a search that lacked room, and was begun again
    evidence: Evidence
    claim: Annotated[Ints, "objects"]
    weighs: int  # whether there are objects to weigh
    told: Annotated[Floats, 2]  # what rooms say for another building; objects of all peaks or nan


@entry
def run(place, looks):
    """Fill a ``Search``, or a ``Sights`` where it only ``looks``: one program, compiled once."""
    if looks:
        look_all(record_at(place, Sights))
    else:
        _search_all(record_at(place, Search))


@part
def _search_all(wanted):
    case = wanted.case
    task, found = case.task, case.found
    found.count[WORK] = wanted.spent
    _shapes_alike(case)
    wanted.told[0] = _weigh_others(case)
    kept = left = 0
    nothing_claimed(wanted.evidence)
    for z in range(len(wanted.shifts)):
        if kept > len(wanted.shift):  # all is searched again, with more room
            break
        for u in range(len(task.storeys)):
            task.storeys[u] = wanted.shifts[z, u]
        found.count[PEAKS] = found.count[LEFT] = found.count[HELD] = found.count[SETTLED] = 0
        found.count[STAGE], case.sieve.told[SIFTED] = ANYWHERE, 0
        _turn_to_maps(case, z)
        if len(wanted.former_first) > 0:
            begin, end = wanted.former_first[z], wanted.former_first[z + 1]
            outline(case, wanted.former_cover, begin, end, wanted.wanted)
        search(case)
        for k in range(found.count[PEAKS]):
            if kept < len(wanted.shift) and k < len(found.peak):
                wanted.shift[kept] = z
                wanted.place[kept, 0] = wanted.heights[z]
                for c in range(4):
                    wanted.place[kept, c + 1] = found.peak[k, c]
                wanted.place[kept, 4] += _rest(case, found.peak[k], found.rest[k])
                wanted.walls[kept] = wanted.place[kept, 4]
                if wanted.weighs:
                    value = _weighed(wanted, found.peak[k], kept + 1)
                    wanted.place[kept, 4] += value
                    wanted.told[1] += value
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
    ground = case.ground
    if ground.layers > 1:
        ground.part[0] = z
    elif z > 0:
        for r in range(len(case.seen.storey)):
            ground.drawn[r] = 0


@part
def _weigh_others(case):
    """What each room says where it is not explained: it may be one like those of the plan.

    Returns what they say for another building, which is made of similar rooms, wall to wall.
    """
    seen, limits, found = case.seen, case.limits, case.found
    total = seen.tied[0] * limits.tied
    for r in range(len(found.other)):
        found.other[r] = 0.0
        if seen.shape[r] > 0:
            share = found.alike[r] / len(case.plan.storey)
            share *= limits.shape_gain ** seen.shape[r]
            found.other[r] = math.log1p(limits.other_room * share)
            total += math.log1p(share)
    return total


@part
def _rest(case, peak, known):
    """What the rooms say that are not explained at a peak, looked at where that is not known.

    One so high explains all.
    """
    seen, limits = case.seen, case.limits
    rooms = len(seen.storey)
    most = seen.planes * limits.fit_peak + (rooms - 1) * limits.room_true + limits.room_false
    if case.task.least == rooms or peak[3] > most:
        return 0.0
    if not math.isnan(known):
        return known
    look(case, case.one, peak[0], peak[1], peak[2], 0.0, 0.0)
    return unexplained(case, case.one)


@part
def _weighed(wanted, peak, number):
    """What the objects say of a peak."""
    case = wanted.case
    look(case, case.one, peak[0], peak[1], peak[2], 0.0, 0.0)
    return evidence_at(wanted.evidence, case.one, peak, number, wanted.claim)


@part
def _shapes_alike(case):
    """Mark, for each online room, the allowed prior rooms that explain it in isolation.

    They are counted for rooms of more than two planes; of the others none is excluded.
    """
    seen, plan, alike, like = case.seen, case.plan, case.found.alike, case.found.like
    asked = len(case.content.room_need) > 0 or len(case.content.row_need) > 0
    for r in range(len(seen.storey)):
        if case.task.judged[r]:
            continue
        few = seen.first[r + 1] - seen.first[r] < 3
        by_width = not few and not asked and is_plain(case, r)
        if by_width:
            alike[r] = mark_whole(case, r)
        for a in range(len(plan.storey)):
            if by_width and whole(case, a):
                continue
            if room_allowed(case, r, a) and (few or fits_somewhere(case, r, a)):
                like[r, a >> 6] |= 1 << (a & 63)
                if not few:
                    alike[r] += 1
