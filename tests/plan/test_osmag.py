"""Indoor OSM maps as A-Graphs, and maps that nobody should trust."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from shapely import Polygon

from situgraph.errors import InputError
from situgraph.plan.config import PlanConfig
from situgraph.plan.osmag import read_osm
from situgraph.scenegraph.graph import Object, Room, SceneGraph

LATITUDE, LONGITUDE = 31.18, 121.59
# Independent of the reader: series for the length of a degree (m) on WGS 84.
PHI = math.radians(LATITUDE)
NORTH = 111132.954 - 559.822 * math.cos(2 * PHI) + 1.175 * math.cos(4 * PHI)
EAST = 111412.84 * math.cos(PHI) - 93.5 * math.cos(3 * PHI) + 0.118 * math.cos(5 * PHI)


class Map:
    """Writes a map from metres."""

    def __init__(self) -> None:
        self.nodes: list[str] = [f"<node id='0' lat='{LATITUDE}' lon='{LONGITUDE}' root='true'/>"]
        self.ways: list[str] = []

    def way(self, points: list[tuple[float, float]], close: bool = True, **tags: str) -> str:
        refs = []
        for x, y in points:
            key = f"-{len(self.nodes)}"
            refs.append(key)
            self.nodes.append(
                f"<node id='{key}' lat='{LATITUDE + y / NORTH!r}' lon='{LONGITUDE + x / EAST!r}'/>"
            )
        refs += refs[:1] if close else []
        key = f"-w{len(self.ways)}"
        nds = "".join(f"<nd ref='{ref}'/>" for ref in refs)
        text = "".join(f"<tag k='{k.replace('__', ':')}' v='{v}'/>" for k, v in tags.items())
        self.ways.append(f"<way id='{key}'>{nds}{text}</way>")
        return key

    def room(
        self, name: str, points: list[tuple[float, float]], level: str = "1", **more: str
    ) -> str:
        tags = {"name": name, "level": level, "height": "3.2", "indoor": "room"}
        tags |= {"osmAG__type": "area", "osmAG__areaType": "room"}
        return self.way(points, **(tags | more))

    def passage(
        self,
        start: tuple[float, float],
        end: tuple[float, float],
        one: str,
        other: str,
        level: str = "1",
    ) -> str:
        tags = {"osmAG__type": "passage", "osmAG__from": one, "osmAG__to": other, "level": level}
        return self.way([start, end], close=False, **tags)

    def save(self, folder: Path, head: str = "<?xml version='1.0'?>") -> Path:
        path = folder / "map.osm"
        body = "".join(self.nodes + self.ways)
        path.write_text(f"{head}<osm version='0.6'>{body}</osm>")
        return path


def rectangle(x0: float, y0: float, x1: float, y1: float) -> list[tuple[float, float]]:
    return [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]


def two_rooms() -> Map:
    made = Map()
    made.room("A", rectangle(0, 0, 4, 3))
    made.room("B", rectangle(4, 0, 7, 3)[::-1])  # clockwise in the file
    made.passage((4, 1), (4, 2), "A", "B")
    return made


def room(graph: SceneGraph, name: str) -> Room:
    return next(r for r in graph.rooms if r.name == name)


def door(graph: SceneGraph, way: str) -> Object:
    return next(o for o in graph.objects if o.attributes["way"] == way)


def codes(graph: SceneGraph) -> dict[str, tuple[str, ...]]:
    return {w.code: w.ids for w in graph.warnings}


def test_two_rooms_and_a_door(tmp_path: Path) -> None:
    graph = read_osm(two_rooms().save(tmp_path))
    assert [r.name for r in graph.rooms] == ["A", "B"]
    assert [(s.name, s.elevation, s.height) for s in graph.storeys] == [("1", 0.0, 3.2)]
    assert room(graph, "A").center == pytest.approx((2.0, 1.5, 1.6), abs=1e-3)
    for name, area in (("A", 12.0), ("B", 9.0)):
        found = room(graph, name)
        floor = Polygon(found.footprint)
        assert floor.exterior.is_ccw
        assert floor.area == pytest.approx(area, rel=1e-3)
        normals, offsets = graph.plane_arrays(found.planes)
        assert len(normals) == 4
        assert (normals @ np.array(found.center) + offsets > 1.4).all()
    (made,) = graph.objects
    assert made.category == "door"
    assert made.center == pytest.approx((4.0, 1.5, 1.0), abs=1e-3)
    assert [graph.room_by_id[r].name for r in made.rooms] == ["A", "B"]
    assert [graph.plane_by_id[p].normal[0] for p in made.planes] == pytest.approx([-1.0, 1.0])
    assert graph.modelled_categories == ("door",)
    assert graph.attributes["latitude"] == LATITUDE
    assert graph.warnings == ()


def test_levels_are_stacked_by_their_heights(tmp_path: Path) -> None:
    made = two_rooms()
    made.room("C", rectangle(0, 0, 4, 3), level="2")
    made.room("B", rectangle(4, 0, 8, 3), level="2")
    stairs = made.passage((4, 1), (4, 2), "C", "B", level="2")
    graph = read_osm(made.save(tmp_path))
    assert [s.elevation for s in graph.storeys] == [0.0, 3.2]
    upper = door(graph, stairs)
    assert [graph.room_by_id[r].storey for r in upper.rooms] == ["s1", "s1"]
    assert upper.center[2] == pytest.approx(4.2)


def test_structures_are_no_rooms_and_inner_areas_are_holes(tmp_path: Path) -> None:
    made = Map()
    made.room("hall", rectangle(0, 0, 10, 8))
    made.room("core", rectangle(4, 3, 6, 5))
    made.room("house", rectangle(-1, -1, 11, 9), osmAG__areaType="structure", indoor="area")
    entrance = made.passage((4.5, 3), (5.5, 3), "hall", "core")
    graph = read_osm(made.save(tmp_path))
    hall = room(graph, "hall")
    assert [r.name for r in graph.rooms] == ["hall", "core"]
    assert hall.attributes["area"] == pytest.approx(76.0, rel=1e-3)
    assert len(hall.planes) == 8
    assert len(door(graph, entrance).planes) == 2


def test_unknown_names_are_resolved_by_geometry(tmp_path: Path) -> None:
    made = two_rooms()
    lost = made.passage((4, 2.2), (4, 2.9), "A", "nobody")
    away = made.passage((40, 1), (40, 2), "nobody", "no one")
    graph = read_osm(made.save(tmp_path))
    assert [graph.room_by_id[r].name for r in door(graph, lost).rooms] == ["A", "B"]
    assert set(codes(graph)["unknown-area"]) == {door(graph, lost).id, door(graph, away).id}
    assert codes(graph)["door-without-room"] == (door(graph, away).id,)


def test_a_passage_away_from_its_room_is_named(tmp_path: Path) -> None:
    made = two_rooms()
    off = made.passage((1, 8), (2, 8), "A", "B")
    graph = read_osm(made.save(tmp_path))
    assert door(graph, off).planes == ()
    assert codes(graph)["door-on-no-plane"] == (door(graph, off).id,)


def test_collinear_points_make_one_face(tmp_path: Path) -> None:
    made = Map()
    made.room("A", [(0, 0), (1, 0), (2, 0.005), (4, 0), (4, 3), (0, 3)])
    assert len(read_osm(made.save(tmp_path)).planes) == 4


def test_odd_rings(tmp_path: Path) -> None:
    made = two_rooms()
    opened = made.way(rectangle(10, 0, 12, 2), close=False, indoor="room", level="1", name="open")
    line = made.way([(0, 0), (1, 1)], indoor="room", level="1")
    bow = made.way([(20, 0), (24, 4), (24, 0), (20, 4)], indoor="room", level="1", name="bow")
    graph = read_osm(made.save(tmp_path))
    assert codes(graph)["ring-not-closed"] == (opened,)
    assert codes(graph)["room-without-floor"] == (line,)
    assert room(graph, "bow").attributes["way"] == bow
    assert room(graph, "bow").attributes["area"] == pytest.approx(4.0, rel=1e-3)


# ---------------------------------------------------------------------- hostile maps


BOMB = """<?xml version='1.0'?><!DOCTYPE lolz [<!ENTITY a "ha"><!ENTITY b "&a;&a;&a;">]>"""
EXTERNAL = """<?xml version='1.0'?><!DOCTYPE x [<!ENTITY a SYSTEM "file:///etc/passwd">]>"""


@pytest.mark.parametrize("head", [BOMB, EXTERNAL, "<!DOCTYPE osm>"])
def test_document_types_and_entities_are_refused(tmp_path: Path, head: str) -> None:
    with pytest.raises(InputError, match="entities"):
        read_osm(two_rooms().save(tmp_path, head))


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", "not valid"),
        ("<osm>", "not valid"),
        ("<gpx></gpx>", "gpx"),
        ("<osm></osm>", "no nodes"),
        ("<osm><node id='1' lat='1' lon='2'/></osm>", "no area"),
        ("<osm><node id='1' lat='x' lon='2'/></osm>", "latitude"),
        ("<osm><node id='1' lat='nan' lon='2'/></osm>", "position"),
        ("<osm><node id='1' lat='1e400' lon='2'/></osm>", "position"),
        ("<osm><node id='1' lat='1' lon='2'/><way id='2'><nd ref='3'/></way></osm>", "not there"),
        (
            "<osm><node id='1' lat='1' lon='2'/><node id='2' lat='9' lon='2'/>"
            "<way id='3'><nd ref='1'/><nd ref='2'/></way></osm>",
            "km",
        ),
    ],
)
def test_bad_maps_end_in_one_sentence(tmp_path: Path, text: str, expected: str) -> None:
    path = tmp_path / "bad.osm"
    path.write_text(text)
    with pytest.raises(InputError, match=expected) as caught:
        read_osm(path)
    assert str(path) in str(caught.value)


def test_a_large_map_is_refused_unread(tmp_path: Path) -> None:
    path = tmp_path / "large.osm"
    with path.open("wb") as stream:
        stream.write(b"<osm>")
        stream.truncate(3_000_000)
    with pytest.raises(InputError, match="MB"):
        read_osm(path, PlanConfig(max_osm_mb=2))


def test_a_missing_map(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be read"):
        read_osm(tmp_path / "none.osm")


# ---------------------------------------------------------------------- the real map


@pytest.mark.external
def test_sist(shared_data: Path) -> None:
    graph = read_osm(shared_data / "plans" / "SIST_1.osm")
    assert len(graph.rooms) == 176
    assert len(graph.storeys) == 2
    assert sum(o.category == "door" for o in graph.objects) == 200
    joined = [o for o in graph.objects if len(o.rooms) == len(o.planes) == 2]
    assert len(joined) >= 190
    for item in joined:  # both faces run through the door, and look away from each other
        normals, offsets = graph.plane_arrays(item.planes)
        assert np.abs(normals @ np.array(item.center) + offsets).max() < 0.6
        assert normals[0] @ normals[1] < -0.9
    named = {i for w in graph.warnings for i in w.ids}
    assert all(o.id in named for o in graph.objects if not o.rooms or len(o.planes) < len(o.rooms))
    assert all(Polygon(r.footprint).is_valid for r in graph.rooms)
