"""A drive stored and read again, as a folder and as a bag; its truth apart."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from situgraph.errors import InputError
from situgraph.geometry.poses import pose_to_matrix
from situgraph.io.folder import FolderWriter
from situgraph.io.recording import Frame, Message, Odometry, Scan, open_recording
from situgraph.io.rosbag_writer import BagWriter
from situgraph.sim.record import record
from situgraph.sim.simulation import Simulation
from situgraph.sim.truth import has_truth, read_truth


def assert_same(a: Message, b: Message, *, lossy_rgb: bool) -> None:
    assert type(a) is type(b)
    assert a.stamp == b.stamp
    if isinstance(a, Odometry):
        assert np.allclose(a.pose, b.pose, rtol=0, atol=1e-14)
    elif isinstance(a, Scan):
        for name in ("points", "times", "rings", "intensity"):
            assert np.array_equal(getattr(a, name), getattr(b, name)), name
    else:
        assert np.array_equal(a.depth, b.depth)
        assert a.intrinsics == b.intrinsics
        difference = np.abs(a.rgb.astype(int) - b.rgb)
        assert difference.mean() < 6 if lossy_rgb else difference.max() == 0


@pytest.mark.parametrize("kind", ["log", "bag"])
def test_what_is_read_is_what_was_driven(
    drive: Simulation, kind: str, request: pytest.FixtureRequest
) -> None:
    recording = open_recording(request.getfixturevalue(kind))
    for a, b in zip(drive.messages(), recording.messages(), strict=True):
        assert_same(a, b, lossy_rgb=kind == "log")
    assert recording.warnings == ()
    info = recording.info
    assert dict(info.counts) == dict(drive.info.counts)
    assert info.duration == pytest.approx(drive.info.duration, abs=0.05)
    for name in ("base_T_lidar", "base_T_camera"):
        expected = pose_to_matrix(getattr(drive.info, name))
        assert np.allclose(pose_to_matrix(getattr(info, name)), expected, atol=1e-12)


def test_a_bag_can_be_opened_by_its_file(bag: Path, drive: Simulation) -> None:
    recording = open_recording(next(bag.glob("*.mcap")))
    assert dict(recording.info.counts) == dict(drive.info.counts)
    first = next(iter(recording.messages(("scans",))))
    assert_same(first, next(iter(drive.messages(("scans",)))), lossy_rgb=False)


def test_folder_to_bag_to_folder(log: Path, tmp_path: Path) -> None:
    source = open_recording(log)
    steps = [source]
    for name, kind in (("bag", BagWriter), ("folder", FolderWriter)):
        folder = tmp_path / name
        folder.mkdir()
        writer = kind(folder, steps[-1].info)
        for message in steps[-1].messages():
            writer.add(message)
        writer.finish()
        steps.append(open_recording(folder))
    for a, b in zip(source.messages(), steps[-1].messages(), strict=True):
        assert_same(a, b, lossy_rgb=True)
    # Range images and disparities survive the bag: nothing falls back to larger files.
    assert not list((tmp_path / "folder" / "scans").glob("*.npz"))
    assert (
        len(list((tmp_path / "folder" / "frames").glob("*.d.png"))) == source.info.counts["frames"]
    )


def test_truth_lies_apart_and_nothing_changes_without_it(
    drive: Simulation, log: Path, tmp_path: Path
) -> None:
    bare = tmp_path / "bare"
    shutil.copytree(log, bare)
    shutil.rmtree(bare / "truth")
    assert has_truth(log)
    assert not has_truth(bare)
    with pytest.raises(InputError, match="no ground truth"):
        read_truth(bare)
    pairs = zip(open_recording(log).messages(), open_recording(bare).messages(), strict=True)
    for a, b in pairs:
        assert_same(a, b, lossy_rgb=False)
    assert open_recording(bare).info.counts == open_recording(log).info.counts


@pytest.mark.parametrize("kind", ["log", "bag"])
def test_truth_is_read_as_it_was(
    drive: Simulation, kind: str, request: pytest.FixtureRequest
) -> None:
    truth, real = read_truth(request.getfixturevalue(kind)), drive.truth
    assert truth.graph == real.graph
    assert truth.building_T_map == real.building_T_map
    assert np.allclose(truth.stamps, real.stamps, rtol=0, atol=1e-9)
    assert np.allclose(truth.poses, real.poses, rtol=0, atol=1e-8)
    assert truth.visits == real.visits
    assert truth.deviations == real.deviations
    assert truth.parts == real.parts
    for frame in drive.messages(("frames",)):
        assert isinstance(frame, Frame)
        assert np.array_equal(truth.id_image(frame.stamp), real.id_image(frame.stamp))
    assert truth.id_image(0.0) is None


def test_damaged_truth_is_named(log: Path, tmp_path: Path) -> None:
    broken = tmp_path / "broken"
    shutil.copytree(log, broken)
    (broken / "truth" / "truth.json").write_text('{"visits": 3}')
    with pytest.raises(InputError, match=r"truth\.json"):
        read_truth(broken)


def test_a_recording_is_whole_or_absent(drive: Simulation, tmp_path: Path) -> None:
    def stop(message: Message) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        record(drive, tmp_path / "log", on_message=stop)
    assert list(tmp_path.iterdir()) == []
    (tmp_path / "there").mkdir()
    (tmp_path / "there" / "file").touch()
    with pytest.raises(InputError, match="exists"):
        record(drive, tmp_path / "there")
