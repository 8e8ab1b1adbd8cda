from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.objects.world import two_rooms

from situgraph.objects.doorways import doorways
from situgraph.scenegraph.graph import Plane, Room, SceneGraph, Storey


@pytest.mark.parametrize("footprint", [False, True])
def test_a_path_between_two_rooms_makes_one_doorway_with_both_faces(footprint) -> None:
    path = np.array([[2.0, 2.0, 0.5], [3.5, 2.0, 0.5], [4.7, 2.0, 0.5], [6.0, 2.0, 0.5]])
    (door,) = doorways(path, two_rooms(footprint))
    assert door.category == "door"
    assert door.attributes["evidence"] == "trajectory"
    assert set(door.rooms) == {"a", "b"}
    assert set(door.planes) == {"a1", "b0"}
    assert np.allclose(door.center, (4.1, 2.0, 1.05))


def test_going_back_and_forth_adds_nothing() -> None:
    there = np.array([[3.0, 2.0, 0.5], [5.0, 2.0, 0.5]])
    path = np.concatenate([there, there[::-1] + np.array([0, 0.2, 0]), there])
    assert len(doorways(path, two_rooms())) == 1


def test_two_doors_of_one_wall_stay_two() -> None:
    path = np.array([[3, 1, 0.5], [5, 1, 0.5], [5, 4, 0.5], [3, 4, 0.5]], dtype=float)
    assert len(doorways(path, two_rooms())) == 2


def test_leaving_to_the_unknown_relates_to_the_room_left() -> None:
    (door,) = doorways(np.array([[2.0, 4.0, 0.5], [2.0, 6.0, 0.5]]), two_rooms())
    assert (door.rooms, door.planes) == (("a",), ("a3",))
    assert np.allclose(door.center[:2], (2.0, 5.0))


def test_staying_inside_makes_none() -> None:
    assert doorways(np.array([[1.0, 1.0, 0.5], [3.0, 4.0, 0.5]]), two_rooms()) == ()
    assert doorways(np.zeros((0, 3)), two_rooms()) == ()


@given(st.floats(0.6, 4.4), st.floats(-0.5, 0.5))
def test_the_place_is_where_the_segment_meets_the_wall(y, slope) -> None:
    a, b = np.array([3.6, y - 0.5 * slope, 0.5]), np.array([4.6, y + 0.5 * slope, 0.5])
    (door,) = doorways(np.array([a, b]), two_rooms(True))
    assert np.allclose(door.center[:2], (4.1, y), atol=1e-6)


def test_round_a_walls_end_into_the_same_room_is_no_doorway() -> None:
    corners = ((0, 0), (5, 0), (5, 2), (2, 2), (2, 2.2), (5, 2.2), (5, 5), (0, 5))
    stub = (
        Plane("low", (0.0, -1.0, 0.0), 2.0, ((5.0, 2.0), (2.0, 2.0))),
        Plane("high", (0.0, 1.0, 0.0), -2.2, ((2.0, 2.2), (5.0, 2.2))),
    )
    room = Room("u", (1.0, 2.5, 1.4), ("low", "high"), "s0", footprint=corners)
    storeys = (Storey("s0", height=2.8),)
    graph = SceneGraph(kind="online", storeys=storeys, rooms=(room,), planes=stub)
    path = np.array([[2.05, 1.5, 0.5], [2.05, 2.1, 0.5], [2.05, 2.6, 0.5]])
    assert doorways(path, graph) == ()
