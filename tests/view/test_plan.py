"""The drawing of a graph: what a reader of the SVG finds in it."""

from __future__ import annotations

import re
from xml.etree.ElementTree import Element

import pytest
from defusedxml.ElementTree import fromstring
from tests.view.buildings import office, walked

from situgraph.errors import InputError
from situgraph.scenegraph.graph import Object, Plane, Room, SceneGraph, Warning
from situgraph.view import ViewConfig, draw_graph, save_figure
from situgraph.view.canvas import inline_svg, png_bytes, svg_text

HOSTILE = '<script>alert(1)</script> & "x" $\\frac{1}{$'


def texts(svg: str) -> list[str]:
    root: Element = fromstring(svg)
    return [t.text or "" for t in root.iter("{http://www.w3.org/2000/svg}text")]


def test_every_room_is_named() -> None:
    graph = office()
    assert {r.name for r in graph.rooms} <= set(texts(svg_text(draw_graph(graph))))


def test_five_storeys_give_five_panels_with_their_names() -> None:
    figure = draw_graph(office(2, 1, storeys=5))
    found = texts(svg_text(figure))
    assert {f"Level {i}" for i in range(5)} <= set(found)
    drawn = [a for a in figure.axes if len(a.collections) > 3]
    assert len({tuple(a.get_position().bounds) for a in drawn}) >= 5


def test_panels_are_limited_and_say_so() -> None:
    found = texts(svg_text(draw_graph(office(2, 1, storeys=5), ViewConfig(max_panels=3))))
    assert "Level 2" in found
    assert "Level 3" not in found
    assert any(t.startswith("2 further storeys are not drawn") for t in found)


def test_a_storey_is_chosen_by_name_or_id() -> None:
    graph = office(2, 1, storeys=3)
    for wanted in ("Level 1", "s1"):
        found = texts(svg_text(draw_graph(graph, storeys=[wanted])))
        assert "101" not in found or "100" in found
        assert "000" not in found
    with pytest.raises(InputError, match=r"no storey 'cellar'.*Level 0 \(s0\)"):
        draw_graph(graph, storeys=["cellar"])


def test_the_same_graph_gives_the_same_bytes() -> None:
    graph = walked(office(storeys=2))
    assert svg_text(draw_graph(graph)) == svg_text(draw_graph(graph))
    assert png_bytes(draw_graph(graph), 50) == png_bytes(draw_graph(graph), 50)


def test_nothing_of_the_day_or_the_machine_is_in_the_file() -> None:
    svg = svg_text(draw_graph(office(1, 1)))
    assert "<dc:date>" not in svg
    assert "matplotlib.org" not in svg.split("<g ")[1]


@pytest.mark.parametrize(
    "name", [HOSTILE, "a\x00b\x1b[31m", "$x_{", "\u202egnp.exe", "", "名前" * 80]
)
def test_hostile_names_are_inert(name: str) -> None:
    graph = office(2, 1, name=name)
    rooms = tuple(Room(r.id, r.center, r.planes, r.storey, name, r.footprint) for r in graph.rooms)
    graph = graph.replace(rooms=rooms, warnings=(Warning(name, name, (name,)),))
    svg = svg_text(draw_graph(graph))
    fromstring(svg)
    assert "<script" not in svg
    assert not re.search("[\u202e\x00\x1b]", svg)


def test_what_occurs_stands_in_the_legend_and_nothing_else() -> None:
    found = texts(svg_text(draw_graph(walked(office()))))
    assert {"wall", "door 4", "window 3", "chair 4", "table 2", "path"} <= set(found)
    assert "no wall" not in found
    bare = texts(svg_text(draw_graph(office().replace(objects=()))))
    assert not {t for t in bare if t.startswith(("door", "window", "chair", "path"))}


def test_a_virtual_face_is_no_wall() -> None:
    graph = office(2, 1)
    planes = tuple(
        Plane(p.id, p.normal, p.offset, p.extent, virtual=p.id in ("p0-0-0-1", "p0-0-1-3"))
        for p in graph.planes
    )
    found = texts(svg_text(draw_graph(graph.replace(planes=planes, objects=()))))
    assert "no wall" in found
    assert "wall" not in found


def test_an_empty_graph_gives_a_sentence() -> None:
    found = texts(svg_text(draw_graph(SceneGraph(name="Nothing"))))
    assert found == ["Nothing", "This graph holds nothing that could be drawn."]


def test_rooms_without_planes_and_objects_without_rooms_are_drawn() -> None:
    graph = SceneGraph(
        rooms=(Room("r1", (0.0, 0.0, 1.0), (), name="lost"),),
        objects=(Object("o1", "door", (4.0, 1.0, 1.0)), Object("o2", "teapot", (1.0, 1.0, 1.0))),
    )
    found = texts(svg_text(draw_graph(graph)))
    assert {"lost", "door 1 in no wall", "teapot 1"} <= set(found)


def test_endless_planes_of_no_room_are_drawn_and_named() -> None:
    planes = (Plane("a", (1.0, 0.0, 0.0), 2.0), Plane("b", (0.0, 1.0, 0.0), 1.0))
    graph = walked(SceneGraph(planes=planes))
    assert "plane of no room" in texts(svg_text(draw_graph(graph)))


def test_true_north_is_shown_where_it_is_known() -> None:
    assert "N" not in texts(svg_text(draw_graph(office(1, 1))))
    graph = office(1, 1).replace(attributes={"true_north": 0.7})
    assert "N" in texts(svg_text(draw_graph(graph)))


def test_a_large_storey_is_drawn_by_faces_and_without_names_that_do_not_fit() -> None:
    graph = office(12, 10)
    svg = svg_text(draw_graph(graph, ViewConfig(detail_rooms=50, smallest_text=30.0)))
    found = texts(svg)
    assert "face of a wall" in found
    assert "wall" not in found
    # One path for all rooms of a kind, not an object for each of them.
    assert svg.count("<g id=") < 100


@pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
def test_pictures_are_written_whole(tmp_path, ending: str) -> None:
    path = save_figure(draw_graph(office(1, 1)), tmp_path / f"a.{ending}", dpi=50)
    head = {"png": b"\x89PNG", "svg": b"<?xml", "pdf": b"%PDF"}[ending]
    assert path.read_bytes().startswith(head)
    assert [p.name for p in tmp_path.iterdir()] == [f"a.{ending}"]


def test_other_endings_are_refused(tmp_path) -> None:
    with pytest.raises(InputError, match=r"'.bmp' is no picture format"):
        save_figure(draw_graph(office(1, 1)), tmp_path / "a.bmp")


def test_inline_drawings_have_ids_of_their_own_and_names_stay_as_they_are() -> None:
    name = 'id="x" url(#y) fill: #ffffff'
    svg = inline_svg(draw_graph(office(1, 1, name=name)), "fig7", 'a "label"')
    ids = re.findall(r'\bid="([^"]*)"', re.sub(r">[^<]*<", "><", svg))
    assert ids
    assert all(i.startswith("fig7-") for i in ids)
    assert set(re.findall(r"url\(#([^)]*)\)", re.sub(r">[^<]*<", "><", svg))) <= set(ids)
    assert name in svg
    assert 'aria-label="a &quot;label&quot;"' in svg
    assert "var(--1f2530, #1f2530)" in svg
