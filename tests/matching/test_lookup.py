"""Prior rooms are looked up by their corners, and told alike by their widths: none is lost."""

from __future__ import annotations

import math

import numpy as np
import pytest

from situgraph.matching import MatchingConfig, PlanIndex
from situgraph.matching.blocks import Block
from situgraph.matching.boxes import AX, AY, HU, HV, PX, PY, SIDES, TURN, UX, UY, YAW, reach_of
from situgraph.matching.compiled import entry
from situgraph.matching.explained import explain
from situgraph.matching.lookup import find
from situgraph.matching.plain import mark_whole, plain_alike, plain_pair, whole
from situgraph.matching.preparation import Inputs, prepare
from situgraph.matching.records import record_at
from situgraph.matching.slack import no_slack
from situgraph.matching.tables import Case
from situgraph.matching.views import look
from situgraph.plan.layout_config import Kind
from situgraph.plan.layouts import make_layout
from situgraph.plan.sampler import sample_online
from situgraph.plan.sampler_config import REALISTIC


def inputs_of(kind: Kind, planned: int, seen: int, seed: int) -> Inputs:
    plan = make_layout(kind, planned, seed)
    online = sample_online(plan, seen, seed, REALISTIC).online
    return prepare(online, PlanIndex(plan), "none", MatchingConfig())


def case_of(inputs: Inputs) -> Block:
    sizes = inputs.tables.sizes(peaks=8, maps=True)
    return Block(Case, sizes, **inputs.tables.given(inputs.aim))


@entry
def lost_rooms(place, box, yaw, px, py, count):  # type: ignore[no-untyped-def]
    """How many rooms explain one at a placement of the box and are not found, and how many do.

    The placement turns by ``yaw`` and takes the anchor of the box to ``(px, py)``.
    """
    case = record_at(place, Case)
    seen, plan = case.seen, case.plan
    c, s = math.cos(yaw), math.sin(yaw)
    for r in range(len(seen.storey)):
        found = find(case, r, 0, reach_of(box), True)
        x, y = seen.center[r, 0] - box[AX], seen.center[r, 1] - box[AY]
        rx, ry = px + c * x - s * y, py + s * x + c * y
        for a in range(len(plan.storey)):
            if explain(case, r, a, yaw, rx, ry, no_slack()) > -math.inf:
                there = False
                for k in range(found):
                    there |= case.finder.room[k] == a
                count[0] += not there
                count[1] += 1


@entry
def unlike(place, count):  # type: ignore[no-untyped-def]
    """How many pairs of rooms are told otherwise by their widths, and how many are told."""
    case = record_at(place, Case)
    for r in range(len(case.seen.storey)):
        if case.seen.first[r + 1] - case.seen.first[r] < 3:
            continue
        marked, here = mark_whole(case, r), 0
        for a in range(len(case.plan.storey)):
            if whole(case, a) and plain_pair(case, r, a):
                bit = (case.found.like[r, a >> 6] >> (a & 63)) & 1 == 1
                count[0] += bit != plain_alike(case, r, a)
                here += bit
                count[1] += 1
        count[0] += here != marked and plain_pair(case, r, 0)


@pytest.mark.parametrize("kind", ["random", "modular", "corridor"])
def test_each_room_that_explains_another_is_found(kind: Kind) -> None:
    inputs = inputs_of(kind, 60, 8, 5)
    case, random = case_of(inputs), np.random.default_rng(0)
    plan, seen = inputs.tables.plan, inputs.seen
    count = np.zeros(2, dtype=np.int64)
    for _ in range(3000):
        box = np.zeros(SIDES)
        # A wall seen falls on one planned, so that something is explained now and then.
        r, row = random.integers(len(seen.storey)), random.integers(len(plan.row))
        box[TURN], box[HU], box[HV] = random.uniform(0, (0.12, 0.4, 0.4))
        true = plan.row[row, 3] - seen.angle[seen.first[r]] + random.uniform(-0.05, 0.05)
        box[YAW] = true + random.uniform(-1, 1) * box[TURN]
        box[AX], box[AY] = seen.center[r]
        axis = random.uniform(0, math.pi)
        box[UX], box[UY] = math.cos(axis), math.sin(axis)
        px, py = random.choice(inputs.index.center) + random.uniform(-0.4, 0.4, 2)
        u, v = random.uniform(-1, 1, 2) * (box[HU], box[HV])
        box[PX] = px + u * box[UX] - v * box[UY]
        box[PY] = py + u * box[UY] + v * box[UX]
        lost_rooms(case.place, box, true, px, py, count)
    assert count[0] == 0
    assert count[1] > 100


@entry
def explained_within(place, yaw, turn, loose):  # type: ignore[no-untyped-def]
    """How many rooms are explained up to so much from a placement that takes centre to centre."""
    case = record_at(place, Case)
    return look(case, case.one, yaw, 0.0, 0.0, turn, loose)


@pytest.mark.parametrize("kind", ["random", "corridor"])
def test_rooms_are_found_where_the_yaw_is_widened_beyond_the_tolerance(kind: Kind) -> None:
    plan = make_layout(kind, 12, 1)
    case = case_of(prepare(plan, PlanIndex(plan), "none", MatchingConfig()))
    assert explained_within(case.place, 0.12, 0.0, 0.0) == 0
    assert explained_within(case.place, 0.12, 0.12, 3.0) == 12


@pytest.mark.parametrize("seed", range(3))
def test_rooms_are_alike_by_their_widths_as_by_their_places(seed: int) -> None:
    case = case_of(inputs_of("random", 300, 20, seed))
    count = np.zeros(2, dtype=np.int64)
    unlike(case.place, count)
    assert count[0] == 0
    assert count[1] > 1000
