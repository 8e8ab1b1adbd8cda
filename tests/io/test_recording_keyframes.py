"""Keyframe folders of another system, and the clouds in them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from situgraph.errors import InputError
from situgraph.io.keyframes import KeyframeRecording
from situgraph.io.pcd import read_pcd
from situgraph.io.recording import Odometry, Scan, open_recording

EYE = "1 0 0 {x}\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"


def header(points: int, kind: str = "binary") -> bytes:
    return (
        "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z intensity\nSIZE 4 4 4 4\nTYPE F F F F\n"
        f"COUNT 1 1 1 1\nWIDTH {points}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {points}\n"
        f"DATA {kind}\n"
    ).encode()


def cloud(points: np.ndarray) -> bytes:
    return header(len(points)) + points.astype("<f4").tobytes()


def keyframe(folder: Path, number: int, x: float, points: np.ndarray) -> Path:
    place = folder / f"{number:06d}"
    place.mkdir(parents=True)
    (place / "data").write_text(
        f"stamp {10 + number}.5 0\nestimate\n{EYE.format(x=x + 0.5)}odom\n{EYE.format(x=x)}"
        f"accum_distance {x}\nid {number}\n"
    )
    (place / "cloud.pcd").write_bytes(cloud(points))
    return place


@pytest.fixture
def dump(tmp_path: Path) -> Path:
    points = np.array([[1, 2, 3, 0], [4, 5, 6, 1]], dtype=float)
    for number in range(3):
        keyframe(tmp_path / "dump", number, 2.0 * number, points + number)
    return tmp_path / "dump"


def test_a_dump_is_odometry_and_clouds(dump: Path) -> None:
    recording = open_recording(dump)
    assert recording.info.kind == "S-Graphs keyframes"
    assert recording.info.counts == {"scans": 3, "frames": 0, "odometry": 3}
    messages = list(recording.messages())
    assert [type(m) for m in messages] == [Odometry, Scan] * 3
    assert [m.stamp for m in messages] == [10.5, 10.5, 11.5, 11.5, 12.5, 12.5]
    assert messages[2].pose.tolist() == [2, 0, 0, 0, 0, 0, 1]
    assert messages[3].points.tolist() == [[2, 3, 4], [5, 6, 7]]
    assert messages[3].times is None
    assert recording.warnings == ()
    assert isinstance(recording, KeyframeRecording)
    assert recording.estimates()[1][:, 0].tolist() == [0.5, 2.5, 4.5]


def test_a_damaged_cloud_is_left_out_with_a_warning(dump: Path) -> None:
    file = dump / "000001" / "cloud.pcd"
    file.write_bytes(file.read_bytes()[:-8])
    recording = open_recording(dump)
    assert sum(isinstance(m, Scan) for m in recording.messages()) == 2
    (warning,) = recording.warnings
    assert warning.code == "cloud-unreadable"
    assert "cut short: 1 of 2 points" in warning.message


def test_points_that_are_not_finite_are_left_out(dump: Path) -> None:
    bad = np.array([[np.nan, 0, 0, 0], [1, np.inf, 0, 0], [1, 1, 1, 0]])
    (dump / "000000" / "cloud.pcd").write_bytes(cloud(bad))
    recording = open_recording(dump)
    scan = next(iter(recording.messages(("scans",))))
    assert scan.points.tolist() == [[1, 1, 1]]
    assert [w.code for w in recording.warnings] == ["points-not-finite"]


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("stamp now\n", "no stamp with 1 numbers"),
        ("stamp 1 0\n", "no odom with 16 numbers"),
        ("stamp 1 0\nodom\n1 0 0\n", "no odom with 16 numbers"),
        ("stamp 1 0\nodom\n" + "2 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", "not a rigid motion"),
    ],
)
def test_damaged_data_is_named(dump: Path, text: str, sentence: str) -> None:
    (dump / "000002" / "data").write_text(text)
    with pytest.raises(InputError, match=sentence) as failure:
        open_recording(dump)
    assert "000002" in str(failure.value)


def test_ascii_clouds_are_read(tmp_path: Path) -> None:
    file = tmp_path / "a.pcd"
    file.write_bytes(header(2, "ascii") + b"1 2 3 0.5\n4 5 6 1\n")
    points, intensity = read_pcd(file)
    assert points.tolist() == [[1, 2, 3], [4, 5, 6]]
    assert intensity.tolist() == [0.5, 1.0]


@pytest.mark.parametrize(
    ("data", "sentence"),
    [
        (b"ply\nformat ascii\n", "not a PCD file"),
        (header(2, "binary_compressed"), "DATA binary_compressed is not read"),
        (header(10**9), "1000000000 points"),
        (header(1).replace(b"x y z", b"a b c") + bytes(16), "x, y and z are needed"),
        (header(1).replace(b"SIZE 4", b"SIZE 7") + bytes(16), "damaged PCD header"),
        (header(2, "ascii") + b"1 2 3\n", "cut short"),
    ],
)
def test_other_files_are_refused(tmp_path: Path, data: bytes, sentence: str) -> None:
    file = tmp_path / "a.pcd"
    file.write_bytes(data)
    with pytest.raises(InputError, match=sentence):
        read_pcd(file)


@pytest.mark.external
def test_the_logged_run_of_another_system_is_read(shared_data: Path) -> None:
    recording = open_recording(shared_data / "sgraphs" / "SE1" / "S-Graphs" / "R8")
    scans = [m for m in recording.messages() if isinstance(m, Scan)]
    assert len(scans) == 34
    assert all(len(s.points) > 1000 for s in scans)
    assert recording.warnings == ()
