"""The prior room at home where a room lies is the only one to explain it, if no other is near."""

from __future__ import annotations

import math

import msgspec
import numpy as np
import pytest

from situgraph.geometry.poses import Placement
from situgraph.matching import MatchingConfig, PlanIndex
from situgraph.matching.blocks import Block
from situgraph.matching.boxes import HU, PX, PY, SIDES, TURN, UX, YAW, reach_of, slack_of_room
from situgraph.matching.candidates import Known
from situgraph.matching.compiled import entry
from situgraph.matching.explained import may_explain
from situgraph.matching.homes import sole_room
from situgraph.matching.plain import BASE, CLEAR
from situgraph.matching.preparation import prepare
from situgraph.matching.records import record_at
from situgraph.matching.slack import give
from situgraph.matching.tables import Case
from situgraph.matching.views import look
from situgraph.plan.layout_config import Kind
from situgraph.plan.layouts import make_layout
from situgraph.plan.sampler import sample_online
from situgraph.plan.sampler_config import CLEAN, REALISTIC, SamplerConfig
from situgraph.scenegraph.graph import SceneGraph
from situgraph.scenegraph.transform import transformed

STEADY = msgspec.structs.replace(REALISTIC, drift=0.0)
LOOSE = MatchingConfig(plane_offset_tolerance=0.3, moved_limit=0.8)
KINDS: tuple[Kind, ...] = ("random", "modular", "grid", "corridor", "lshaped", "storeys")


def again(plan: SceneGraph, x: float, y: float) -> SceneGraph:
    """The plan, and all of its rooms once more, so far from there."""
    moved = transformed(plan, Placement(x, y, 0.0, 0.0))
    name = {p.id: f"{p.id}'" for p in moved.planes}
    planes = tuple(msgspec.structs.replace(p, id=name[p.id]) for p in moved.planes)
    rooms = tuple(
        msgspec.structs.replace(r, id=f"{r.id}'", planes=tuple(name[p] for p in r.planes))
        for r in moved.rooms
    )
    return plan.replace(planes=plan.planes + planes, rooms=plan.rooms + rooms, objects=())


def cases(
    plan: SceneGraph, seed: int, errors: SamplerConfig, config: MatchingConfig
) -> tuple[Block, Block, np.ndarray]:
    """A case, one of the same plan in which no room is at home, and placements (k, 3)."""
    online = sample_online(plan, 9, seed, errors).online
    first = prepare(online, PlanIndex(plan), "none", MatchingConfig())
    peaks, shift = Known().find(first, first.aim)[:2]
    found = []
    for homeless in (False, True):
        index = PlanIndex(plan, config)
        inputs = prepare(online, index, "none", config)
        if homeless:
            index.table.home[:] = -1
            index.table.plain[:, CLEAR] = 0.0
        tables = inputs.tables
        found.append(Block(Case, tables.sizes(peaks=8, maps=True), **tables.given(inputs.aim)))
        found[-1].array("task.storeys")[:] = inputs.mapping[shift[0] if len(peaks) else 0]
        found[-1].array("found.like")[:] = -1
    rng = np.random.default_rng(seed)
    center, rooms, turn = inputs.seen.center, len(inputs.kept), inputs.tables.turn
    yaw = turn + rng.integers(4, size=300) * math.pi / 2 + rng.normal(scale=0.02, size=300)
    x, y = center[rng.integers(rooms, size=300)].T
    c, s = np.cos(yaw), np.sin(yaw)
    place = index.center[rng.integers(index.rooms, size=300)] + rng.normal(scale=0.1, size=(300, 2))
    at = np.column_stack([yaw, place - np.stack([c * x - s * y, s * x + c * y], axis=1)])
    if len(peaks):  # half of them there
        at[:150] = peaks[0, 1:4] + rng.normal(scale=(0.01, 0.1, 0.1), size=(150, 3))
    return found[0], found[1], at


