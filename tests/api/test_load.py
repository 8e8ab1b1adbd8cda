"""Reading and saving graphs of any kind, and refusing everything else in one sentence."""

from __future__ import annotations

from pathlib import Path

import pytest

import situgraph as sg
from situgraph import api
from situgraph.scenegraph.codec import encode
from situgraph.scenegraph.graph import Plane, Room, SceneGraph

GRAPH = SceneGraph(
    name="one room",
    rooms=(Room("r1", (2.0, 2.0, 1.0), ("p1", "p2")),),
    planes=(Plane("p1", (1.0, 0.0, 0.0), 0.0), Plane("p2", (0.0, 1.0, 0.0), 0.0)),
)
G2O = """\
VERTEX_PLANE 1 1 0 0 0 0 0 0
VERTEX_PLANE 2 1 0 0 -3 0 0 0
VERTEX_ROOM 3 1 0 0 0 0 0 1
VERTEX_ROOM 4 1 0 0 0 0 0 1
EDGE_ROOM_2PLANES 3 1 2 4 0 0 1 0 1
"""


def test_the_public_names_exist() -> None:
    for name in ("load", "save", "read_plan", "SceneGraph", "Placement", "Settings"):
        assert callable(getattr(sg, name))
    assert issubclass(sg.InputError, sg.SituGraphError)
    assert sg.__version__ in sg.__version__
    assert set(sg.__all__) <= {*dir(sg)}
    with pytest.raises(AttributeError, match="no attribute 'nonsense'"):
        _ = sg.nonsense


def test_a_saved_graph_is_loaded_equal(tmp_path: Path) -> None:
    sg.save(GRAPH, tmp_path / "a.json")
    assert sg.load(tmp_path / "a.json") == GRAPH
    assert sg.load(str(tmp_path / "a.json")) == GRAPH
    for name in ("a.ifc", "a.g2o", "a.OSM"):
        with pytest.raises(sg.InputError, match=r"written as JSON.*name it a\.json"):
            sg.save(GRAPH, tmp_path / name)


@pytest.mark.parametrize("name", ["graph", "graph.txt", "graph.json", "graph.ifc"])
def test_the_content_decides_what_a_file_is(tmp_path: Path, name: str) -> None:
    file = tmp_path / name
    file.write_bytes(encode(GRAPH))
    assert sg.load(file) == GRAPH
    file.write_text(G2O)
    assert [r.id for r in sg.load(file).rooms] == ["3"]


def test_the_role_decides_the_part_of_a_log(tmp_path: Path) -> None:
    file = tmp_path / "graph.g2o"
    fixed = (
        G2O.replace("3 1 0", "13 1 0").replace(" 4 1", " 14 1").replace("S 3 1 2 4", "S 13 1 2 14")
    )
    rooms = "".join(s for s in fixed.splitlines(True) if "PLANE " not in s) + "FIX 13 14\n"
    file.write_text(G2O + rooms)
    assert [r.id for r in api.load(file).rooms] == ["3"]
    assert [r.id for r in api.load_prior(file).rooms] == ["13"]
    assert [r.id for r in api.load_prior(file, "free").rooms] == ["3"]
    assert [r.id for r in api.load(file, "fixed").rooms] == ["13"]
    assert sg.read_plan(file) == api.load_prior(file)
    file.write_text(G2O)
    assert api.load_prior(file) == api.load(file)


def zeros(path: Path, size: int) -> Path:
    with open(path, "wb") as file:
        file.truncate(size)
    return path


def test_what_is_no_graph_is_refused_in_one_sentence(tmp_path: Path) -> None:
    noise = tmp_path / "noise.bin"
    noise.write_bytes(bytes(range(1, 255)))
    cases = {
        tmp_path / "missing.json": "no such file",
        tmp_path: "is a folder",
        zeros(tmp_path / "empty.json", 0): "is empty",
        zeros(tmp_path / "zeros.json", 2 << 30): "nothing but zeros",
        zeros(tmp_path / "zeros.g2o", 2 << 30): "nothing but zeros",
        zeros(tmp_path / "zeros.ifc", 2 << 30): "nothing but zeros",
        zeros(tmp_path / "zeros", 2 << 30): "nothing but zeros",
        noise: "is no kind of graph",
        Path("a\0b.json"): "cannot be read",
    }
    for path, problem in cases.items():
        with pytest.raises(sg.InputError, match=problem) as caught:
            sg.load(path)
        assert "\n" not in str(caught.value)
        assert str(path) in str(caught.value)


def test_a_building_model_is_read_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    read: list[Path] = []

    def read_ifc(source: Path, config: object) -> SceneGraph:
        read.append(source)
        return GRAPH

    monkeypatch.setattr(api, "_read_ifc", read_ifc)
    monkeypatch.setenv("SITUGRAPH_CACHE", str(tmp_path / "cache"))
    model = tmp_path / "a.ifc"
    model.write_text("ISO-10303-21;\n1")
    for _ in range(3):
        assert sg.read_plan(model) == GRAPH
    assert len(read) == 1
    sg.read_plan(model, cached=False)
    assert len(read) == 2
    for entry in (tmp_path / "cache" / "plans").iterdir():
        entry.write_bytes(b"damaged")
    assert sg.load(model) == GRAPH
    assert len(read) == 3
    model.write_text("ISO-10303-21;\n2")
    sg.read_plan(model)
    assert len(read) == 4
