"""A short simulated drive through two rooms, from messages to a results folder."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import msgspec
import numpy as np
import pytest
from click.testing import CliRunner
from tests.sim.buildings import door, window

from situgraph.cli.app import main
from situgraph.config import Settings, load_settings
from situgraph.coupling import from_slam, locate
from situgraph.coupling.located import Pairs
from situgraph.experiments.slam_buildings import boxed
from situgraph.io.recording import Frame, Odometry, Scan, open_recording
from situgraph.io.tum import read_tum
from situgraph.matching import match
from situgraph.objects.stage import ObjectStage
from situgraph.pipeline import Pipeline
from situgraph.run import run_log
from situgraph.scenegraph.codec import read_json, write_json
from situgraph.scenegraph.graph import Object, SceneGraph
from situgraph.sim.record import record
from situgraph.sim.simulation import Simulation
from situgraph.sim.truth import read_truth

QUICK = ("sim.robot.look_turn=2", "sim.camera.fallback_width=64", "sim.camera.rate=1")


def plan() -> SceneGraph:
    """Two rooms of different size, a door between them."""
    boxes = {"a": (0.0, 0.0, 4.0, 3.0), "b": (4.2, 0.0, 7.0, 3.4)}
    way = door("d", 4.1, 1.5, ("a", "b"), ("a.e", "b.w"))
    return boxed("two rooms", boxes, (way, window("w", -0.1, 1.5, "a", "a.w")))


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The recording of a drive from a to b, with its truth."""
    folder = tmp_path_factory.mktemp("drive") / "log"
    config = load_settings(None, QUICK).sim
    drive = Simulation(plan(), config, seed=2, rooms=("a", "b"), renderer="cpu")
    record(drive, folder)
    return folder


def test_a_drive_becomes_a_map_and_a_place(log: Path) -> None:
    states = []
    recording = open_recording(log)
    run, pipeline = run_log(
        recording, Settings(), plan=plan(), watch=lambda _, state: states.append(state)
    )
    assert run.rooms == 2
    assert run.keyframes >= 5
    assert run.verdict in ("unique", "ambiguous")
    assert [s.rooms for s in states] == sorted(s.rooms for s in states)
    assert pipeline.graph.kind == "online"
    assert any(o.category == "door" for o in pipeline.graph.objects)  # driven through
    assert set(run.seconds) >= {"odometry", "planes", "rooms", "matching", "reading"}


def test_offsets_of_walls_err_by_what_they_say(log: Path) -> None:
    """The building is as planned: offsets are errors, of the size of their standard deviations."""
    _, pipeline = run_log(open_recording(log), Settings())
    at = read_truth(log).building_T_map
    storeys = {s.id: "s0" for s in pipeline.graph.storeys}
    evidence = from_slam(pipeline.slam.graph, pipeline.graph)
    found = locate(pipeline.graph, plan(), Pairs(at, {}, {}, {}, storeys), evidence=evidence)
    offsets = np.array([(w.offset, w.offset_sigma) for w in found.coupled.walls])
    assert len(offsets) >= 8
    assert np.abs(offsets[:, 0]).max() < 0.02
    assert 0.1 < np.sqrt(np.mean((offsets[:, 0] / offsets[:, 1]) ** 2)) < 2.0
    assert not [d for d in found.deviations if d.category == "wall"]


def test_everything_a_run_found_lands_in_its_folder(log: Path, tmp_path: Path) -> None:
    write_json(plan(), tmp_path / "plan.json")
    arguments = ["run", log, "--plan", tmp_path / "plan.json", "-o", tmp_path / "out", "--json"]
    result = CliRunner().invoke(main, [str(a) for a in [*arguments, "--detector", "oracle"]])
    assert result.exit_code == 0, result.stderr
    told = json.loads(result.stdout)
    assert told["judgement"]["placement_right"] is True
    assert told["judgement"]["ate_rmse"] < 0.05
    assert told["judgement"]["room_recall"] == 1.0
    assert told["detector"] == "oracle"
    for name in ("online.json", "trajectory.tum", "settings.yaml", "log.txt", "run.json"):
        assert (tmp_path / "out" / name).is_file()
    for name in ("map.png", "match.json", "history.png", "report.html"):
        assert (tmp_path / "out" / name).stat().st_size > 500
    stamps, poses = read_tum(tmp_path / "out" / "trajectory.tum")
    assert len(stamps) == told["scans"] == len(poses)
    assert len(read_json(tmp_path / "out" / "online.json").rooms) == told["rooms"]
    assert load_settings(tmp_path / "out" / "settings.yaml") == Settings()


