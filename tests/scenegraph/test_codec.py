from __future__ import annotations

import copy
import json
import os

import jsonschema
import pytest
from hypothesis import given
from hypothesis import strategies as st

from situgraph.errors import InputError
from situgraph.scenegraph import codec
from situgraph.scenegraph.graph import (
    Ellipsoid,
    Keyframe,
    Object,
    Plane,
    Room,
    SceneGraph,
    Storey,
    Warning,
)

DESIGN_EXAMPLE = {
    "format": "situgraph/scene-graph",
    "version": 1,
    "name": "Institute",
    "kind": "prior",
    "storeys": [{"id": "s0", "name": "EG", "elevation": 0.0, "height": 2.8}],
    "rooms": [
        {
            "id": "r1",
            "name": "101",
            "storey": "s0",
            "center": [2.0, 3.0, 1.4],
            "planes": ["p1", "p2", "p3", "p4"],
            "footprint": [[0, 0], [4, 0], [4, 6], [0, 6]],
        }
    ],
    "planes": [
        {"id": "p1", "normal": [1, 0, 0], "offset": 0.0, "extent": [[0, 0], [0, 6]],
         "virtual": False, "source": "IfcWall 2O2Fr$t4X7Zf8NOew3FLOH"},
        {"id": "p2", "normal": [-1, 0, 0], "offset": 4.0},
        {"id": "p3", "normal": [0, 1, 0], "offset": 0.0, "extent": None, "virtual": None},
        {"id": "p4", "normal": [0, -1, 0], "offset": 6.0, "source": None},
    ],
    "objects": [
        {"id": "o1", "category": "door", "center": [0.0, 1.2, 1.0],
         "ellipsoid": {"axes": [0.5, 0.06, 1.0], "rotation": [0, 0, 0, 1]},
         "rooms": ["r1"], "planes": ["p1"], "confidence": 1.0}
    ],
    "keyframes": [{"id": "k1", "stamp": 12.3, "pose": [0, 0, 0, 0, 0, 0, 1]}],
    "warnings": [{"code": "door-without-room", "ids": ["o1"], "message": "..."}],
}  # fmt: skip


def document() -> dict:
    return copy.deepcopy(DESIGN_EXAMPLE)


def test_the_example_of_the_contract_loads() -> None:
    graph = codec.from_dict(document())
    assert graph.room_by_id["r1"].planes == ("p1", "p2", "p3", "p4")
    assert graph.plane_by_id["p1"].extent == ((0, 0), (0, 6))
    assert graph.objects_by_plane["p1"][0].category == "door"
    assert graph.warnings[0].code == "door-without-room"
    assert graph.modelled == {"door"}


def test_the_schema_accepts_what_the_codec_accepts(tmp_path) -> None:
    jsonschema.validate(document(), codec.json_schema())
    graph = codec.from_dict(document())
    jsonschema.validate(codec.to_dict(graph), codec.json_schema())


def test_the_published_schema_is_the_one_the_types_make() -> None:
    from pathlib import Path

    published = Path(codec.__file__).with_name("schema.json")
    assert json.loads(published.read_text()) == codec.json_schema()


def test_null_and_absent_fields_mean_the_same() -> None:
    full = document()
    full.update(objects=[], keyframes=None, warnings=None, name=None)
    bare = {k: v for k, v in full.items() if k not in ("keyframes", "warnings", "name")}
    assert codec.from_dict(full) == codec.from_dict(bare)


@pytest.mark.parametrize("count", [0, 1, 2, 3])
def test_a_room_may_have_fewer_than_four_planes(count) -> None:
    doc = document()
    doc["rooms"][0]["planes"] = doc["rooms"][0]["planes"][:count]
    assert len(codec.from_dict(doc).rooms[0].planes) == count


def _change(path, value):
    doc = document()
    node = doc
    for key in path[:-1]:
        node = node[key]
    if value is None:
        del node[path[-1]]
    else:
        node[path[-1]] = value
    return doc


BAD = {
    "dangling plane": (("rooms", 0, "planes", 1), "p99", "rooms[0].planes[1]"),
    "dangling storey": (("rooms", 0, "storey"), "s9", "rooms[0].storey"),
    "dangling room of an object": (("objects", 0, "rooms"), ["r9"], "objects[0].rooms[0]"),
    "duplicate id": (("planes", 1, "id"), "p1", "planes[1].id"),
    "zero normal": (("planes", 2, "normal"), [0, 0, 0], "planes[2].normal"),
    "long normal": (("planes", 2, "normal"), [0, 2, 0], "planes[2].normal"),
    "short centre": (("rooms", 0, "center"), [1, 2], "rooms[0].center"),
    "text for a number": (("planes", 0, "offset"), "0", "planes[0].offset"),
    "missing offset": (("planes", 0, "offset"), None, "planes[0]"),
    "other format": (("format",), "graph", "format"),
    "other version": (("version",), 2, "version"),
    "two corners": (("rooms", 0, "footprint"), [[0, 0], [1, 0]], "rooms[0].footprint"),
    "same plane twice": (("rooms", 0, "planes"), ["p1", "p1"], "rooms[0].planes"),
    "flat ellipsoid": (("objects", 0, "ellipsoid", "axes"), [1, 0, 1], "objects[0].ellipsoid.axes"),
    "no quaternion": (("keyframes", 0, "pose"), [0, 0, 0, 0, 0, 0, 0], "keyframes[0].pose"),
}


