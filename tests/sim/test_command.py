"""``situgraph simulate`` and ``situgraph info``."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner
from tests.sim.buildings import building, two_rooms

from situgraph.cli.app import main
from situgraph.scenegraph.codec import write_json
from situgraph.sim.truth import read_truth

QUICK = ["--set", "sim.robot.look_turn=0", "--set", "sim.camera.fallback_width=64"]


def run(*arguments: object) -> tuple[int, str, str]:
    result = CliRunner().invoke(main, [str(a) for a in arguments])
    return result.exit_code, result.stdout, result.stderr


@pytest.fixture
def plan(tmp_path: Path) -> Path:
    file = tmp_path / "plan.json"
    write_json(two_rooms(), file)
    return file


def test_a_layout_becomes_a_recording_with_its_truth(plan: Path, tmp_path: Path) -> None:
    log = tmp_path / "log"
    options = ["--rooms", "b,a", "--renderer", "cpu", "--moved-walls", 1, "--seed", 3, "--json"]
    code, out, err = run("simulate", plan, "-o", log, *options, *QUICK)
    assert code == 0, err
    report = json.loads(out)
    assert report["visited"] == ["b", "a"]
    assert report["deviations"] == ["moved-wall a.e, b.w"]
    assert "CPU" in report["sensors"]["camera"]
    assert read_truth(log).deviations[0].kind == "moved-wall"
    code, out, _ = run("info", log, "--read", "--json")
    info = json.loads(out)
    assert code == 0
    assert info["counts"] == report["counts"]
    assert info["read"] == {
        "odometry": info["counts"]["odometry"],
        "scan": info["counts"]["scans"],
        "frame": info["counts"]["frames"],
    }
    assert info["warnings"] == []
    code, _, err = run("info", log)
    assert code == 0
    assert "odometry" in err


def test_a_bag_without_a_camera(plan: Path, tmp_path: Path) -> None:
    log = tmp_path / "log"
    options = ["--storey", "level 0", "--no-camera", "--format", "ros2", "--json"]
    code, _, err = run("simulate", plan, "-o", log, *options, *QUICK)
    assert code == 0, err
    code, out, _ = run("info", log, "--json")
    assert code == 0
    assert json.loads(out)["kind"] == "ROS 2 bag"
    assert json.loads(out)["counts"]["frames"] == 0


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (["--rooms", "a,z"], "no room 'z'"),
        (["--storey", "roof"], "no storey 'roof'"),
        (["--rooms", "a", "--storey", "s0"], "not both"),
        (["--set", "sim.lidar.rate=0"], "sim.lidar.rate"),
    ],
)
def test_what_cannot_be_done_is_one_sentence(
    plan: Path, tmp_path: Path, options: list[str], sentence: str
) -> None:
    code, out, err = run("simulate", plan, "-o", tmp_path / "log", *options)
    assert code == 2
    assert sentence in err
    assert out == ""
    assert not (tmp_path / "log").exists()


def test_a_room_behind_a_wall_is_a_sentence(tmp_path: Path) -> None:
    write_json(building({"a": (0, 0, 5, 4), "b": (5.2, 0, 9, 4)}), tmp_path / "p.json")
    code, _, err = run("simulate", tmp_path / "p.json", "-o", tmp_path / "log", "--rooms", "a,b")
    assert code == 2
    assert "room b cannot be reached" in err


def test_info_of_what_is_no_recording(tmp_path: Path) -> None:
    code, _, err = run("info", tmp_path)
    assert code == 2
    assert "is not a recording" in err
    code, _, err = run("info", tmp_path, "--topic", "lidar")
    assert code == 2
    assert "ROLE=TOPIC" in err