def test_the_truth_never_enters(log: Path, tmp_path: Path) -> None:
    bare = tmp_path / "bare"
    shutil.copytree(log, bare, ignore=shutil.ignore_patterns("truth"))
    with_truth, _ = run_log(open_recording(log), Settings(), plan=plan())
    without, pipeline = run_log(open_recording(bare), Settings(), plan=plan())
    same = {"seconds": {}, "realtime": 0.0}
    assert msgspec.structs.replace(with_truth, **same) == msgspec.structs.replace(without, **same)
    assert pipeline.slam.keyframes


def test_a_recording_without_truth_cannot_have_an_oracle(log: Path, tmp_path: Path) -> None:
    bare = tmp_path / "bare"
    shutil.copytree(log, bare, ignore=shutil.ignore_patterns("truth"))
    result = CliRunner().invoke(main, ["run", str(bare), "--detector", "oracle"])
    assert result.exit_code == 2
    assert "ground truth" in result.stderr


def test_an_unknown_detector_is_refused_with_the_choices(log: Path) -> None:
    result = CliRunner().invoke(main, ["run", str(log), "--detector", "yolo"])
    assert result.exit_code == 2
    assert "network, oracle, none" in result.stderr


def test_messages_can_be_fed_one_by_one(log: Path) -> None:
    recording = open_recording(log)
    pipeline = Pipeline(base_T_lidar=recording.info.base_T_lidar)
    for message in recording.messages():
        if isinstance(message, Scan):
            state = pipeline.feed(scan=message)
        elif isinstance(message, Frame):
            state = pipeline.feed(image=message)
        else:
            assert isinstance(message, Odometry)
            state = pipeline.feed(odometry=message)
        if state.keyframes >= 3:
            break
    assert state.verdict is None
    assert np.linalg.norm(state.pose[3:]) == pytest.approx(1.0)
    assert pipeline.finish().keyframes == 3


def test_a_run_stopped_by_hand_keeps_what_it_found(log: Path) -> None:
    def stop(count: int, state: object) -> None:
        if count == 300:
            raise KeyboardInterrupt

    run, pipeline = run_log(open_recording(log), Settings(), watch=stop)
    assert run.warnings[0].code == "interrupted"
    assert 0 < run.scans < 60
    assert run.keyframes == len(pipeline.graph.keyframes) > 0


def test_a_log_without_scans_is_refused(log: Path, tmp_path: Path) -> None:
    blind = tmp_path / "blind"
    shutil.copytree(log, blind, ignore=shutil.ignore_patterns("truth"))
    (blind / "scans.csv").write_text("")
    result = CliRunner().invoke(main, ["run", str(blind), "-o", str(tmp_path / "out")])
    assert result.exit_code == 2
    assert "no usable LiDAR scan" in result.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.external
def test_scans_of_another_system_are_placed_right(shared_data: Path, tmp_path: Path) -> None:
    se1 = shared_data / "sgraphs" / "SE1"
    log, prior = se1 / "S-Graphs" / "R8", se1 / "A-Graphs" / "T0" / "graph.g2o"
    arguments = ["run", str(log), "--plan", str(prior), "-o", str(tmp_path / "r8"), "--json"]
    result = CliRunner().invoke(main, arguments)
    assert result.exit_code == 0, result.stderr
    told = json.loads(result.stdout)
    assert told["verdict"] == "unique"
    match = json.loads((tmp_path / "r8" / "match.json").read_text())
    place = match["solutions"][0]["transform"]
    assert (place["x"], place["y"]) == pytest.approx((2.48, 0.0), abs=0.1)
    assert abs(place["yaw"]) < 0.02
    assert all(pair["ours"] for pair in told["other"]["rooms"])
    assert told["other"]["wall_median"] < 0.05
    assert told["other"]["trajectory_rms"] < 0.1
    assert (tmp_path / "r8" / "side-by-side.png").is_file()


class _DoorsOnly:
    """A detector that can find nothing but doors, and sees none."""

    name = "doors"
    categories = frozenset({"door"})

    def detect(self, rgb: object, stamp: float) -> tuple[()]:
        return ()


def test_what_the_detector_cannot_find_is_no_evidence() -> None:
    door = Object("d", "door", (0.0, 1.0, 1.0), rooms=("a",))
    thing = Object("f", "furniture", (1.0, 1.0, 0.4), rooms=("a",))
    built = plan().replace(objects=(door,))
    furnished = built.replace(objects=(door, thing))
    looked = ObjectStage(_DoorsOnly()).annotated(built, np.zeros((1, 3)))
    assert looked.modelled_categories == ("door",)
    seen = built.replace(modelled_categories=("door",))
    first, second, third = (
        [s.log_likelihood for s in match(graph, prior).solutions]
        for graph, prior in (
            (seen, built),
            (seen, furnished),
            (seen.replace(modelled_categories=None), furnished),
        )
    )
    assert first == second
    assert first != third
