"""Outlines, faces, walls and openings: geometry against what is known by construction."""

from __future__ import annotations

import math

import msgspec
import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from tests.view.buildings import WALL, office

from situgraph.geometry.poses import Placement
from situgraph.scenegraph.graph import Object, Plane, Room, SceneGraph
from situgraph.scenegraph.transform import transformed
from situgraph.view import ViewConfig
from situgraph.view.floors import survey
from situgraph.view.outlines import room_outlines

CONFIG = ViewConfig()


def area(polygon: np.ndarray) -> float:
    x, y = polygon.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))


def ring(corners: list[tuple[float, float]], order: list[int] | None = None) -> SceneGraph:
    """A room whose planes are the edges of a counter-clockwise polygon, without extents."""
    planes = []
    for i, (ax, ay) in enumerate(corners):
        bx, by = corners[(i + 1) % len(corners)]
        length = math.hypot(bx - ax, by - ay)
        n = (-(by - ay) / length, (bx - ax) / length, 0.0)
        planes.append(Plane(f"p{i}", n, -(n[0] * ax + n[1] * ay)))
    center = (*np.mean(corners, axis=0).tolist(), 1.0)
    ids = tuple(f"p{i}" for i in (order or range(len(corners))))
    return SceneGraph(rooms=(Room("r", center, ids),), planes=tuple(planes))


@given(
    st.floats(2.0, 9.0), st.floats(2.0, 9.0), st.floats(-3.0, 3.0), st.permutations([0, 1, 2, 3])
)
def test_four_planes_in_any_order_enclose_their_rectangle(
    w: float, h: float, yaw: float, order: list[int]
) -> None:
    graph = transformed(ring([(0, 0), (w, 0), (w, h), (0, h)], order), Placement(5, -3, 0, yaw))
    outline = room_outlines(graph, CONFIG)["r"]
    assert area(outline.polygon) == pytest.approx(w * h, rel=1e-6)
    assert sorted(s or "" for s in outline.sides) == ["p0", "p1", "p2", "p3"]
    assert not any(outline.open)


@given(st.floats(-3.0, 3.0), st.booleans())
def test_planes_given_around_an_l_shape_give_it_back(yaw: float, clockwise: bool) -> None:
    corners = [(0, 0), (6, 0), (6, 2), (2, 2), (2, 5), (0, 5)]
    order = [0, 5, 4, 3, 2, 1] if clockwise else [0, 1, 2, 3, 4, 5]
    graph = transformed(ring(corners, order), Placement(0, 0, 0, yaw))
    outline = room_outlines(graph, CONFIG)["r"]
    assert area(outline.polygon) == pytest.approx(18.0)
    for i, side in enumerate(outline.sides):
        plane = graph.plane_by_id[side or ""]
        for corner in (outline.polygon[i], outline.polygon[(i + 1) % 6]):
            distance = np.dot(plane.normal[:2], corner) + plane.offset
            assert distance == pytest.approx(0.0, abs=1e-9)


def test_a_clockwise_footprint_is_turned() -> None:
    room = Room("r", (1, 1, 1), (), footprint=((0, 0), (0, 2), (2, 2), (2, 0)))
    assert area(room_outlines(SceneGraph(rooms=(room,)), CONFIG)["r"].polygon) == pytest.approx(4)


def test_a_corridor_ends_openly_at_its_neighbours_or_after_the_usual_reach() -> None:
    planes = (Plane("up", (0, -1, 0), 2.0), Plane("down", (0, 1, 0), 0.0))
    corridor = Room("c", (0.0, 1.0, 1.0), ("up", "down"))
    alone = room_outlines(SceneGraph(rooms=(corridor,), planes=planes), CONFIG)["c"]
    assert area(alone.polygon) == pytest.approx(2.0 * 2 * CONFIG.open_reach)
    assert sum(alone.open) == 2
    beside = Room("n", (7.0, 1.0, 1.0), (), footprint=((5, -1), (9, -1), (9, 3), (5, 3)))
    graph = SceneGraph(rooms=(corridor, beside), planes=planes)
    x = room_outlines(graph, CONFIG)["c"].polygon[:, 0]
    assert x.min() == pytest.approx(-CONFIG.open_reach)
    assert 4.5 < x.max() < 5.0


