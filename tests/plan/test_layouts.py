"""What every synthetic layout must be, whatever its kind and symmetry."""

from __future__ import annotations

import typing

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import Point, Polygon

from situgraph.errors import InputError
from situgraph.geometry.planes import from_footprint
from situgraph.geometry.poses import Placement
from situgraph.plan.layout_config import Kind, LayoutConfig, Symmetry
from situgraph.plan.layouts import make_layout
from situgraph.scenegraph.codec import from_dict, to_dict
from situgraph.scenegraph.graph import SceneGraph
from situgraph.scenegraph.validation import validate

KINDS = typing.get_args(Kind)
SYMMETRIES = typing.get_args(Symmetry)
layouts = st.builds(
    make_layout,
    kind=st.sampled_from(KINDS),
    rooms=st.integers(1, 40),
    seed=st.integers(0, 10_000),
    symmetry=st.sampled_from(SYMMETRIES),
    object_density=st.none() | st.floats(0.0, 0.7),
)


@given(layouts)
@settings(max_examples=60)
def test_faces_bound_their_rooms_with_inward_normals(graph: SceneGraph) -> None:
    for room in graph.rooms:
        assert room.footprint is not None
        outline = np.array(room.footprint)
        polygon = Polygon(outline)
        assert polygon.is_valid
        assert polygon.exterior.is_ccw
        normals, offsets = from_footprint(outline)
        planes = [graph.plane_by_id[p] for p in room.planes]
        np.testing.assert_allclose([p.normal[:2] for p in planes], normals, atol=1e-9)
        np.testing.assert_allclose([p.offset for p in planes], offsets, atol=1e-7)
        for plane in planes:
            a, b = np.array(plane.extent)
            inside = 0.5 * (a + b) + 0.01 * np.array(plane.normal[:2])
            assert polygon.contains(Point(inside))
        assert polygon.centroid.distance(Point(room.center[:2])) < 1e-6


@given(layouts)
@settings(max_examples=40)
def test_rooms_of_a_storey_do_not_overlap(graph: SceneGraph) -> None:
    for storey in graph.storeys:
        polygons = [Polygon(r.footprint) for r in graph.rooms if r.storey == storey.id]
        for i, one in enumerate(polygons):
            for other in polygons[i + 1 :]:
                assert one.distance(other) > 0.02


@given(layouts)
@settings(max_examples=40)
def test_objects_stand_where_they_say(graph: SceneGraph) -> None:
    thickness = LayoutConfig().thickness_max
    for item in graph.objects:
        assert item.rooms
        for plane_id in item.planes:
            plane = graph.plane_by_id[plane_id]
            height = np.dot(plane.normal, item.center) + plane.offset
            assert abs(height) <= max(thickness, 0.25)
            assert set(graph.rooms_by_plane[plane_id]) & set(item.rooms)
            a, b = np.array(plane.extent)
            along = np.dot(np.array(item.center[:2]) - a, b - a) / np.dot(b - a, b - a)
            assert 0.0 < along < 1.0
        for room_id in item.rooms:
            polygon = Polygon(graph.room_by_id[room_id].footprint)
            assert polygon.distance(Point(item.center[:2])) < thickness + 0.05


@given(layouts)
@settings(max_examples=25)
def test_layouts_are_valid_scene_graphs(graph: SceneGraph) -> None:
    assert validate(graph, "layout") == graph
    assert from_dict(to_dict(graph), "layout") == graph
    assert not graph.warnings


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("symmetry", SYMMETRIES)
def test_the_number_of_rooms_and_planes_is_exact(kind: Kind, symmetry: Symmetry) -> None:
    for rooms in (1, 2, 3, 7, 12, 31):
        graph = make_layout(kind, rooms, seed=5, symmetry=symmetry, storeys=1)
        assert len(graph.rooms) == rooms
        assert len(graph.planes) == sum(len(r.planes) for r in graph.rooms)
        if kind in ("random", "modular", "grid", "corridor", "storeys"):
            assert len(graph.planes) == 4 * rooms


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("density", [0.0, 0.03, 0.2, 0.5, 0.8])
def test_density_is_met_within_rounding(kind: Kind, density: float) -> None:
    rooms = 23
    for symmetry in SYMMETRIES:
        graph = make_layout(kind, rooms, 2, symmetry, object_density=density, storeys=1)
        nodes = len(graph.rooms) + len(graph.planes)
        wanted = density / (1.0 - density) * nodes
        allowed = {"none": 0.5, "global": 1.0, "local": 0.5 * rooms}[symmetry]
        assert abs(len(graph.objects) - wanted) <= allowed + 1e-9


