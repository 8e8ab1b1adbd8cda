"""Rooms of models that have none: what the walls enclose."""

from __future__ import annotations

from pathlib import Path

import pytest
from shapely import Polygon
from tests.plan.ifc_author import Author, box, rectangle

from situgraph.plan.config import PlanConfig
from situgraph.plan.ifc import read_ifc
from situgraph.scenegraph.graph import SceneGraph

HERE = PlanConfig(isolate=False)


def shell(author: Author, bottom: float = 0.0, height: float = 2.8) -> object:
    """Walls round two rooms of 4 x 3 and 3 x 3 m; returns the wall between."""
    for start, end in (
        ((-0.1, -0.1), (-0.1, 3.1)),
        ((7.3, -0.1), (7.3, 3.1)),
        ((-0.1, -0.1), (7.3, -0.1)),
        ((-0.1, 3.1), (7.3, 3.1)),
    ):
        author.wall(start, end, bottom=bottom, height=height)
    return author.wall((4.1, -0.1), (4.1, 3.1), bottom=bottom, height=height)


def outlines(graph: SceneGraph) -> list[Polygon]:
    return [Polygon(r.footprint) for r in graph.rooms if r.footprint is not None]


def iou(one: Polygon, other: Polygon) -> float:
    return float(one.intersection(other).area / one.union(other).area)


def read(author: Author, folder: Path) -> SceneGraph:
    return read_ifc(author.save(folder / "model.ifc"), HERE)


def test_two_rooms_from_walls(tmp_path: Path) -> None:
    author = Author("IFC2X3", 0.001)
    storey = author.storey("EG", 0.0)
    door = author.door(shell(author), (4.1, 1.0), (0.0, 1.0))
    graph = read(author, tmp_path)
    assert [s.name for s in graph.storeys] == ["EG"]
    assert storey.Name == "EG"
    found = outlines(graph)
    assert len(found) == 2
    for truth in (rectangle(0, 0, 4, 3), rectangle(4.2, 0, 7.2, 3)):
        assert max(iou(Polygon(truth), f) for f in found) > 0.99
    assert all(r.attributes["derived"] is True for r in graph.rooms)
    assert all(len(r.planes) == 4 for r in graph.rooms)
    assert not any(p.virtual for p in graph.planes)
    made = next(o for o in graph.objects if o.attributes["guid"] == door.GlobalId)
    assert len(made.rooms) == len(made.planes) == 2
    warning = next(w for w in graph.warnings if w.code == "rooms-derived")
    assert warning.ids == tuple(r.id for r in graph.rooms)


def test_small_gaps_between_walls_close_and_shafts_are_no_rooms(tmp_path: Path) -> None:
    author = Author()
    for start, end in (
        ((0, 0), (4.05, 0)),
        ((4.15, 0.05), (4.15, 3)),
        ((4.1, 3.05), (0, 3.05)),
        ((0, 3), (0, 0.05)),
    ):
        author.wall(start, end, 0.1)
    author.wall((3.3, 0), (3.3, 3.05), 0.1)  # leaves a shaft of 0.75 m by 2.9 m
    author.wall((3.3, 1.5), (4.15, 1.5), 0.1)  # and halves it
    graph = read(author, tmp_path)
    assert len(graph.rooms) == 1


def test_storeys_one_above_the_other(tmp_path: Path) -> None:
    author = Author()
    for number, floor in enumerate((0.0, 3.0)):
        author.storey(f"{number}", floor)
        shell(author, floor)
        for x0, x1 in ((0, 4), (4.2, 7.2)):
            author.element("IfcSlab", ((x0 + x1) / 2, 1.5), (x1 - x0, 3), floor - 0.2, 0.2)
    author.storey("T.O. steel", 2.8)
    graph = read(author, tmp_path)
    assert [(s.name, s.elevation) for s in graph.storeys] == [("0", 0.0), ("1", 3.0)]
    assert [r.storey for r in graph.rooms] == ["s0", "s0", "s1", "s1"]
    assert [r.attributes["height"] for r in graph.rooms[:2]] == pytest.approx([2.8, 2.8])


def test_a_pillar_is_a_hole_whose_faces_bound_the_room(tmp_path: Path) -> None:
    author = Author()
    shell(author)
    outline = box((2.0, 1.5), (1.0, 0.0), 0.4, 0.4)
    author.wall((1.8, 1.5), (2.2, 1.5), 0.4, height=2.8)
    graph = read(author, tmp_path)
    big = max(graph.rooms, key=lambda r: float(r.attributes["area"] or 0.0))
    assert big.attributes["holes"] == 1
    assert len(big.planes) == 8
    assert outline


def test_doors_of_curtain_walls_close_their_gap(tmp_path: Path) -> None:
    author = Author()
    for start, end in (((0, 0), (0, 3)), ((5, 0), (5, 3)), ((0, 3), (5, 3))):
        author.wall(start, end)
    curtain = author.model.create_entity("IfcCurtainWall", GlobalId="2O2Fr$t4X7Zf8NOew3FLOH")
    author.parts(curtain, "IfcPlate", [((1.0, 0.0), (2.0, 0.1)), ((4.0, 0.0), (2.0, 0.1))])
    door = author.door(None, (2.5, 0.0), (1.0, 0.0), 1.0, hosted=False)
    graph = read(author, tmp_path)
    assert len(graph.rooms) == 1
    made = next(o for o in graph.objects if o.attributes["guid"] == door.GlobalId)
    assert made.rooms == ("r0",)
    assert len(made.planes) == 1
