"""The building as built: where walls are, what doors do, what seeds change."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.sim.buildings import box_room, building, door, two_rooms, two_storeys

from situgraph.errors import InputError
from situgraph.scenegraph.graph import Ellipsoid, Object, SceneGraph
from situgraph.sim.clearing import build_drivable
from situgraph.sim.config import SimConfig, WorldConfig
from situgraph.sim.deviations import deviate, move_wall
from situgraph.sim.mesh import edges
from situgraph.sim.world import build_world

BARE = WorldConfig(pictures=0.0)


def test_every_plane_of_the_plan_is_a_face_of_the_world() -> None:
    plan = two_rooms()
    world = build_world(plan, BARE, 0)
    built = {p.plane for p in world.parts if p.plane}
    assert built == {p.id for p in plan.planes}
    for part in world.parts:
        if part.plane is None:
            continue
        plane = plan.plane_by_id[part.plane]
        rows = world.mesh.part == part.id
        corners = world.mesh.corners[rows].reshape(-1, 3) + world.origin
        assert np.abs(corners @ plane.normal + plane.offset).max() < 1e-3
        assert np.allclose(world.mesh.normals[rows] @ plane.normal, 1.0, atol=1e-6)


def test_an_open_door_is_a_hole_and_a_shut_one_is_not() -> None:
    for state, expected in (("open", True), ("none", True), ("closed", False)):
        world = build_world(two_rooms(state=state), BARE, 0)
        assert [d.state for d in world.doors] == [state]
        assert world.doors[0].passable is expected
        walls = world.levels[0].walls
        assert not walls.intersects(shapely.Point(5.1, 2.0))
        assert walls.intersects(shapely.Point(5.1, 3.0))


def test_a_door_without_a_leaf_has_none() -> None:
    world = build_world(two_rooms(leaf=False), BARE, 0)
    assert world.doors[0].swings == ()
    leaf = next(p.id for p in world.parts if p.name == "leaf")
    assert not (world.mesh.part == leaf).any()


@settings(max_examples=15)
@given(seed=st.integers(0, 200))
def test_an_open_leaf_keeps_out_of_walls_and_of_the_way(seed: int) -> None:
    world = build_world(two_rooms(state="open"), BARE, seed)
    level, door = world.levels[0], world.doors[0]
    leaves = shapely.union_all([s.polygon() for s in door.swings])
    assert leaves.intersection(level.walls).area < 1e-3
    way = shapely.LineString([(4.4, 2.0), (5.8, 2.0)]).buffer(0.2)
    assert not leaves.intersects(way)


def test_rooms_that_touch_in_the_plan_get_a_wall_unless_it_is_virtual() -> None:
    plan = building({"a": (0, 0, 4, 4), "b": (4, 0, 8, 4)})
    middle = shapely.Point(4.0, 2.0)
    assert build_world(plan, BARE, 0).levels[0].walls.covers(middle)
    open_plan = plan.replace(
        planes=tuple(
            p if p.id not in ("a.e", "b.w") else type(p)(p.id, p.normal, p.offset, p.extent, True)
            for p in plan.planes
        )
    )
    assert not build_world(open_plan, BARE, 0).levels[0].walls.intersects(middle)


def test_texture_seed_changes_looks_and_nothing_else() -> None:
    plan = two_rooms()
    a, b, c = (build_world(plan, WorldConfig(texture_seed=s), 7) for s in (1, 2, 1))
    assert np.array_equal(a.mesh.corners, b.mesh.corners)
    assert np.array_equal(a.mesh.part, b.mesh.part)
    assert not np.array_equal(a.textures, b.textures)
    assert np.array_equal(a.textures, c.textures)
    assert a.materials == c.materials != b.materials


def test_things_are_built_by_name_and_unknown_ones_as_boxes() -> None:
    half = (0.3, 0.2, 0.4)
    things = tuple(
        Object(f"o{i}", name, (1.0 + 0.9 * i, 2.0, 0.4), Ellipsoid(half), ("a",))
        for i, name in enumerate(("cabinet", "radiator", "chair", "table", "flux_capacitor"))
    )
    world = build_world(box_room(things), BARE, 0)
    for thing in things:
        part = next(p for p in world.parts if p.object == thing.id)
        assert part.category == thing.category
        corners = world.mesh.corners[world.mesh.part == part.id].reshape(-1, 3) + world.origin
        low, high = corners.min(axis=0), corners.max(axis=0)
        assert np.allclose((low + high) / 2, thing.center, atol=0.02)
        assert np.allclose((high - low) / 2, half, atol=0.02)
    assert set(world.bodies[0]) == {t.id for t in things}


def test_moving_a_wall_moves_both_faces_the_door_in_it_and_the_rooms() -> None:
    plan = two_rooms()
    built, deviation = move_wall(plan, {"a.e", "b.w"}, -0.3)
    assert dict(zip(deviation.ids, deviation.offsets)) == pytest.approx({"a.e": -0.3, "b.w": 0.3})
    # The normal of a.e is -x, so -0.3 along it is 0.3 to the east.
    assert built.plane_by_id["a.e"].offset == pytest.approx(5.3)
    assert built.plane_by_id["b.w"].offset == pytest.approx(-5.5)
    assert built.object_by_id["d"].center[0] == pytest.approx(5.4)
    assert built.object_by_id["w"] == plan.object_by_id["w"]
    width = max(x for x, _ in built.room_by_id["a"].footprint)
    assert width == pytest.approx(5.3)
    assert built.plane_by_id["a.s"].extent == ((0.0, 0.0), (pytest.approx(5.3), 0.0))
    world = build_world(built, BARE, 0)
    assert world.levels[0].walls.covers(shapely.Point(5.4, 0.5))


def test_a_wall_is_not_moved_through_a_room() -> None:
    narrow = building({"a": (0, 0, 5, 4), "b": (5.2, 0, 6.5, 4)})
    assert move_wall(narrow, {"a.e", "b.w"}, -0.3) is None
    assert move_wall(narrow, {"a.e", "b.w"}, 0.3) is not None


def test_deviations_are_as_many_as_asked_for_and_recorded() -> None:
    plan = two_rooms()
    config = WorldConfig(moved_walls=1, extra_furniture=3, missing_doors=1)
    built, done = deviate(plan, config, np.random.default_rng(0))
    kinds = [d.kind for d in done]
    # The only door of a room stays.
    assert sorted(kinds) == ["extra-furniture"] * 3 + ["moved-wall"]
    assert len(built.objects) == 5
    second = door("d2", 5.1, 3.2, ("a", "b"), ("a.e", "b.w"))
    built, done = deviate(
        plan.replace(objects=(*plan.objects, second)),
        WorldConfig(missing_doors=5),
        np.random.default_rng(0),
    )
    assert [d.kind for d in done] == ["missing-door"]
    assert len({"d", "d2"} & set(built.object_by_id)) == 1


def test_what_bars_the_only_way_is_left_out() -> None:
    chest = Object("chest", "cabinet", (4.6, 2.0, 0.5), Ellipsoid((0.3, 1.6, 0.5)), ("a",))
    plan = two_rooms()
    barred = plan.replace(objects=(*plan.objects, chest))
    world, deviations = build_drivable(barred, SimConfig(), (), 0)
    assert ("left-out", ("chest",)) in [(d.kind, d.ids) for d in deviations]
    assert "chest" not in world.graph.object_by_id


@pytest.mark.parametrize("category", ["stairs", "ramp"])
def test_a_flight_joins_the_storeys_and_opens_the_slab(category: str) -> None:
    world = build_world(two_storeys(category), BARE, 0)
    (flight,) = world.flights
    assert flight.foot[2] == 0.0
    assert flight.head[2] == 3.0
    assert flight.head[0] > flight.foot[0]
    floor = [p.id for p in world.parts if p.category == "floor" and p.room == "high"]
    rows = np.isin(world.mesh.part, floor)
    triangles = [shapely.Polygon(t[:, :2] + world.origin[:2]) for t in world.mesh.corners[rows]]
    assert not shapely.union_all(triangles).intersects(shapely.Point(flight.head[:2] - (0.3, 0)))


def test_edges_have_the_inside_on_their_left() -> None:
    ring = shapely.box(0, 0, 4, 4).difference(shapely.box(1, 1, 2, 2))
    for start, end in edges(ring):
        left = np.array([-(end - start)[1], (end - start)[0]]) * 1e-3
        assert ring.covers(shapely.Point((start + end) / 2 + left))


def test_a_plan_without_footprints_is_refused() -> None:
    plan = box_room()
    rooms = tuple(type(r)(r.id, r.center, r.planes, r.storey) for r in plan.rooms)
    with pytest.raises(InputError, match="footprint"):
        build_world(plan.replace(rooms=rooms), BARE, 0)
    with pytest.raises(InputError, match="footprint"):
        build_world(SceneGraph(), BARE, 0)