@entry
def looks(place, other, at):  # type: ignore[no-untyped-def]
    """How many rooms are explained, at placements (k, 3); -1 when otherwise in the other case."""
    one, two = record_at(place, Case), record_at(other, Case)
    total = 0
    for k in range(len(at)):
        count = look(one, one.one, at[k, 0], at[k, 1], at[k, 2], 0.0, 0.0)
        same = count == look(two, two.one, at[k, 0], at[k, 1], at[k, 2], 0.0, 0.0)
        for r in range(len(one.one.room)):
            same = same and one.one.room[r] == two.one.room[r]
        for i in range(len(one.one.row)):
            same = same and one.one.row[i] == two.one.row[i]
            same = same and one.one.state[i] == two.one.state[i]
            if two.one.row[i] >= 0:
                same = same and one.one.offset[i] == two.one.offset[i]
                same = same and one.one.bend[i] == two.one.bend[i]
        if not same:
            return -1
        total += count
    return total


@entry
def neighbours(place, boxes, wall):  # type: ignore[no-untyped-def]
    """For how many rooms it is told in boxes which the only one is, and how many others may be.

    Walls have the direction ``wall``.
    """
    case, told, others = record_at(place, Case), 0, 0
    seen, plan = case.seen, case.plan
    for k in range(len(boxes)):
        box, here = boxes[k], reach_of(boxes[k])
        for r in range(len(seen.storey)):
            slack, storey = slack_of_room(case, box, here, r), case.task.storeys[seen.storey[r]]
            yaw, turn, x, y = box[YAW], box[TURN], box[PX] + slack.wx, box[PY] + slack.wy
            c, s = math.cos(wall), math.sin(wall)
            away = max(give(slack, c, s), give(slack, -s, c))
            sole = sole_room(case, r, storey, yaw, turn, x, y, away) if storey >= 0 else -1
            if sole < 0:
                continue
            told += 1
            for a in range(len(plan.storey)):
                other = a != sole and plan.storey[a] == storey
                others += other and may_explain(case, r, a, yaw, x, y, slack)
    return told, others


@pytest.mark.parametrize("errors", [CLEAN, STEADY])
@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("kind", KINDS)
def test_the_room_at_home_explains_as_all_would(
    kind: Kind, seed: int, errors: SamplerConfig
) -> None:
    case, other, at = cases(make_layout(kind, 40, seed), seed, errors, MatchingConfig())
    assert looks(case.place, other.place, at) > 300


@pytest.mark.parametrize("apart", [0.05, 0.2, 0.29, 0.31, 0.5, 1.0])
@pytest.mark.parametrize("config", [MatchingConfig(), LOOSE])
def test_rooms_beside_each_other_are_both_looked_at(apart: float, config: MatchingConfig) -> None:
    plan = again(make_layout("random", 40, 0), apart, -apart)
    case, other, at = cases(plan, 0, CLEAN, config)
    assert looks(case.place, other.place, at) > 300


@pytest.mark.parametrize("errors", [CLEAN, STEADY])
@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("kind", KINDS)
def test_where_one_room_is_told_no_other_may_be(
    kind: Kind, seed: int, errors: SamplerConfig
) -> None:
    plan = make_layout(kind, 40, seed)
    case, _, at = cases(plan, seed, errors, MatchingConfig())
    wall = float(np.nanmin(PlanIndex(plan).table.plain[:, BASE]))
    rng = np.random.default_rng(seed)
    boxes = np.zeros((len(at), SIDES))
    boxes[:, [YAW, PX, PY]] = at
    boxes[:, TURN] = rng.uniform(0, 0.09, len(at))
    angle = rng.uniform(0, math.pi, len(at))
    boxes[:, UX : HU + 2] = np.column_stack(
        [np.cos(angle), np.sin(angle), rng.uniform(0, 1, (len(at), 2))]
    )
    told, others = neighbours(case.place, boxes, wall)
    assert told > 100
    assert others == 0
