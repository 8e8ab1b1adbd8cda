"""A camera's folder of images in the layout of the TUM benchmark."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from situgraph.errors import InputError
from situgraph.geometry.poses import pose_to_matrix
from situgraph.io.recording import Frame, Odometry, open_recording


@pytest.fixture
def images(tmp_path: Path) -> Path:
    folder = tmp_path / "desk"
    (folder / "rgb").mkdir(parents=True)
    (folder / "depth").mkdir()
    rgb, depth = ["# colour\n"], []
    for i in range(4):
        Image.fromarray(np.full((12, 16, 3), 10 * i, np.uint8)).save(folder / f"rgb/{i}.png")
        Image.fromarray(np.full((12, 16), 10_000 + i, np.uint16)).save(folder / f"depth/{i}.png")
        rgb.append(f"{i}.00 rgb/{i}.png\n")
        depth.append(f"{i}.01 depth/{i}.png\n")
    (folder / "rgb.txt").write_text("".join(rgb))
    (folder / "depth.txt").write_text("".join(depth))
    (folder / "intrinsics.txt").write_text("# fx fy cx cy\n525 525 8 6\n")
    (folder / "groundtruth.txt").write_text(
        "# stamp pose\n0.5 1 2 3 -0.5 0.5 -0.5 0.5\n1.5 1 2 3 -0.5 0.5 -0.5 0.5\n"
    )
    return folder


def test_images_become_frames_and_poses_odometry(images: Path) -> None:
    recording = open_recording(images)
    assert recording.info.counts == {"scans": 0, "frames": 4, "odometry": 2}
    messages = list(recording.messages())
    assert [m.stamp for m in messages] == [0.0, 0.5, 1.0, 1.5, 2.0, 3.0]
    frames = [m for m in messages if isinstance(m, Frame)]
    assert frames[1].rgb[0, 0].tolist() == [10, 10, 10]
    assert frames[1].depth[0, 0] == pytest.approx(10_001 / 5000)
    assert frames[0].intrinsics == (525, 525, 8, 6)
    odometry = next(m for m in messages if isinstance(m, Odometry))
    # The camera looks along x; base is the camera with z up.
    assert np.allclose(odometry.pose, [1, 2, 3, 0, 0, 0, 1])
    there = pose_to_matrix(odometry.pose) @ pose_to_matrix(recording.info.base_T_camera)
    assert np.allclose(there[:3, 2], [1, 0, 0], atol=1e-12)
    assert recording.warnings == ()


def test_depth_steps_can_be_given(images: Path) -> None:
    (images / "intrinsics.txt").write_text("525, 525, 8, 6, 1000\n")
    frame = next(iter(open_recording(images).messages(("frames",))))
    assert frame.depth[0, 0] == pytest.approx(10.0)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [(None, "has no intrinsics"), ("fx fy\n", "is not fx fy cx cy"), ("0 1 2 3", "is not fx fy")],
)
def test_missing_intrinsics_are_named(images: Path, text: str | None, sentence: str) -> None:
    if text is None:
        (images / "intrinsics.txt").unlink()
    else:
        (images / "intrinsics.txt").write_text(text)
    with pytest.raises(InputError, match=sentence):
        open_recording(images)


def codes(folder: Path) -> dict[str, str]:
    recording = open_recording(folder)
    list(recording.messages())
    return {w.code: w.message for w in recording.warnings}


def test_a_wrong_depth_scale_is_suspected(images: Path) -> None:
    (images / "intrinsics.txt").write_text("525 525 8 6 100\n")
    assert "median depth 100 m" in codes(images)["depth-scale"]


def test_sizes_that_do_not_fit_are_named(images: Path) -> None:
    Image.fromarray(np.full((6, 8), 9_000, np.uint16)).save(images / "depth/2.png")
    assert "(6, 8)" in codes(images)["images-not-aligned"]


def test_odd_images_are_left_out_with_a_reason(images: Path) -> None:
    (images / "rgb/0.png").write_bytes(b"not a picture")
    Image.fromarray(np.zeros((12, 16, 3), np.uint8)).save(images / "depth/1.png")
    found = codes(images)
    assert "0.png" in found["image-unreadable"]
    assert "(2 times)" in found["image-unreadable"]


def test_images_without_a_partner_are_left_out(images: Path) -> None:
    (images / "depth.txt").write_text("0.01 depth/0.png\n1.5 depth/1.png\n")
    assert "(3 times)" in codes(images)["image-alone"]


def test_no_list_leads_out_of_the_folder(images: Path) -> None:
    (images / "rgb.txt").write_text("0.0 rgb/0.png\n1.0 ../../secret.png\nx rgb/1.png\n")
    recording = open_recording(images)
    assert recording.info.counts["frames"] == 1
    assert [w.code for w in recording.warnings] == ["list-line"]


def test_colour_alone_will_do(images: Path) -> None:
    (images / "depth.txt").unlink()
    recording = open_recording(images)
    frame = next(iter(recording.messages(("frames",))))
    assert frame.depth is None
    assert [w.code for w in recording.warnings] == ["list-missing"]
