from __future__ import annotations

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.objects.world import box, two_rooms

from situgraph.objects.relations import related
from situgraph.scenegraph.graph import Object, Room, SceneGraph

flat = pytest.mark.parametrize("footprint", [False, True])


def relations(graph: SceneGraph, category: str, x: float, y: float, z: float = 1.0):
    item = Object("o", category, (x, y, z))
    found = related(graph.replace(objects=(item,))).objects[0]
    return found.rooms, found.planes


@flat
def test_things_in_the_open_belong_to_the_room_they_stand_in(footprint) -> None:
    graph = two_rooms(footprint)
    assert relations(graph, "cabinet", 1.0, 1.0) == (("a",), ())
    assert relations(graph, "cabinet", 6.0, 4.5) == (("b",), ())
    assert relations(graph, "cabinet", 20.0, 1.0) == ((), ())
    assert relations(graph, "cabinet", 1.0, 1.0, 9.0) == ((), ())


@flat
def test_a_door_between_two_rooms_is_on_a_face_of_each(footprint) -> None:
    for x in (3.95, 4.1, 4.25):
        rooms, planes = relations(two_rooms(footprint), "door", x, 2.0)
        assert set(rooms) == {"a", "b"}
        assert set(planes) == {"a1", "b0"}


@flat
def test_an_outer_window_is_on_one_face(footprint) -> None:
    assert relations(two_rooms(footprint), "window", 2.0, 5.1) == (("a",), ("a3",))


@flat
def test_a_radiator_hangs_on_its_own_side_of_the_wall(footprint) -> None:
    graph = two_rooms(footprint)
    assert relations(graph, "radiator", 3.9, 2.5) == (("a",), ("a1",))
    assert relations(graph, "radiator", 4.3, 2.5) == (("b",), ("b0",))


def test_what_does_not_hang_on_walls_is_on_none() -> None:
    assert relations(two_rooms(), "cabinet", 0.1, 2.5) == (("a",), ())


def test_an_object_behind_a_wall_is_hidden() -> None:
    a, planes = box("a", 0.0, 0.0, 4.0, 5.0, False)
    graph = SceneGraph(rooms=(Room("a", a.center, a.planes),), planes=planes)
    assert relations(graph, "cabinet", 4.1, 2.5)[0] == ("a",)
    assert relations(graph, "cabinet", 5.0, 2.5)[0] == ()


def test_an_l_shaped_room_holds_what_its_centre_does_not_see() -> None:
    shape = ((0, 0), (6, 0), (6, 2), (2, 2), (2, 8), (0, 8))
    from situgraph.geometry.planes import from_footprint
    from situgraph.scenegraph.graph import Plane

    normals, offsets = from_footprint(shape)
    planes = tuple(
        Plane(f"p{i}", (float(n[0]), float(n[1]), 0.0), float(d), (shape[i], shape[(i + 1) % 6]))
        for i, (n, d) in enumerate(zip(normals, offsets))
    )
    room = Room("l", (2.0, 2.5, 1.4), tuple(p.id for p in planes), footprint=shape)
    graph = SceneGraph(rooms=(room,), planes=planes)
    assert relations(graph, "cabinet", 5.5, 1.0) == (("l",), ())
    assert relations(graph, "window", 2.0, 7.0) == (("l",), ("p3",))
    assert relations(graph, "window", 4.0, 2.0) == (("l",), ("p2",))
    assert relations(graph, "cabinet", 5.0, 5.0) == ((), ())


@given(st.integers(0, 10_000))
def test_relations_survive_centres_that_are_off_by_a_fifth_of_a_metre(seed) -> None:
    rng = np.random.default_rng(seed)
    y = rng.uniform(0.8, 4.2)
    dx, dy = rng.uniform(-0.14, 0.14, 2)
    rooms, planes = relations(two_rooms(), "door", 4.1 + dx, y + dy)
    assert (set(rooms), set(planes)) == ({"a", "b"}, {"a1", "b0"})


def test_a_wall_seen_in_scraps_reaches_as_far_as_the_room() -> None:
    graph = two_rooms(True)
    scrap = tuple(
        msgspec.structs.replace(p, extent=((4.0, 0.0), (4.0, 0.6))) if p.id == "a1" else p
        for p in graph.planes
    )
    assert relations(graph.replace(planes=scrap), "door", 4.0, 3.0)[1] == ("a1", "b0")
    bare = tuple(msgspec.structs.replace(r, footprint=None) for r in graph.rooms)
    assert relations(graph.replace(planes=scrap, rooms=bare), "door", 4.0, 3.0)[1] == ("b0",)


def test_nobody_looks_through_a_wall() -> None:
    """An extinguisher of room a that was placed behind its wall; what b's camera saw is b's."""
    graph = two_rooms(True).replace(objects=(Object("o", "extinguisher", (4.25, 2.0, 1.0)),))
    eyes = {"a": np.array([2.0, 2.5, 1.0]), "b": np.array([6.0, 2.5, 1.0])}
    found = {key: related(graph, eyes={"o": eye}).objects[0] for key, eye in eyes.items()}
    assert (found["a"].rooms, found["a"].planes) == (("a",), ("a1",))
    assert (found["b"].rooms, found["b"].planes) == (("b",), ("b0",))
    assert related(graph).objects[0].rooms == ("b",)
    deep = graph.replace(objects=(Object("o", "extinguisher", (8.1, 2.0, 1.0)),))
    assert related(deep, eyes={"o": eyes["a"]}).objects[0].planes == ("b1",)  # through a doorway