@pytest.mark.parametrize("case", BAD)
def test_a_broken_file_is_refused_with_the_place(case, tmp_path) -> None:
    path, value, place = BAD[case]
    file = tmp_path / "graph.json"
    file.write_text(json.dumps(_change(path, value)))
    with pytest.raises(InputError) as caught:
        codec.read_json(file)
    message = str(caught.value)
    assert message.startswith(f"{file}: {place}"), message
    assert "\n" not in message


@pytest.mark.parametrize(
    "text", ["", "{", "[]", "nonsense", '{"format": NaN}', "[" * 100_000, '{"a": 1e999}', "\0" * 64]
)
def test_what_is_no_json_is_refused(text, tmp_path) -> None:
    file = tmp_path / "graph.json"
    file.write_text(text)
    with pytest.raises(InputError, match=r"graph\.json"):
        codec.read_json(file)


def test_nan_is_refused_in_python_too() -> None:
    graph = codec.from_dict(document())
    bad = graph.replace(planes=(Plane("p1", (1, 0, 0), float("nan")), *graph.planes[1:]))
    with pytest.raises(InputError, match=r"planes\[0\].offset"):
        codec.encode(bad)


def test_a_huge_file_is_refused_before_it_is_read(tmp_path) -> None:
    file = tmp_path / "zeros.json"
    with open(file, "wb") as out:
        out.truncate(2 << 30)
    with pytest.raises(InputError, match="2147 MB"):
        codec.read_json(file)


def test_missing_file_and_directory(tmp_path) -> None:
    with pytest.raises(InputError, match="no such file"):
        codec.read_json(tmp_path / "none.json")
    with pytest.raises(InputError, match="is a directory"):
        codec.read_json(tmp_path)


def test_millimetres_are_found_by_room_size_not_by_position() -> None:
    doc = document()
    far = codec.from_dict(doc)
    moved = [[x + 2.6e6, y + 1.2e6] for x, y in far.rooms[0].footprint]
    doc["rooms"][0]["footprint"] = moved
    codec.from_dict(doc)
    doc["rooms"][0]["footprint"] = [[0, 0], [4000, 0], [4000, 6000], [0, 6000]]
    with pytest.raises(InputError, match="metres"):
        codec.from_dict(doc)


def test_a_face_that_looks_out_of_its_room_is_a_warning() -> None:
    doc = document()
    doc["planes"][0].update(normal=[-1, 0, 0], offset=0.0)
    codes = {w.code: w.ids for w in codec.from_dict(doc).warnings}
    assert codes["face-behind-room"] == ("r1", "p1")


def test_a_face_behind_the_centre_of_an_l_shaped_room_is_no_warning() -> None:
    shape = ((0, 0), (6, 0), (6, 2), (1, 2), (1, 8), (0, 8))
    faces = {
        "p1": ((0, 1, 0), 0.0, (shape[0], shape[1])),
        "p2": ((-1, 0, 0), 6.0, (shape[1], shape[2])),
        "p3": ((0, -1, 0), 2.0, (shape[2], shape[3])),
        "p4": ((-1, 0, 0), 1.0, (shape[3], shape[4])),
    }
    planes = tuple(Plane(k, n, d, e) for k, (n, d, e) in faces.items())
    room = Room("r", (2.0, 3.0, 1.4), tuple(faces), footprint=shape)
    graph = codec.validate(SceneGraph(rooms=(room,), planes=planes))
    assert graph.warnings == ()


finite = st.floats(-1e5, 1e5)
names = st.text(max_size=8)


@st.composite
def graphs(draw) -> SceneGraph:
    planes = []
    for i in range(draw(st.integers(0, 5))):
        a = draw(st.floats(0, 6.3))
        import math

        normal = (math.cos(a), math.sin(a), 0.0)
        virtual = draw(st.sampled_from([None, True, False]))
        planes.append(Plane(f"p{i}", normal, draw(finite), None, virtual, draw(st.none() | names)))
    ids = [p.id for p in planes]
    subset = st.lists(st.sampled_from(ids), unique=True).map(tuple) if ids else st.just(())
    rooms = tuple(
        Room(f"r{i}", (draw(st.floats(-5, 5)),) * 3, (), name=draw(st.none() | names))
        for i in range(draw(st.integers(0, 3)))
    )
    objects = tuple(
        Object(f"o{i}", draw(names), (draw(finite),) * 3,
               Ellipsoid((1.0, 0.5, draw(st.floats(0.01, 9)))),
               tuple(r.id for r in rooms[:1]), draw(subset), draw(st.none() | st.floats(0, 1)),
               {"leaf": draw(st.booleans())})
        for i in range(draw(st.integers(0, 3)))
    )  # fmt: skip
    return SceneGraph(
        name=draw(st.none() | names),
        kind=draw(st.sampled_from(["prior", "online"])),
        storeys=(Storey("s0", elevation=draw(finite)),),
        rooms=rooms,
        planes=tuple(planes),
        objects=objects,
        keyframes=(Keyframe("k", draw(finite), (0.0,) * 6 + (1.0,)),),
        warnings=(Warning("code", draw(names), ("r0",)),),
        modelled_categories=draw(st.none() | st.just(("door",))),
        attributes={"true_north": draw(finite)},
    )


@given(graphs())
def test_the_round_trip_is_exact(graph) -> None:
    assert codec.decode(codec.encode(graph), "test") == graph
    assert codec.from_dict(codec.to_dict(graph)) == graph


def test_nothing_is_left_behind_when_writing_fails(tmp_path) -> None:
    graph = codec.from_dict(document())
    (tmp_path / "there").write_text("a file, not a folder")
    with pytest.raises(InputError):
        codec.write_json(graph, tmp_path / "there" / "graph.json")
    assert os.listdir(tmp_path) == ["there"]
