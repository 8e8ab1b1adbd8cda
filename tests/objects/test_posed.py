from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image
from tests.objects.test_stage import CAMERA, ONCE, OPTICAL, Painted, view
from tests.objects.world import two_rooms

from situgraph.errors import InputError
from situgraph.geometry.poses import matrix_to_pose
from situgraph.io.recording import Frame, Intrinsics
from situgraph.io.tum import write_tum
from situgraph.objects.posed import look
from situgraph.objects.stage import ObjectStage
from situgraph.scenegraph.codec import read_json, write_json

FIT = Intrinsics(CAMERA.fx, CAMERA.fy, CAMERA.cx, CAMERA.cy)
STOPS = ((1.5, 2.0, 0.0), (1.8, 2.5, -0.2), (1.4, 1.6, 0.1))
STAMPS = np.arange(len(STOPS), dtype=float)


def frames(intrinsics: Intrinsics = FIT, scale: float = 1.0) -> list[Frame]:
    out = []
    for stamp, stop in zip(STAMPS, STOPS):
        seen = view("k", *stop)
        out.append(Frame(float(stamp), seen.rgb, seen.depth * np.float32(scale), intrinsics))
    return out


def poses() -> np.ndarray:
    return matrix_to_pose(np.array([view("k", *stop).pose for stop in STOPS]))


def looked(images: list[Frame], stamps: np.ndarray = STAMPS, **more):
    stage = ObjectStage(Painted(), ONCE)
    return look("log", images, stamps, poses()[: len(stamps)], OPTICAL, stage, **more)


def test_images_with_poses_give_objects_with_relations() -> None:
    found = looked(frames(), graph=two_rooms())
    (door,) = found.graph.objects
    assert np.allclose(door.center, (4.0, 2.0, 1.05), atol=0.15)
    assert set(door.rooms) == {"a", "b"}
    assert (found.images, found.used, found.warnings) == (3, 3, ())


def test_without_rooms_objects_have_places_only() -> None:
    (door,) = looked(frames()).graph.objects
    assert (door.rooms, door.planes) == ((), ())


def test_images_without_a_pose_are_counted() -> None:
    found = looked(frames(), STAMPS[:2])
    assert found.used == 2
    assert [w.code for w in found.warnings] == ["image-without-pose"]


def test_an_odd_depth_scale_is_named() -> None:
    (warning,) = looked(frames(scale=0.2)).warnings
    assert warning.code == "depth-scale"
    assert "steps a metre" in warning.message


@pytest.mark.parametrize(
    ("images", "stamps", "sentence"),
    [
        (frames(), STAMPS[:0], "no camera poses"),
        (frames(), STAMPS + 50.0, "no image has a pose"),
        (frames(Intrinsics(193.0, 193.0, 159.5, 119.5)), STAMPS, r"of another size .*640 x 480"),
        ([Frame(0.0, f.rgb, None, FIT) for f in frames()], STAMPS, "both colour and depth"),
        ([], STAMPS, "no image that can be read"),
    ],
)
def test_what_does_not_fit_gives_one_sentence(images, stamps, sentence) -> None:
    with pytest.raises(InputError, match=sentence):
        looked(images, stamps)


def folder(path: Path) -> Path:
    """The three images as a TUM RGB-D folder."""
    lists: dict[str, list[str]] = {"rgb": [], "depth": []}
    cameras = []
    for frame, stop in zip(frames(), STOPS):
        steps = np.rint(frame.depth * 5000.0).astype(np.uint16)
        for kind, image in (("rgb", frame.rgb), ("depth", steps)):
            name = f"{kind}-{frame.stamp:.1f}.png"
            Image.fromarray(image).save(path / name)
            lists[kind].append(f"{frame.stamp} {name}\n")
        cameras.append(view("k", *stop).pose @ OPTICAL)
    for kind, lines in lists.items():
        (path / f"{kind}.txt").write_text("".join(lines))
    (path / "intrinsics.txt").write_text(f"{FIT.fx} {FIT.fy} {FIT.cx} {FIT.cy} 5000\n")
    write_tum(path / "groundtruth.txt", STAMPS, matrix_to_pose(np.array(cameras)))
    return path


def test_a_folder_in_tum_layout_runs_by_command(tmp_path: Path) -> None:
    from situgraph.cli.objects import command

    write_json(two_rooms(), tmp_path / "rooms.json")
    log, out = folder(tmp_path), tmp_path / "out.json"
    options = ["--rooms", str(tmp_path / "rooms.json"), "-o", str(out)]
    result = CliRunner().invoke(command, [str(log), *options], catch_exceptions=False)
    assert result.exit_code == 0
    assert len(read_json(out).rooms) == 2
    (log / "intrinsics.txt").unlink()
    with pytest.raises(InputError, match="has no intrinsics"):
        CliRunner().invoke(command, [str(log), *options], catch_exceptions=False)
