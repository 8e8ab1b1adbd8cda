"""What a user sees of an IFC file read as an A-Graph, on small models written by the tests."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import Point, Polygon
from tests.plan.ifc_author import FOOT, METRE, MILLIMETRE, Author, rectangle, two_rooms

from situgraph.geometry.poses import Placement
from situgraph.plan.config import PlanConfig
from situgraph.plan.ifc import read_ifc
from situgraph.scenegraph.codec import encode
from situgraph.scenegraph.graph import Object, Plane, Room, SceneGraph

HERE = PlanConfig(isolate=False)  # in this process: the child is tested on its own


def read(author: Author, folder: Path, schema_name: str | None = None) -> SceneGraph:
    return read_ifc(author.save(folder / "model.ifc", schema_name), HERE)


def room(graph: SceneGraph, name: str) -> Room:
    return next(r for r in graph.rooms if r.name == name)


def planes(graph: SceneGraph, name: str) -> list[Plane]:
    return [graph.plane_by_id[key] for key in room(graph, name).planes]


def by_guid(graph: SceneGraph, entity: Any) -> Object:
    return next(o for o in graph.objects if o.attributes["guid"] == entity.GlobalId)


def codes(graph: SceneGraph) -> dict[str, tuple[str, ...]]:
    return {w.code: w.ids for w in graph.warnings}


def check_two_rooms(graph: SceneGraph, made: dict[str, Any], shift: tuple[float, float]) -> None:
    """The two-room house of the author, ``shift`` added to its coordinates."""
    dx, dy = shift
    assert [r.name for r in graph.rooms] == ["A", "B"]
    assert room(graph, "A").center == pytest.approx((2 + dx, 1.5 + dy, 1.25), abs=1e-6)
    assert room(graph, "B").attributes["area"] == pytest.approx(9.0)
    for name in ("A", "B"):
        center = np.array(room(graph, name).center)
        found = planes(graph, name)
        assert len(found) == 4
        assert not any(p.virtual for p in found)
        assert all(p.source.startswith("IfcWall ") for p in found if p.source is not None)
        distances = [float(np.dot(p.normal, center) + p.offset) for p in found]
        sides = sorted((2.0, 2.0, 1.5, 1.5)) if name == "A" else [1.5] * 4
        assert sorted(distances) == pytest.approx(sides, abs=1e-6)
    door = by_guid(graph, made["door"])
    assert door.category == "door"
    assert door.attributes["leaf"] is True
    assert [graph.room_by_id[r].name for r in door.rooms] == ["A", "B"]
    assert [graph.plane_by_id[p].normal[0] for p in door.planes] == pytest.approx([-1.0, 1.0])
    assert door.center == pytest.approx((4.1 + dx, 1.0 + dy, 1.05), abs=1e-6)
    assert door.ellipsoid is not None
    assert door.ellipsoid.axes == pytest.approx((0.45, 0.1, 1.05), abs=1e-6)
    entrance = by_guid(graph, made["entrance"])
    assert entrance.rooms == (room(graph, "B").id,)
    assert len(entrance.planes) == 1
    for key, name in (("window a", "A"), ("window b", "B")):
        window = by_guid(graph, made[key])
        assert window.category == "window"
        assert window.rooms == (room(graph, name).id,)
        assert len(window.planes) == 1
    assert graph.modelled_categories == ("door", "window")


@pytest.mark.parametrize("unit", [METRE, MILLIMETRE, FOOT])
def test_two_rooms_in_any_unit(tmp_path: Path, unit: float) -> None:
    author = Author("IFC4", unit)
    made = two_rooms(author, author.storey("EG", 0.0))
    graph = read(author, tmp_path)
    check_two_rooms(graph, made, (0.0, 0.0))
    assert graph.warnings == ()
    assert graph.name == "model"
    assert [(s.id, s.name, s.elevation) for s in graph.storeys] == [("s0", "EG", 0.0)]
    assert room(graph, "A").attributes["long_name"] == "Office"


@pytest.mark.parametrize(
    ("schema", "header"),
    [
        ("IFC2X3", None),
        ("IFC2X3", "IFC2X_FINAL"),
        ("IFC2X3", "IFC2X3_TC1"),
        ("IFC4", None),
        ("IFC4X3_ADD2", None),
        ("IFC4X3_ADD2", "IFC4X3"),
    ],
)
def test_every_schema(tmp_path: Path, schema: str, header: str | None) -> None:
    author = Author(schema)
    made = two_rooms(author, author.storey("EG", 0.0))
    graph = read(author, tmp_path, header)
    check_two_rooms(graph, made, (0.0, 0.0))
    assert graph.attributes["schema"] == (header or schema)
    assert ("schema-read-as" in codes(graph)) == (header == "IFC2X_FINAL")


@pytest.mark.parametrize("where", ["placement", "points"])
def test_far_away_coordinates(tmp_path: Path, where: str) -> None:
    far = (2_600_000.25, 1_200_000.5)
    author = Author(far=(*far, 0.0)) if where == "placement" else Author(far_points=far)
    made = two_rooms(author, author.storey("EG", 0.0))
    if where == "points":  # walls and holes of the author follow their outline
        author = Author(far_points=far)
        made = two_rooms(author, author.storey("EG", 0.0))
    graph = read(author, tmp_path)
    offset = (graph.attributes["offset_x"], graph.attributes["offset_y"])
    assert "model-offset" in codes(graph)
    assert all(math.hypot(*r.center[:2]) < 20.0 for r in graph.rooms)
    check_two_rooms(graph, made, (far[0] - float(offset[0]), far[1] - float(offset[1])))


@settings(max_examples=15)
@given(
    yaw=st.floats(-math.pi, math.pi),
    x=st.floats(-300.0, 300.0),
    y=st.floats(-300.0, 300.0),
)
def test_a_turned_building_gives_the_turned_graph(
    tmp_path_factory: pytest.TempPathFactory, yaw: float, x: float, y: float
) -> None:
    folder = tmp_path_factory.mktemp("turned")
    author = Author(far=(x, y, 0.0), yaw=yaw)
    made = two_rooms(author)
    graph = read(author, folder)
    turn = Placement(x, y, 0.0, yaw)
    assert room(graph, "A").center == pytest.approx(tuple(turn.points((2.0, 1.5, 1.25))), abs=1e-5)
    normals, offsets = graph.plane_arrays(room(graph, "A").planes)
    expected = turn.planes(
        np.array([[0, 1, 0], [-1, 0, 0], [0, -1, 0], [1, 0, 0]], dtype=float), [0, 4, 3, 0]
    )
    found = {tuple(np.round((*n, d), 3) + 0.0) for n, d in zip(normals, offsets, strict=True)}
    wanted = {tuple(np.round((*n, d), 3) + 0.0) for n, d in zip(*expected, strict=True)}
    near = [min(np.abs(np.array(f) - w).max() for w in wanted) for f in found]
    assert len(found) == 4
    assert max(near) <= 2e-3
    door = by_guid(graph, made["door"])
    assert len(door.rooms) == len(door.planes) == 2
    assert door.center == pytest.approx(tuple(turn.points((4.1, 1.0, 1.05))), abs=1e-5)


def test_the_graph_is_the_same_every_time(tmp_path: Path) -> None:
    author = Author()
    two_rooms(author, author.storey("EG", 0.0))
    path = author.save(tmp_path / "model.ifc")
    assert encode(read_ifc(path, HERE)) == encode(read_ifc(path, HERE))


def test_bare_openings_are_doors_without_a_leaf_when_one_can_walk_through(tmp_path: Path) -> None:
    author = Author()
    made = two_rooms(author)
    passage = author.opening(made["middle"], (4.1, 2.3), (0.0, 1.0), 0.9)
    author.opening(made["middle"], (4.1, 2.3), (0.0, 1.0), 0.9, sill=1.2, height=0.5)
    graph = read(author, tmp_path)
    door = by_guid(graph, passage)
    assert door.category == "door"
    assert door.attributes["leaf"] is False
    assert len(door.rooms) == 2
    assert len(codes(graph)["opening-left-out"]) == 1


def test_a_door_may_have_no_opening(tmp_path: Path) -> None:
    author = Author()
    made = two_rooms(author)
    loose = author.door(made["middle"], (4.1, 2.3), (0.0, 1.0), 0.8, hosted=False)
    graph = read(author, tmp_path)
    assert len(by_guid(graph, loose).rooms) == 2
    assert len(by_guid(graph, loose).planes) == 2


def test_doors_and_windows_without_room_are_named(tmp_path: Path) -> None:
    author = Author()
    two_rooms(author)
    fence = author.wall((20.0, 0.0), (25.0, 0.0))
    gate = author.door(fence, (22.0, 0.0), (1.0, 0.0))
    pane = author.window(fence, (24.0, 0.0), (1.0, 0.0))
    graph = read(author, tmp_path)
    for made, code in ((gate, "door-without-room"), (pane, "window-without-room")):
        item = by_guid(graph, made)
        assert item.rooms == ()
        assert codes(graph)[code] == (item.id,)
        warning = next(w for w in graph.warnings if w.code == code)
        assert made.GlobalId in warning.message


def test_a_cubicle_door_is_in_the_room_and_on_no_plane(tmp_path: Path) -> None:
    author = Author()
    two_rooms(author)
    partition = author.wall((1.0, 0.5), (1.0, 2.5), 0.05, height=1.8)
    cubicle = author.door(partition, (1.0, 1.5), (0.0, 1.0), 0.7)
    graph = read(author, tmp_path)
    door = by_guid(graph, cubicle)
    assert door.rooms == (room(graph, "A").id,)
    assert door.planes == ()
    assert codes(graph)["door-on-no-plane"] == (door.id,)


def test_the_same_door_twice_is_one_door(tmp_path: Path) -> None:
    author = Author()
    made = two_rooms(author)
    again = author.door(made["middle"], (4.1, 1.0), (0.0, 1.0), hosted=False)
    graph = read(author, tmp_path)
    assert sum(o.category == "door" for o in graph.objects) == 2
    assert codes(graph)["duplicate-object"] == (again.GlobalId,)


def test_open_plan_has_a_virtual_face(tmp_path: Path) -> None:
    author = Author()
    author.space("kitchen", rectangle(0, 0, 3, 3))
    author.space("living", rectangle(3, 0, 8, 3))
    for start, end in (
        ((-0.1, -0.1), (-0.1, 3.1)),
        ((8.1, -0.1), (8.1, 3.1)),
        ((-0.1, -0.1), (8.1, -0.1)),
        ((-0.1, 3.1), (8.1, 3.1)),
    ):
        author.wall(start, end)
    author.wall((3.0, -0.1), (3.0, 3.1), 0.2, bottom=2.2, height=0.6, name="lintel")
    graph = read(author, tmp_path)
    for name, sign in (("kitchen", -1.0), ("living", 1.0)):
        virtual = [p for p in planes(graph, name) if p.virtual]
        assert [p.normal for p in virtual] == [(sign, 0.0, 0.0)]
        assert virtual[0].source is None


def test_an_l_shaped_room_with_a_pillar(tmp_path: Path) -> None:
    outline = [(0, 0), (6, 0), (6, 2), (2, 2), (2, 6), (0, 6)]
    pillar = [(0.8, 0.8), (1.2, 0.8), (1.2, 1.2), (0.8, 1.2)]
    author = Author()
    author.space("L", outline, holes=[pillar])
    author.wall((0, 0), (1, 0))
    graph = read(author, tmp_path)
    found = room(graph, "L")
    floor = Polygon(found.footprint)
    assert floor.exterior.is_ccw
    assert floor.equals_exact(Polygon(outline).normalize(), 1e-6) or floor.equals(Polygon(outline))
    assert found.attributes["area"] == pytest.approx(20.0 - 0.16)
    assert found.attributes["holes"] == 1
    assert floor.difference(Polygon(pillar)).contains(Point(found.center[:2]))
    assert len(found.planes) == 6 + 4
    inside = floor.difference(Polygon(pillar))
    for plane in planes(graph, "L"):
        (x0, y0), (x1, y1) = plane.extent or ((0, 0), (0, 0))
        nx, ny, _ = plane.normal
        ahead = Point((x0 + x1) / 2 + 0.01 * nx, (y0 + y1) / 2 + 0.01 * ny)
        assert inside.contains(ahead), plane


def test_coplanar_facets_are_one_face_and_slivers_are_named(tmp_path: Path) -> None:
    # A niche 5 cm wide and a window bay split the south side in three stretches of one plane.
    outline = [
        (0, 0), (2, 0), (2, -0.4), (3, -0.4), (3, 0), (6, 0), (6, 4), (4.05, 4), (4.05, 4.3),
        (4, 4.3), (4, 4), (0, 4),
    ]  # fmt: skip
    author = Author()
    author.space("bay", outline)
    author.wall((0, -0.1), (6, -0.1))
    graph = read(author, tmp_path)
    south = [p for p in planes(graph, "bay") if p.normal[1] > 0.9 and abs(p.offset) < 1e-6]
    assert len(south) == 1
    assert south[0].attributes["length"] == pytest.approx(5.0)
    assert south[0].extent == ((0.0, 0.0), (6.0, 0.0))
    assert codes(graph)["sliver-faces"] == (room(graph, "bay").id,)


@pytest.mark.parametrize("flip", [(), range(6), (2,), (1, 3, 5)])
def test_faces_point_into_the_room_however_the_body_winds(
    tmp_path: Path, flip: tuple[int, ...]
) -> None:
    author = Author()
    author.space("box", [], body=author.faceted((1, 2, 0), (5, 5, 2.5), flip))
    author.wall((1, 1.9), (5, 1.9))
    graph = read(author, tmp_path)
    center = np.array(room(graph, "box").center)
    found = planes(graph, "box")
    assert len(found) == 4
    assert all(float(np.dot(p.normal, center) + p.offset) > 1.0 for p in found)
    assert [p.virtual for p in found if p.normal[1] > 0.9] == [False]


def test_a_room_under_a_roof_is_clipped(tmp_path: Path) -> None:
    author = Author()
    author.space("attic", [], body=author.roofed(rectangle(0, 0, 4, 3), 0.0, 3.0, 0.5))
    author.wall((-0.1, 0), (-0.1, 3))
    graph = read(author, tmp_path)
    heights = {round(p.normal[0]): p.attributes["top"] for p in planes(graph, "attic")}
    assert heights[1] == pytest.approx(3.0)
    assert heights[-1] == pytest.approx(1.0)
    assert room(graph, "attic").attributes["area"] == pytest.approx(12.0)


def test_curtain_walls_stand_behind_a_face_by_their_parts(tmp_path: Path) -> None:
    author = Author()
    author.space("hall", rectangle(0, 0, 4, 3))
    curtain = author.model.create_entity("IfcCurtainWall", GlobalId="2O2Fr$t4X7Zf8NOew3FLOH")
    panes = [((x + 0.5, -0.05), (1.0, 0.1)) for x in range(4)]
    author.parts(curtain, "IfcPlate", panes)
    graph = read(author, tmp_path)
    south = next(p for p in planes(graph, "hall") if p.normal[1] > 0.9)
    assert south.virtual is False
    assert south.attributes["backed"] == pytest.approx(1.0)
    assert south.source == "IfcCurtainWall 2O2Fr$t4X7Zf8NOew3FLOH"


def test_fixtures_and_furniture_stand_in_rooms(tmp_path: Path) -> None:
    author = Author("IFC4")
    two_rooms(author)
    column = author.element("IfcColumn", (1.0, 1.0), (0.3, 0.3), height=2.5)
    table = author.element("IfcFurniture", (5.0, 1.0), (1.6, 0.8))
    toilet = author.element(
        "IfcSanitaryTerminal", (6.5, 2.5), (0.4, 0.6), PredefinedType="TOILETPAN"
    )
    author.element("IfcBuildingElementProxy", (40.0, 1.0), (3.0, 3.0))
    graph = read(author, tmp_path)
    for made, category, name in (
        (column, "column", "A"),
        (table, "furniture", "B"),
        (toilet, "toilet", "B"),
    ):
        item = by_guid(graph, made)
        assert item.category == category
        assert item.rooms == (room(graph, name).id,)
    table_axes = by_guid(graph, table).ellipsoid
    assert table_axes is not None
    assert table_axes.axes == pytest.approx((0.8, 0.4, 0.4))
    assert len(codes(graph)["outside-object"]) == 1
    assert set(graph.modelled_categories or ()) == {
        "door", "window", "column", "furniture", "toilet",
    }  # fmt: skip


def test_what_hangs_on_a_wall_is_on_its_face(tmp_path: Path) -> None:
    author = Author("IFC4")
    two_rooms(author)
    radiator = author.element("IfcSpaceHeater", (2.0, 2.92), (1.0, 0.1), 0.2, 0.6)
    away = author.element("IfcSpaceHeater", (2.0, 1.5), (1.0, 0.1), 0.2, 0.6)
    graph = read(author, tmp_path)
    (plane,) = by_guid(graph, radiator).planes
    assert plane in room(graph, "A").planes
    assert graph.plane_by_id[plane].normal == (0.0, -1.0, 0.0)
    assert by_guid(graph, away).rooms == (room(graph, "A").id,)
    assert by_guid(graph, away).planes == ()


def test_space_boundaries_audit_the_geometry(tmp_path: Path) -> None:
    author = Author()
    made = two_rooms(author)
    for space in ("a", "b"):
        author.boundary(made[space], made["door"])
    author.boundary(made["a"], made["entrance"])  # wrong: it leads into B
    graph = read(author, tmp_path)
    assert graph.attributes["boundaries_door_checked"] == 2
    assert graph.attributes["boundaries_door_agreed"] == 1
    entrance = by_guid(graph, made["entrance"])
    assert [graph.room_by_id[r].name for r in entrance.rooms] == ["B"]
    assert codes(graph)["boundary-differs"][0] == entrance.id


def test_true_north_is_an_attribute(tmp_path: Path) -> None:
    author = Author()
    two_rooms(author)
    author.context.TrueNorth = author.model.create_entity("IfcDirection", (0.0, -1.0))
    assert read(author, tmp_path).attributes["true_north"] == pytest.approx(-math.pi / 2)


# ---------------------------------------------------------------------- storeys


def house(author: Author, storeys: list[Any], floors: list[float]) -> None:
    for number, (storey, floor) in enumerate(zip(storeys, floors, strict=True)):
        author.space(f"{number}", rectangle(0, 0, 4, 3), floor, storey=storey)
        author.wall((-0.1, 0), (-0.1, 3), bottom=floor, storey=storey)


def test_declared_elevations_of_zero_are_corrected(tmp_path: Path) -> None:
    author = Author()
    storeys = [author.storey(name, 0.0) for name in ("EG", "OG")]
    house(author, storeys, [0.0, 3.0])
    graph = read(author, tmp_path)
    assert [(s.name, s.elevation) for s in graph.storeys] == [("EG", 0.0), ("OG", 3.0)]
    assert graph.storeys[0].height == pytest.approx(3.0)
    assert codes(graph)["storey-elevation"] == ("s1",)


def test_storeys_without_rooms_are_left_out_by_name(tmp_path: Path) -> None:
    author = Author()
    house(author, [author.storey("EG", 0.0)], [0.0])
    pseudo = author.storey("T.O. floor", 0.3)
    graph = read(author, tmp_path)
    assert [s.name for s in graph.storeys] == ["EG"]
    assert codes(graph)["storey-without-rooms"] == (pseudo.GlobalId,)


@pytest.mark.parametrize("declared", [True, False])
def test_floors_are_told_apart_without_storeys(tmp_path: Path, declared: bool) -> None:
    author = Author()
    only = author.storey("all", 0.0) if declared else None
    house(author, [only, only, only], [0.0, 3.0, 6.0])
    graph = read(author, tmp_path)
    assert [s.elevation for s in graph.storeys] == [0.0, 3.0, 6.0]
    assert [r.storey for r in graph.rooms] == ["s0", "s1", "s2"]
    expected = "room-off-storey" if declared else "room-without-storey"
    assert expected in codes(graph)


def test_a_flat_outline_is_no_room_beside_its_rooms(tmp_path: Path) -> None:
    author = Author()
    made = two_rooms(author)
    flat = author.space("flat", rectangle(0, 0, 7.2, 3))
    author.model.create_entity(
        "IfcRelAggregates",
        GlobalId="1xS3BCk291UvhgP2a6eflL",
        RelatingObject=flat,
        RelatedObjects=[made["a"], made["b"]],
    )
    assert [r.name for r in read(author, tmp_path).rooms] == ["A", "B"]


def test_overlapping_rooms_are_named(tmp_path: Path) -> None:
    author = Author()
    author.space("big", rectangle(0, 0, 6, 4))
    author.space("small", rectangle(4, 0, 8, 4))
    author.wall((-0.1, 0), (-0.1, 4))
    graph = read(author, tmp_path)
    assert codes(graph)["rooms-overlap"] == (room(graph, "big").id, room(graph, "small").id)
