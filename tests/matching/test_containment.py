"""The paper's filter compares like with like: a room's face of a wall with a room's face."""

from __future__ import annotations

import msgspec
import pytest
from tests.matching.joined import joined

from situgraph.experiments.oracle.cases import draw
from situgraph.experiments.oracle.comparison import compare
from situgraph.experiments.oracle.definition import Definition
from situgraph.experiments.oracle.problem import Problem
from situgraph.matching import PlanIndex, match
from situgraph.plan.six_rooms import SIDES, Side, six_rooms
from situgraph.scenegraph.graph import Object, SceneGraph

WINDOW = "o16"  # the only thing but a radiator on the southern walls of r1, r4 and r5, at r4's


def face(graph: SceneGraph, room: str, side: Side) -> str:
    return graph.room_by_id[room].planes[SIDES.index(side)]


def more(graph: SceneGraph, name: str, **changes: object) -> SceneGraph:
    """The graph with one of its objects twice."""
    twin: Object = msgspec.structs.replace(graph.object_by_id[name], id="more", **changes)
    return graph.replace(objects=(*graph.objects, twin))


def fits(online: SceneGraph, plan: SceneGraph, room: str, side: Side) -> bool:
    """Whether both definitions let a room's face be the plan's: its walls are where they are."""
    case = Problem(online, plan, "containment", Definition())
    r = next(k for k, s in enumerate(case.seen) if s.room.id == room)
    at = SIDES.index(side)
    told = bool(case.planes_allowed(r, r)[at, at])
    alone = online.replace(rooms=(online.room_by_id[room],))
    best = match(alone, plan.replace(rooms=(plan.room_by_id[room],)), semantics="containment").best
    found = best is not None and face(online, room, side) in best.planes
    assert found == told
    return told


@pytest.mark.parametrize("rooms", range(1, 7))
def test_a_wall_along_several_rooms_is_each_rooms_own_wall(rooms: int) -> None:
    plan = six_rooms(rooms)
    online = joined(plan)
    assert rooms == 1 or len(online.planes) < len(plan.planes)
    result = match(online, PlanIndex(plan), semantics="containment")
    assert result.unique
    assert result.best is not None
    assert result.best.rooms == {r.id: r.id for r in plan.rooms}
    assert set(result.best.planes) == {p.id for p in online.planes}


@pytest.mark.parametrize("room", ["r1", "r4", "r5"])
def test_what_other_rooms_have_on_a_common_wall_is_not_counted(room: str) -> None:
    plan = six_rooms()
    online = joined(plan)
    common = face(online, "r1", "south")
    assert online.rooms_by_plane[common] == ("r1", "r4", "r5")
    assert common in online.object_by_id[WINDOW].planes
    assert fits(online, plan, room, "south")


def test_what_the_room_itself_has_on_it_is() -> None:
    plan = six_rooms()
    assert not fits(joined(more(plan, WINDOW)), plan, "r4", "south")
    assert fits(joined(more(plan, WINDOW)), plan, "r5", "south")


def test_a_door_between_two_rooms_is_on_the_face_of_each() -> None:
    plan = six_rooms()
    online = joined(more(plan, "o0"))  # a third door between r1 and r2
    for room, side in (("r1", "north"), ("r2", "south")):
        assert not fits(online, plan, room, side)
    for room, side in (("r4", "north"), ("r3", "south"), ("r5", "north"), ("r6", "south")):
        assert fits(online, plan, room, side)


def test_a_common_wall_of_the_plan_offers_a_room_only_what_that_room_has_on_it() -> None:
    seen, plan = six_rooms(), joined(six_rooms())
    assert all(fits(seen, plan, room, "south") for room in ("r1", "r4", "r5"))
    stray = more(seen, WINDOW, rooms=("r1",), planes=(face(seen, "r1", "south"),))
    assert not fits(stray, plan, "r1", "south")


@pytest.mark.parametrize("number", range(30_000, 30_012))
def test_the_matcher_and_the_brute_force_agree_on_common_walls(number: int) -> None:
    case = draw(number, kind="grid", policy="containment", planned=6, seen=4, density=0.4)
    prior, sample = case.graphs()
    online = joined(sample.online)
    found = compare(online, prior, Problem(online, prior, "containment", Definition()))
    assert found.missed == found.invented == 0
    assert found.agrees
