"""What write_ifc writes, read_ifc reads back: rooms, planes and objects within a millimetre."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from situgraph.errors import InputError
from situgraph.geometry.poses import Placement
from situgraph.plan.config import PlanConfig
from situgraph.plan.ifc import build_graph, read_ifc
from situgraph.plan.ifc_writer import write_ifc
from situgraph.plan.layout_config import Kind
from situgraph.plan.layouts import make_layout
from situgraph.plan.six_rooms import six_rooms
from situgraph.scenegraph.graph import Object, Plane, Room, SceneGraph

NEAR = 1e-3  # m
IN_WALL = {"door", "window"}


def nearest(points: list[tuple[float, ...]], point: tuple[float, ...]) -> int:
    away = np.linalg.norm(np.array(points) - np.array(point), axis=1)
    assert away.min() < NEAR
    return int(np.argmin(away))


def same_plane(one: Plane, other: Plane) -> bool:
    assert one.extent is not None
    assert other.extent is not None
    ends = np.sort(np.array(one.extent), axis=0), np.sort(np.array(other.extent), axis=0)
    return (
        float(np.dot(one.normal, other.normal)) > math.cos(1e-4)
        and float(np.abs(ends[0] - ends[1]).max()) < NEAR
    )


def assert_same_room(
    room: Room, there: Room, graph: SceneGraph, read: SceneGraph
) -> dict[str, str]:
    """Footprints and planes agree; gives the read plane of each written one."""
    assert room.footprint is not None
    assert there.footprint is not None
    assert len(room.footprint) == len(there.footprint)
    for corner in room.footprint:
        nearest(list(there.footprint), corner)
    pairs = {}
    for plane_id in room.planes:
        plane = graph.plane_by_id[plane_id]
        found = [p for p in there.planes if same_plane(plane, read.plane_by_id[p])]
        assert len(found) == 1
        seen = read.plane_by_id[found[0]]
        assert seen.offset == pytest.approx(plane.offset, abs=NEAR)
        assert not seen.virtual
        pairs[plane_id] = found[0]
    assert len(there.planes) == len(room.planes)
    return pairs


def assert_same_object(item: Object, seen: Object, exact_depth: bool) -> None:
    assert item.ellipsoid is not None
    assert seen.ellipsoid is not None
    assert seen.category == item.category
    np.testing.assert_allclose(seen.center, item.center, atol=NEAR)
    axes, read = item.ellipsoid.axes, seen.ellipsoid.axes
    flat, read_flat = sorted(axes[:2]), sorted(read[:2])
    assert read_flat[1] == pytest.approx(flat[1], abs=NEAR)
    assert read[2] == pytest.approx(axes[2], abs=NEAR)
    if exact_depth or item.category not in IN_WALL:
        assert read_flat[0] == pytest.approx(flat[0], abs=NEAR)


def assert_round_trip(graph: SceneGraph, path: Path, exact_depth: bool = False) -> None:
    read = build_graph(write_ifc(graph, path), PlanConfig())
    assert not read.warnings
    assert [s.elevation for s in read.storeys] == pytest.approx(
        [s.elevation for s in graph.storeys], abs=NEAR
    )
    assert len(read.rooms) == len(graph.rooms)
    assert len(read.planes) == len(graph.planes)
    assert len(read.objects) == len(graph.objects)
    rooms, planes = {}, {}
    centers: list[tuple[float, ...]] = [r.center for r in read.rooms]
    for room in graph.rooms:
        there = read.rooms[nearest(centers, room.center)]
        rooms[room.id] = there.id
        planes.update(assert_same_room(room, there, graph, read))
    assert len(set(rooms.values())) == len(rooms)
    places: list[tuple[float, ...]] = [o.center for o in read.objects]
    for item in graph.objects:
        seen = read.objects[nearest(places, item.center)]
        assert_same_object(item, seen, exact_depth)
        assert set(seen.rooms) == {rooms[r] for r in item.rooms}
        assert set(seen.planes) == {planes[p] for p in item.planes}


@pytest.mark.parametrize("rooms", range(1, 7))
def test_six_rooms_come_back(rooms: int, tmp_path: Path) -> None:
    assert_round_trip(six_rooms(rooms), tmp_path / "six.ifc", exact_depth=True)


@pytest.mark.parametrize(
    "kind", ["random", "modular", "grid", "corridor", "storeys", "lshaped", "wings"]
)
def test_layouts_come_back(kind: Kind, tmp_path: Path) -> None:
    assert_round_trip(make_layout(kind, 13, seed=4), tmp_path / "layout.ifc")


def test_symmetric_layouts_far_from_the_origin_come_back(tmp_path: Path) -> None:
    frame = Placement(300.0, -200.0, 12.0, 0.7)
    graph = make_layout("modular", 9, seed=1, symmetry="global", frame=frame, storeys=3)
    assert_round_trip(graph, tmp_path / "layout.ifc")


def test_the_file_goes_through_the_public_reader(tmp_path: Path) -> None:
    graph = read_ifc(write_ifc(six_rooms(), tmp_path / "six.ifc"))
    assert len(graph.rooms) == 6
    assert [r.name for r in graph.rooms] == [f"room {i}" for i in range(1, 7)]
    assert graph.storeys[0].name == "ground floor"


def test_the_same_graph_gives_the_same_bytes(tmp_path: Path) -> None:
    one = write_ifc(six_rooms(), tmp_path / "one.ifc").read_bytes()
    assert one == write_ifc(six_rooms(), tmp_path / "two.ifc").read_bytes()
    assert b"FILE_SCHEMA(('IFC4'))" in one


def test_the_model_is_valid_ifc(tmp_path: Path) -> None:
    import ifcopenshell
    import ifcopenshell.validate

    model = ifcopenshell.open(str(write_ifc(six_rooms(), tmp_path / "six.ifc")))
    log = ifcopenshell.validate.json_logger()  # type: ignore[no-untyped-call]
    ifcopenshell.validate.validate(model, log)
    assert [s for s in log.statements if s.get("level") == "error"] == []
    guids = [e.GlobalId for e in model.by_type("IfcRoot")]
    assert len(set(guids)) == len(guids)
    counts = {
        kind: len(model.by_type(kind))
        for kind in ("IfcProject", "IfcSite", "IfcBuilding", "IfcBuildingStorey", "IfcSpace")
    }
    assert list(counts.values()) == [1, 1, 1, 1, 6]
    assert len(model.by_type("IfcDoor")) == 9
    assert len(model.by_type("IfcWindow")) == 16
    assert len(model.by_type("IfcRelVoidsElement")) == 25
    assert len(model.by_type("IfcRelFillsElement")) == 25


def test_walls_and_rooms_fill_the_floor_without_overlap(tmp_path: Path) -> None:
    import shapely

    from situgraph.plan.wall_pieces import wall_pieces

    graph = make_layout("random", 30, seed=2)
    rooms = shapely.union_all([shapely.Polygon(r.footprint) for r in graph.rooms])
    walls = [shapely.Polygon(p.outline) for p in wall_pieces(graph)]
    assert all(w.is_valid and w.exterior.is_ccw for w in walls)
    assert shapely.union_all(walls).intersection(rooms).area < 1e-4
    everything = shapely.union_all([*walls, rooms.buffer(1e-5)])
    # One body without a hole: nothing looks out between two walls.
    assert isinstance(everything, shapely.Polygon)
    assert sum(shapely.Polygon(hole).area for hole in everything.interiors) < 1e-3
    # And its outline is all wall.
    assert everything.exterior.distance(rooms) > 0.02


def test_rooms_without_footprints_cannot_be_written(tmp_path: Path) -> None:
    graph = SceneGraph(name="bare", rooms=(Room("r1", (0.0, 0.0, 1.0), ()),))
    with pytest.raises(InputError, match="footprint"):
        write_ifc(graph, tmp_path / "bare.ifc")
    with pytest.raises(InputError, match="no rooms"):
        write_ifc(SceneGraph(name="empty"), tmp_path / "empty.ifc")
    assert not list(tmp_path.iterdir())