def test_same_seed_same_layout_other_seed_other_layout() -> None:
    for kind in KINDS:
        assert make_layout(kind, 12, seed=4) == make_layout(kind, 12, seed=4)
        assert make_layout(kind, 12, seed=4).planes != make_layout(kind, 12, seed=5).planes


def test_a_grid_is_identical_rooms_in_columns_and_rows() -> None:
    config = LayoutConfig(grid_room=(5.0, 4.0))
    graph = make_layout("grid", 12, shape=(4, 3), frame=Placement(), config=config)
    centers = np.array([r.center[:2] for r in graph.rooms])
    assert len(np.unique(centers[:, 0].round(9))) == 4
    assert len(np.unique(centers[:, 1].round(9))) == 3
    np.testing.assert_allclose(np.unique(np.diff(np.unique(centers[:, 0].round(9)))), 5.0)
    areas = [Polygon(r.footprint).area for r in graph.rooms]
    np.testing.assert_allclose(areas, areas[0])


def test_storeys_repeat_one_plan() -> None:
    config = LayoutConfig(storey_height=3.3)
    graph = make_layout("storeys", 29, seed=8, storeys=3, config=config)
    assert [s.elevation for s in graph.storeys] == pytest.approx([0.0, 3.3, 6.6])
    floors = [[r for r in graph.rooms if r.storey == s.id] for s in graph.storeys]
    assert [len(f) for f in floors] == [10, 10, 9]
    for floor in floors[1:]:
        for room, below in zip(floor, floors[0], strict=False):
            assert room.footprint == below.footprint
    stairs = [o for o in graph.objects if o.category == "stairs"]
    assert all(len({graph.room_by_id[r].storey for r in o.rooms}) == 2 for o in stairs)


def test_wings_stand_at_odd_angles() -> None:
    graph = make_layout("wings", 20, seed=1)
    angles = {
        round(float(np.degrees(np.arctan2(p.normal[1], p.normal[0]))) % 90.0) for p in graph.planes
    }
    assert len(angles) >= 3


def test_lshaped_layouts_hold_rooms_with_six_faces() -> None:
    graph = make_layout("lshaped", 40, seed=1)
    sides = [len(r.planes) for r in graph.rooms]
    assert sides.count(6) >= 5
    assert set(sides) == {4, 6}


@pytest.mark.parametrize("kind", KINDS)
def test_all_rooms_of_a_storey_can_be_reached(kind: Kind) -> None:
    graph = make_layout(kind, 30, seed=3)
    reached, frontier = {graph.rooms[0].id}, [graph.rooms[0].id]
    while frontier:
        here = frontier.pop()
        for item in graph.objects_by_room.get(here, ()):
            if item.category in ("door", "stairs"):
                frontier += [r for r in item.rooms if r not in reached]
                reached.update(item.rooms)
    assert len(reached) == 30


def test_requests_that_cannot_be_met_are_refused() -> None:
    with pytest.raises(InputError, match="kind"):
        make_layout("round")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="symmetry"):
        make_layout(symmetry="mirror")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="rooms"):
        make_layout(rooms=0)
    with pytest.raises(InputError, match="density"):
        make_layout(object_density=1.0)
    with pytest.raises(InputError, match="storeys"):
        make_layout("storeys", 10, symmetry="global", storeys=3)
    with pytest.raises(InputError, match="shape"):
        make_layout("grid", 10, shape=(3, 3))


def test_ten_thousand_rooms() -> None:
    graph = make_layout("random", 10_000, seed=0, object_density=0.2)
    assert len(graph.planes) == 40_000
    assert len(graph.objects) == 12_500