def test_extents_say_how_far_a_corridor_was_seen() -> None:
    planes = (
        Plane("up", (0, -1, 0), 2.0, extent=((-6, 2), (4, 2))),
        Plane("down", (0, 1, 0), 0.0, extent=((-5, 0), (5, 0))),
    )
    graph = SceneGraph(rooms=(Room("c", (0.0, 1.0, 1.0), ("up", "down")),), planes=planes)
    x = room_outlines(graph, CONFIG)["c"].polygon[:, 0]
    assert (x.min(), x.max()) == pytest.approx((-6.0, 5.0))


def test_floors_and_ceilings_are_no_walls() -> None:
    graph = SceneGraph(
        rooms=(Room("r", (0, 0, 1), ("floor",)),), planes=(Plane("floor", (0, 0, 1), 0.0),)
    )
    assert room_outlines(graph, CONFIG) == {}
    assert not survey(graph, CONFIG).floors[0].faces.ids


def wall_shape(walls: tuple[tuple[np.ndarray, ...], ...]) -> shapely.Geometry:
    return shapely.union_all([shapely.Polygon(rings[0], rings[1:]) for rings in walls])


@pytest.mark.parametrize("footprints", [True, False])
def test_back_to_back_faces_make_a_wall_with_its_junctions(footprints: bool) -> None:
    graph = office(2, 2, footprints=footprints).replace(objects=())
    floor = survey(graph, CONFIG).floors[0]
    solid = wall_shape(floor.walls.solid)
    cross = 7.8 * WALL + 9.8 * WALL - WALL**2
    assert solid.area == pytest.approx(cross, rel=1e-3)
    band = wall_shape(floor.walls.one_face)
    assert band.area == pytest.approx(2 * (9.8 + 7.8 + 2 * WALL) * WALL, rel=0.01)
    assert solid.intersection(band).area == pytest.approx(0.0, abs=1e-6)


def test_openings_are_cut_out_of_walls() -> None:
    graph = office(2, 1)
    floor = survey(graph, CONFIG).floors[0]
    door = next(o for o in floor.openings if o.kind == "door")
    assert (door.front - door.back) == pytest.approx(WALL)
    assert 2.0 * door.half_width == pytest.approx(1.0)
    assert wall_shape(floor.walls.solid).area == pytest.approx((3.8 - 1.0) * WALL, rel=1e-3)


def test_a_door_far_from_every_wall_is_an_object() -> None:
    graph = office(1, 1).replace(objects=(Object("o", "door", (2.4, 1.9, 1.0)),))
    floor = survey(graph, CONFIG).floors[0]
    assert not floor.openings
    assert [o.id for o in floor.objects] == ["o"]


def test_free_planes_behind_known_faces_are_the_backs_of_their_walls() -> None:
    graph = office(1, 1, footprints=False).replace(objects=())
    outer = (
        Plane("w", (-1, 0, 0), -0.3), Plane("e", (1, 0, 0), -5.1),
        Plane("s", (0, -1, 0), -0.3), Plane("n", (0, 1, 0), -4.1),
    )  # fmt: skip
    floor = survey(graph.replace(planes=graph.planes + outer), CONFIG).floors[0]
    assert wall_shape(floor.walls.solid).area == pytest.approx(5.4 * 4.4 - 4.8 * 3.8, rel=0.01)
    assert not floor.walls.one_face
    assert not floor.faces.infinite.any()
    assert not floor.walls.loose


def test_a_loose_face_with_an_extent_stays_a_line() -> None:
    plane = Plane("free", (1, 0, 0), 9.0, extent=((-9, 0), (-9, 3)))
    graph = office(1, 1)
    floor = survey(graph.replace(planes=(*graph.planes, plane)), CONFIG).floors[0]
    assert floor.walls.loose == ("free",)


def test_rooms_without_a_storey_go_to_the_one_at_their_height() -> None:
    graph = office(1, 1, storeys=3)
    rooms = tuple(msgspec.structs.replace(r, storey=None) for r in graph.rooms)
    floors = survey(graph.replace(rooms=rooms), CONFIG).floors
    assert [[s.id for s in f.rooms] for f in floors] == [["r0-0-0"], ["r1-0-0"], ["r2-0-0"]]


def test_broken_footprints_do_not_stop_the_drawing() -> None:
    bow = ((0, 0), (4, 4), (4, 0), (0, 4))
    flat = ((0, 0), (1, 0), (2, 0))
    rooms = (
        Room("bow", (2, 2, 1), (), footprint=bow),
        Room("flat", (1, 0, 1), (), footprint=flat),
    )
    assert survey(SceneGraph(rooms=rooms), CONFIG).floors
