"""The folder format: any message survives, damage costs one message and says so."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from situgraph.errors import InputError
from situgraph.io.folder import FolderWriter
from situgraph.io.images import read_depth, read_disparity, write_depth
from situgraph.io.recording import (
    Frame,
    Intrinsics,
    Message,
    Odometry,
    Recording,
    RecordingInfo,
    Scan,
    open_recording,
)
from situgraph.io.vlp16 import vlp16

INFO = RecordingInfo("test", "folder", 0.0, 1.0, {}, (0, 0, 1, 0, 0, 0, 1))
K = Intrinsics(100.0, 100.0, 7.5, 5.5)


def stored(folder: Path, messages: list[Message]) -> Recording:
    folder.mkdir()
    writer = FolderWriter(folder, INFO)
    for message in messages:
        writer.add(message)
    writer.finish()
    return open_recording(folder)


def odometry(stamp: float) -> Odometry:
    return Odometry(stamp, np.array([stamp, 0.1, 0, 0, 0, 0, 1]))


def scan(stamp: float, n: int = 5) -> Scan:
    points = np.random.default_rng(int(stamp)).normal(size=(n, 3)).astype(np.float32)
    return Scan(stamp, points, np.linspace(-0.1, 0, n, dtype=np.float32))


def frame(stamp: float) -> Frame:
    rgb = np.full((12, 16, 3), 100, np.uint8)
    return Frame(stamp, rgb, np.full((12, 16), 2.5, np.float32), K)


def pattern_scan(stamp: float) -> Scan:
    """A scan that fits the firing pattern, with some returns missing."""
    pattern = vlp16(10.0)
    rng = np.random.default_rng(0)
    steps = rng.integers(500, 5000, pattern.times.shape).astype(np.uint16)
    steps[rng.random(steps.shape) < 0.1] = 0
    order = pattern.order[steps.ravel()[pattern.order] > 0]
    points = pattern.points(steps, 0.002).reshape(-1, 3)[order]
    light = rng.integers(0, 256, len(order)).astype(np.float32) / np.float32(255)
    rings = (order // pattern.columns).astype(np.uint8)
    return Scan(stamp, points, pattern.times.ravel()[order], rings, light)


@pytest.fixture
def recording(tmp_path: Path) -> Recording:
    messages: list[Message] = []
    for second in range(4):
        messages += [odometry(second), scan(second), frame(second + 0.5)]
    return stored(tmp_path / "log", messages)


def warnings(folder: Path) -> dict[str, str]:
    recording = open_recording(folder)
    list(recording.messages())
    return {w.code: w.message for w in recording.warnings}


def test_a_scan_of_the_known_pattern_is_a_range_image(tmp_path: Path) -> None:
    original = pattern_scan(7.5)
    (read,) = stored(tmp_path / "log", [original]).messages()
    for name in ("points", "times", "rings", "intensity"):
        assert np.array_equal(getattr(read, name), getattr(original, name)), name
    assert (tmp_path / "log/scans/000000.png").stat().st_size < 80_000


@given(
    points=st.lists(st.tuples(*[st.floats(-100, 100, width=32)] * 3), max_size=20),
    timed=st.booleans(),
)
def test_any_other_scan_survives_exactly(
    points: list, timed: bool, tmp_path_factory: pytest.TempPathFactory
) -> None:
    xyz = np.array(points, dtype=np.float32).reshape(-1, 3)
    times = np.linspace(-0.1, 0, len(xyz), dtype=np.float32) if timed else None
    rings = np.arange(len(xyz), dtype=np.uint8) if timed else None
    (read,) = stored(
        tmp_path_factory.mktemp("f") / "log", [Scan(1.0, xyz, times, rings)]
    ).messages()
    assert np.array_equal(read.points, xyz)
    assert (read.times is None) == (not timed)
    if timed:
        assert np.array_equal(read.times, times)
        assert np.array_equal(read.rings, rings)


@given(
    steps=st.lists(st.integers(0, 4000), min_size=12, max_size=12),
    from_disparity=st.booleans(),
)
def test_depth_survives_to_the_millimetre(
    steps: list, from_disparity: bool, tmp_path_factory: pytest.TempPathFactory
) -> None:
    counts = np.array(steps, dtype=np.float64).reshape(3, 4)
    if from_disparity:
        metres = np.rint(1000 * 19.3 / (np.maximum(counts, 1) * 0.03125)) / 1000
        depth = np.where((counts > 8) & (metres < 60), metres, 0).astype(np.float32)
    else:
        depth = (counts / 1000).astype(np.float32)
    base = tmp_path_factory.mktemp("d") / "000000"
    write_depth(base, depth, 19.3, 0.03125)
    small = base.with_suffix(".d.png")
    read = (
        read_disparity(small, 19.3, 0.03125)
        if small.exists()
        else read_depth(base.with_suffix(".png"), 0.001)
    )
    assert np.array_equal(read, depth)


def test_a_recording_can_be_read_twice_and_in_part(recording: Recording) -> None:
    first, second = (list(recording.messages()) for _ in range(2))
    assert len(first) == len(second) == 12
    assert [m.stamp for m in first] == sorted(m.stamp for m in first)
    assert all(isinstance(m, Frame) for m in recording.messages(("frames",)))
    assert recording.info.counts == {"scans": 4, "frames": 4, "odometry": 4}
    assert recording.info.duration == 3.5
    assert recording.info.base_T_lidar == (0, 0, 1, 0, 0, 0, 1)


def test_a_missing_scan_costs_one_scan(recording: Recording, tmp_path: Path) -> None:
    (tmp_path / "log/scans/000002.npz").unlink()
    assert "000002" in warnings(tmp_path / "log")["scans-unreadable"]
    assert sum(isinstance(m, Scan) for m in open_recording(tmp_path / "log").messages()) == 3


def test_damaged_files_cost_one_message_each(recording: Recording, tmp_path: Path) -> None:
    log = tmp_path / "log"
    (log / "scans/000000.npz").write_bytes(b"PK\x03\x04 nothing")
    (log / "frames/000001.jpg").write_bytes(b"\xff\xd8 nothing")
    lines = (log / "odometry.tum").read_text().splitlines()
    (log / "odometry.tum").write_text("\n".join(["1 2 three", *lines[1:]]))
    (log / "frames.csv").write_text("0.5\n1.5\nsoon\n3.5\n")
    found = warnings(log)
    assert set(found) == {
        "scans-unreadable",
        "frames-unreadable",
        "frames-stamp",
        "odometry-unreadable",
    }
    assert "'1 2 three'" in found["odometry-unreadable"]
    assert "line 3" in found["frames-stamp"]


def test_archives_with_objects_are_never_unpickled(recording: Recording, tmp_path: Path) -> None:
    file = tmp_path / "log/scans/000001.npz"
    np.savez(file, points=np.array([{"a": 1}], dtype=object))
    assert "000001.npz" in warnings(tmp_path / "log")["scans-unreadable"]


def test_a_missing_stream_is_named(recording: Recording, tmp_path: Path) -> None:
    (tmp_path / "log/odometry.tum").unlink()
    assert "odometry.tum" in warnings(tmp_path / "log")["stream-missing"]


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"format": "other"}, "is damaged"),
        ({"version": 2}, "is damaged"),
        ({"duration": -1}, "is damaged"),
        ({"scans": "many"}, "is damaged"),
        ({"base_T_lidar": [1, 2]}, "is damaged"),
        ({"disparity": [0, 1]}, "not positive"),
    ],
)
def test_a_damaged_manifest_is_refused(
    recording: Recording, tmp_path: Path, change: dict, sentence: str
) -> None:
    file = tmp_path / "log/recording.json"
    file.write_text(json.dumps(json.loads(file.read_text()) | change))
    with pytest.raises(InputError, match=sentence):
        open_recording(tmp_path / "log")


def test_a_camera_whose_intrinsics_change_is_refused(tmp_path: Path) -> None:
    (tmp_path / "log").mkdir()
    writer = FolderWriter(tmp_path / "log", INFO)
    writer.add(frame(0.0))
    with pytest.raises(InputError, match="intrinsics change"):
        writer.add(Frame(1.0, frame(1.0).rgb, None, Intrinsics(1, 1, 1, 1)))


def test_what_is_no_recording_is_refused_with_what_would_be(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        open_recording(tmp_path / "nowhere")
    with pytest.raises(InputError, match=r"expected a folder with recording\.json"):
        open_recording(tmp_path)
    (tmp_path / "notes.txt").touch()
    with pytest.raises(InputError, match="is not a recording"):
        open_recording(tmp_path / "notes.txt")
