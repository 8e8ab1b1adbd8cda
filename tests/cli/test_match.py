"""`situgraph match`: the contract of its output, and its bad inputs."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result

import situgraph as sg
from situgraph.cli import app
from situgraph.geometry.planes import from_footprint
from situgraph.scenegraph.graph import Plane, Room, SceneGraph
from situgraph.scenegraph.transform import transformed

# Four rectangular rooms of different sizes: west, south, east, north (m).
RECTANGLES = ((0, 0, 4, 3), (4.2, 0, 9.2, 3), (0, 3.2, 4, 8.2), (4.2, 3.2, 10.2, 7.2))


def building(rectangles: tuple[tuple[float, ...], ...] = RECTANGLES) -> SceneGraph:
    rooms, planes = [], []
    for number, (x0, y0, x1, y1) in enumerate(rectangles):
        corners = ((x0, y0), (x1, y0), (x1, y1), (x0, y1))
        normals, offsets = from_footprint(corners)
        ids = tuple(f"p{number}{side}" for side in "swne"[: len(corners)])
        for name, (nx, ny), offset in zip(ids, normals.tolist(), offsets.tolist()):
            planes.append(Plane(name, (nx, ny, 0.0), offset))
        rooms.append(Room(f"r{number}", ((x0 + x1) / 2, (y0 + y1) / 2, 1.2), ids))
    return SceneGraph(rooms=tuple(rooms), planes=tuple(planes))


@pytest.fixture
def files(tmp_path: Path) -> tuple[Path, Path]:
    prior = building()
    motion = sg.Placement(3.0, -2.0, 0.0, 0.7)
    online = transformed(building(RECTANGLES[:3]).replace(kind="online"), motion.inverse())
    sg.save(prior, tmp_path / "prior.json")
    sg.save(online, tmp_path / "online.json")
    return tmp_path / "online.json", tmp_path / "prior.json"


def call(*arguments: str | Path) -> Result:
    return CliRunner().invoke(app.main, ["match", *map(str, arguments)])


def strict(text: str) -> dict[str, Any]:
    return json.loads(text, parse_constant=pytest.fail)  # type: ignore[no-any-return]


def test_the_match_json(files: tuple[Path, Path], tmp_path: Path) -> None:
    result = call(*files, "--json", "-o", tmp_path / "out" / "match.json")
    assert result.exit_code == 0, result.output
    match = strict(result.stdout)
    assert match == strict((tmp_path / "out" / "match.json").read_text())
    assert (match["format"], match["version"]) == ("situgraph/match", 1)
    assert (match["verdict"], match["unique"], match["count"]) == ("unique", True, 1)
    best = match["solutions"][0]
    assert set(best["transform"]) == {"x", "y", "z", "yaw"}
    assert best["transform"]["x"] == pytest.approx(3.0, abs=0.01)
    assert best["transform"]["y"] == pytest.approx(-2.0, abs=0.01)
    assert math.cos(best["transform"]["yaw"] - 0.7) == pytest.approx(1.0, abs=1e-4)
    assert best["rooms"] == {"r0": "r0", "r1": "r1", "r2": "r2"}
    assert match["stats"]["model"].startswith("at least 3 of 3 rooms")
    for stage in ("room_candidates", "plane_candidates"):
        assert {"type", "semantic", "geometric"} <= match["stats"][stage].keys()


def test_people_get_tables_on_stderr(files: tuple[Path, Path]) -> None:
    result = call(*files, "--explain")
    assert (result.exit_code, result.stdout) == (0, "")
    for words in ("unique", "Placements", "Rooms of the best", "What each stage kept", "model: "):
        assert words in result.stderr


def test_two_rooms_are_compared(files: tuple[Path, Path]) -> None:
    result = call(*files, "--explain", "r0", "r2")
    assert (result.exit_code, result.stdout) == (0, "")
    assert "4.00 x 3.00" in result.stderr
    assert "5.00 x 4.00" in result.stderr
    assert "matched in 0 of 1 solutions; online r0 is r0 in 1" in result.stderr
    unknown = call(*files, "--explain", "r0", "r22")
    assert unknown.exit_code == 2
    assert 'prior.json: no room has the id "r22"; the nearest is r2' in unknown.stderr


def test_the_exit_code_does_not_tell_the_verdict(tmp_path: Path) -> None:
    square = ((0, 0, 4, 4),)
    sg.save(building(square), tmp_path / "square.json")
    sg.save(building(((0, 0, 9, 2),)), tmp_path / "long.json")
    ambiguous = call(tmp_path / "square.json", tmp_path / "square.json", "--json")
    assert (ambiguous.exit_code, strict(ambiguous.stdout)["verdict"]) == (0, "ambiguous")
    assert strict(ambiguous.stdout)["count"] == 4
    foreign = call(tmp_path / "long.json", tmp_path / "square.json", "--json")
    assert (foreign.exit_code, strict(foreign.stdout)["verdict"]) == (0, "none")
    assert strict(foreign.stdout)["solutions"] == []


def bad_files(folder: Path, online: Path) -> dict[Path, str]:
    """Inputs of every wrong kind, with what must be said of each."""
    text = online.read_text()
    written = {
        "dangling.json": (text.replace('"p0s"', '"p99"', 1), 'no plane has the id "p99"'),
        "nan.json": (text.replace('"offset":', '"offset": NaN, "x":', 1), "is not valid JSON"),
        "other.json": ('{"format": "situgraph/match", "version": 1}', "format"),
        "list.json": ("[1, 2]", "list.json: "),
        "half.json": (text[: len(text) // 2], "is not valid JSON"),
        "room.g2o": (
            "VERTEX_ROOM 3 1 0 0 0 0 0 1\nEDGE_ROOM_4PLANES 3 4 5 6 7 0 0 1 0 1\n",
            "line 2",
        ),
        "half.ifc": (
            "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NA",
            "half.ifc: ",
        ),
        "text.txt": ("hello", "is no kind of graph"),
        "empty.json": ("", "is empty"),
    }
    cases = {folder / "missing.json": "no such file", folder: "is a folder"}
    for name, (content, problem) in written.items():
        assert content != text
        (folder / name).write_text(content)
        cases[folder / name] = problem
    for name in ("zeros.json", "zeros.g2o", "zeros.ifc"):
        with open(folder / name, "wb") as file:
            file.truncate(2 << 30)
        cases[folder / name] = "nothing but zeros"
    return cases


@pytest.mark.parametrize("role", ["online", "prior"])
def test_bad_input_is_one_sentence_and_exit_code_2(
    files: tuple[Path, Path], tmp_path: Path, role: str
) -> None:
    folder = tmp_path / "bad"
    folder.mkdir()
    for path, problem in bad_files(folder, files[0]).items():
        pair = (path, files[1]) if role == "online" else (files[0], path)
        result = call(*pair, "-o", tmp_path / "never.json", "--json")
        said = result.stderr.strip()
        assert result.exit_code == 2, (path, result.output)
        assert result.stdout == ""
        assert len(said.splitlines()) == 1, said
        assert problem in said
        assert path.name in said
        assert not (tmp_path / "never.json").exists()


def test_an_online_graph_without_rooms_is_bad_input(
    files: tuple[Path, Path], tmp_path: Path
) -> None:
    sg.save(SceneGraph(kind="online"), tmp_path / "nothing.json")
    result = call(tmp_path / "nothing.json", files[1], "--json")
    assert (result.exit_code, result.stdout) == (2, "")
    assert len(result.stderr.strip().splitlines()) == 1


@pytest.mark.parametrize(
    ("arguments", "problem"),
    [
        (("--set", "matching.rival_rate=0.1"), "the nearest is matching."),
        (("--config", "nowhere.yaml"), "nowhere.yaml"),
        (("--semantics", "magic"), "Invalid value for '--semantics'"),
        (("r0", "--explain"), "ROOM PRIOR_ROOM"),
        (("--picture", "match.exe"), "match.exe"),
    ],
)
def test_bad_options_are_refused(
    files: tuple[Path, Path], arguments: tuple[str, ...], problem: str
) -> None:
    result = call(*files, *arguments)
    assert result.exit_code == 2, result.output
    assert result.stdout == ""
    assert problem in result.stderr


def test_an_output_that_cannot_be_written_is_refused(files: tuple[Path, Path]) -> None:
    result = call(*files, "-o", files[0] / "match.json")
    assert result.exit_code == 2
    assert "cannot be written" in result.stderr


@pytest.mark.external
def test_the_logs_of_s_graphs_are_placed(shared_data: Path) -> None:
    logs = shared_data / "sgraphs" / "SE1"
    result = call(logs / "S-Graphs/R7/graph.g2o", logs / "A-Graphs/T3/graph.g2o", "--json")
    assert result.exit_code == 0, result.output
    match = strict(result.stdout)
    assert match["verdict"] == "unique"
    transform = match["solutions"][0]["transform"]
    assert abs(abs(transform["x"]) - 2.48) < 0.1
    assert abs(transform["y"]) < 0.1
    assert abs(math.sin(transform["yaw"])) < math.radians(2)
