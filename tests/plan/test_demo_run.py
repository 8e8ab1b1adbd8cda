"""``situgraph demo --sampled``: walls alone cannot tell, objects can, the report is there."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from situgraph.cli.app import main
from situgraph.config import Settings
from situgraph.demo import STAGES, Demo, run_demo
from situgraph.plan.ifc_writer import write_ifc
from situgraph.plan.layouts import make_layout
from situgraph.scenegraph.codec import read_json


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("demo")


@pytest.fixture(scope="module")
def demo(folder: Path) -> Demo:
    stages: list[str] = []
    done = run_demo(folder, Settings(), rooms=3, advance=stages.append)
    assert stages == list(STAGES)
    return done


def test_walls_alone_are_ambiguous_and_objects_locate_the_robot(demo: Demo) -> None:
    assert (demo.rooms, demo.planes, demo.objects) == (6, 24, 34)
    assert [s.rooms for s in demo.steps] == [1, 2, 3]
    for step in demo.steps:
        walls = step.answers[0]
        assert (walls.semantics, walls.verdict) == ("none", "ambiguous")
        assert walls.right
        assert all(a.right for a in step.answers if a.verdict == "unique")
        assert (step.answers[2].semantics, step.answers[2].verdict) == ("likelihood", "unique")
    assert (demo.shown, demo.shown_policy) == (1, "likelihood")


def test_the_files_belong_together(demo: Demo, folder: Path) -> None:
    assert {Path(f).name for f in demo.files} == {p.name for p in folder.iterdir()}
    match = json.loads((folder / "match.json").read_bytes())
    online, prior = (read_json(folder / match[k]) for k in ("online", "prior"))
    assert len(online.rooms) == demo.shown
    assert len(prior.rooms) == 6
    assert set(match["solutions"][0]["rooms"]) <= set(online.room_by_id)
    assert (folder / "match.png").read_bytes().startswith(b"\x89PNG")
    report = (folder / "report.html").read_text()
    assert "Room by room" in report
    assert "without objects" in report


def test_any_building_and_a_second_run_in_the_same_folder(
    tmp_path: Path, capfdbinary: pytest.CaptureFixture[bytes]
) -> None:
    plan = write_ifc(make_layout("random", 8, seed=3), tmp_path / "mine.ifc")
    where = ["--plan", str(plan), "-o", str(tmp_path / "out")]
    for _ in range(2):
        with pytest.raises(SystemExit) as ended:
            main(["demo", "--sampled", "--rooms", "2", "--json", *where])
        assert not ended.value.code
        found = json.loads(capfdbinary.readouterr().out)
        assert found["building"] == "mine"
        assert found["rooms"] == 8
        assert len(found["steps"]) == 2
        assert not (tmp_path / "out" / "six-rooms.ifc").exists()


def test_a_missing_plan_is_one_sentence(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(
            ["demo", "--sampled", "--plan", str(tmp_path / "none.ifc"), "-o", str(tmp_path / "out")]
        )
    assert ended.value.code == 2
    assert "none.ifc" in capsys.readouterr().err
