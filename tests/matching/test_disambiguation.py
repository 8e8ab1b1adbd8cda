"""What an ambiguous match says to look for: does it tell the solutions apart?"""

from __future__ import annotations

import pytest

from situgraph.experiments.advice import solve, summarise
from situgraph.geometry.poses import Placement
from situgraph.matching import PlanIndex, match
from situgraph.plan.layouts import make_layout
from situgraph.plan.sampler import sample_online
from situgraph.plan.sampler_config import CLEAN
from situgraph.plan.six_rooms import six_rooms
from situgraph.scenegraph.graph import Plane, Room, SceneGraph
from situgraph.view.record import read_record


def row_of_rooms(widths: list[float]) -> SceneGraph:
    """Rooms side by side, 5 m deep, without objects."""
    rooms, planes, x = [], [], 0.0
    for k, w in enumerate(widths):
        faces = [((1.0, 0.0), -x), ((-1.0, 0.0), x + w), ((0.0, 1.0), 0.0), ((0.0, -1.0), 5.0)]
        names = tuple(f"p{k}.{i}" for i in range(4))
        planes += [Plane(n, (*f, 0.0), d) for n, (f, d) in zip(names, faces)]
        rooms.append(Room(f"r{k}", (x + w / 2, 2.5, 1.3), names))
        x += w + 0.2
    return SceneGraph(rooms=tuple(rooms), planes=tuple(planes))


def first(graph: SceneGraph, *rooms: int) -> SceneGraph:
    return graph.replace(rooms=tuple(graph.rooms[k] for k in rooms))


def test_the_advice_of_the_demo_building_is_what_the_pictures_read() -> None:
    building = six_rooms()
    online = sample_online(building, 1, 0, CLEAN).online.replace(objects=())
    result = match(online, building)
    record = read_record(result)
    assert record.disambiguation
    rooms, planes = building.room_by_id, building.plane_by_id
    for item in record.disambiguation:
        assert item.in_room in rooms
        assert item.on_plane is None or item.on_plane in planes
        told = [k for group in item.splits for k in group]
        assert len(item.splits) > 1
        assert len(set(told)) == len(told) <= result.count
    gains = [a.gain for a in result.advice]
    assert gains == sorted(gains, key=lambda g: -round(g, 2))


def test_a_unique_match_needs_no_advice() -> None:
    building = six_rooms()
    assert match(sample_online(building, 1, 0, CLEAN).online, building).disambiguation == []


def test_the_room_behind_a_wall_tells_two_ends_apart() -> None:
    # The middle room is its own half turn; its neighbours are not alike.
    plan = row_of_rooms([3.0, 4.0, 6.0])
    result = match(first(plan, 1), PlanIndex(plan), semantics="none")
    assert result.count == 2
    rooms = [a for a in result.advice if a.kind == "room"]
    assert rooms
    assert {frozenset(map(frozenset, a.splits)) for a in rooms} == {
        frozenset({frozenset({0}), frozenset({1})})
    }
    # Where the advice says there is a room, there is one on the one side or on the other.
    assert all(abs(abs(a.place[0] - 5.2) - 2.9) < 0.3 for a in rooms)


def test_a_wall_that_was_not_seen_tells_rooms_of_two_widths_apart() -> None:
    plan = row_of_rooms([3.0, 4.0])
    room = plan.rooms[0]
    seen = plan.replace(rooms=(Room("s", room.center, (room.planes[0], *room.planes[2:])),))
    result = match(seen, PlanIndex(plan), semantics="none")
    assert result.verdict == "ambiguous"
    assert any(a.kind == "wall" for a in result.advice)


def test_the_advice_does_not_depend_on_the_frame() -> None:
    from situgraph.scenegraph.transform import transformed

    building = make_layout("modular", 12, 0, "local")
    online = sample_online(building, 1, 0, CLEAN).online
    index = PlanIndex(building)
    here = match(online, index)
    there = match(transformed(online, Placement(9.0, 4.0, 0.0, 2.0)), index)
    assert [a.kind for a in here.advice] == [a.kind for a in there.advice]
    assert [a.gain for a in here.advice] == pytest.approx([a.gain for a in there.advice], abs=1e-6)


def test_who_follows_it_is_located_sooner() -> None:
    # Few robots need more than one further room, so a dozen would leave it to luck.
    tasks = [{"kind": "modular", "semantics": "none", "seed": n} for n in range(60)]
    found = summarise([solve(t) for t in tasks])["none"]
    assert found["mean_rooms_advice"] <= found["mean_rooms_random"]
