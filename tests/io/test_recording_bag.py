"""ROS bags as robots and people make them, odd ones above all."""

from __future__ import annotations

import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from tests.io.bags import Bag, points

from situgraph.errors import InputError
from situgraph.io.recording import Frame, Odometry, Scan, open_recording

RGB = np.zeros((12, 16, 3), np.uint8)
RGB[..., 0] = 200
DEPTH = np.full((12, 16), 1500, np.uint16)


def codes(path: Path) -> dict[str, str]:
    recording = open_recording(path)
    list(recording.messages())
    return {w.code: w.message for w in recording.warnings}


def fill(bag: Bag, count: int = 3) -> None:
    """A plain log: two links of transforms, then scans, images and odometry."""
    bag.add("/tf_static", 10.0, bag.transform(10.0, "base", "mast", 0.5))
    bag.add("/tf_static", 10.0, bag.transform(10.0, "mast", "velodyne", 0.25))
    bag.add("/tf_static", 10.0, bag.transform(10.0, "base", "cam", 0.1))
    for i in range(count):
        t = 10.0 + i
        bag.add("/odom", t, bag.odometry(t, float(i)))
        bag.add("/points", t + 0.1, bag.cloud(t + 0.1, points(ring=np.arange(4, dtype="<u2"))))
        bag.add("/cam/color/image_raw", t + 0.2, bag.image(t + 0.2, RGB, "rgb8"))
        bag.add("/cam/aligned_depth/image_raw", t + 0.205, bag.image(t + 0.205, DEPTH, "16UC1"))
        bag.add("/cam/color/camera_info", t + 0.2, bag.camera_info(t + 0.2, (12, 16), 386.0))


@pytest.mark.parametrize("storage", ["mcap", "sqlite3", "ros1"])
def test_bags_of_every_kind_are_read(tmp_path: Path, storage: str) -> None:
    path = tmp_path / ("log.bag" if storage == "ros1" else "log")
    with Bag(path, storage) as bag:
        fill(bag)
    recording = open_recording(path)
    assert recording.info.kind == ("ROS 1 bag" if storage == "ros1" else "ROS 2 bag")
    assert recording.info.counts == {"scans": 3, "frames": 3, "odometry": 3}
    assert recording.info.base_T_lidar == pytest.approx((0, 0, 0.75, 0, 0, 0, 1))
    assert recording.info.base_T_camera == pytest.approx((0, 0, 0.1, 0, 0, 0, 1))
    messages = list(recording.messages())
    assert [type(m) for m in messages] == [Odometry, Scan, Frame] * 3
    assert messages[3].pose[0] == 1.0
    assert messages[1].points.tolist() == [[1, 2, 3], [2, 3, 4], [3, 4, 5], [4, 5, 6]]
    assert messages[1].rings.tolist() == [0, 1, 2, 3]
    frame = messages[2]
    assert frame.rgb[0, 0].tolist() == [200, 0, 0]
    assert frame.depth[0, 0] == np.float32(1.5)
    assert frame.intrinsics == (386.0, 386.0, 8.0, 6.0)
    assert recording.warnings == ()


def test_a_turn_stamped_at_its_beginning_is_stamped_at_its_end(tmp_path: Path) -> None:
    offsets = {
        "t": np.array([0, 5, 10, 2], dtype="<u4") * 10_000_000,  # ns
        "time": np.array([0, 0.05, 0.1, 0.02], dtype="<f4"),
        "timestamp": np.array([20.0, 20.05, 20.1, 20.02], dtype="<f8") + 1.7e9,
    }
    for name, values in offsets.items():
        clock = 1.7e9 + 20.0 if name == "timestamp" else 20.0
        with Bag(tmp_path / name) as bag:
            bag.add("/points", clock, bag.cloud(clock, points(**{name: values})))
        (scan,) = open_recording(tmp_path / name).messages()
        assert scan.stamp == pytest.approx(clock + 0.1, abs=1e-6)
        assert scan.times == pytest.approx([-0.1, -0.08, -0.05, 0.0], abs=2e-6)
        assert scan.points[:, 0].tolist() == [1, 4, 2, 3]


def test_a_bag_without_sensors_says_what_it_has(tmp_path: Path) -> None:
    with Bag(tmp_path / "log") as bag:
        bag.add("/odom", 1.0, bag.odometry(1.0, 0.0))
    with pytest.raises(InputError, match=r"no PointCloud2 or Image topic but /odom \(nav_msgs"):
        open_recording(tmp_path / "log")


def test_topics_can_be_named(tmp_path: Path) -> None:
    with Bag(tmp_path / "log") as bag:
        fill(bag)
        for t in (1.0, 2.0, 3.0, 4.0, 5.0):
            bag.add("/front", t, bag.cloud(t, points(2)))
    guessed = open_recording(tmp_path / "log")
    assert guessed.info.sensors["lidar"].startswith("/front")
    assert "there are also /points" in guessed.warnings[0].message
    named = open_recording(tmp_path / "log", topics={"lidar": "/points"})
    assert named.info.counts["scans"] == 3
    with pytest.raises(InputError, match="has no topic /side; it has /cam"):
        open_recording(tmp_path / "log", topics={"lidar": "/side"})
    with pytest.raises(InputError, match="topic /odom is nav_msgs/msg/Odometry; lidar needs"):
        open_recording(tmp_path / "log", topics={"lidar": "/odom"})
    with pytest.raises(InputError, match="no role 'laser'"):
        open_recording(tmp_path / "log", topics={"laser": "/points"})


def test_a_bag_of_scans_alone_is_a_recording_with_guessed_mounts(tmp_path: Path) -> None:
    with Bag(tmp_path / "log") as bag:
        bag.add("/points", 1.0, bag.cloud(1.0, points()))
    recording = open_recording(tmp_path / "log")
    assert recording.info.base_T_lidar == (0, 0, 0, 0, 0, 0, 1)
    (warning,) = recording.warnings
    assert "no transform from base_link to velodyne" in warning.message
    (scan,) = recording.messages()
    assert scan.times is None
    assert scan.rings is None


def test_images_without_camera_info_are_left_out(tmp_path: Path) -> None:
    with Bag(tmp_path / "log") as bag:
        bag.add("/points", 1.0, bag.cloud(1.0, points()))
        bag.add("/cam/image_raw", 1.0, bag.image(1.0, RGB, "rgb8"))
    recording = open_recording(tmp_path / "log")
    assert [type(m) for m in recording.messages()] == [Scan]
    assert "no-intrinsics" in [w.code for w in recording.warnings]


def test_images_that_do_not_belong_together_are_named(tmp_path: Path) -> None:
    with Bag(tmp_path / "late") as bag:
        fill(bag)
        bag.add("/cam/color/image_raw", 20.0, bag.image(20.0, RGB, "rgb8"))
        bag.add("/cam/aligned_depth/image_raw", 20.3, bag.image(20.3, DEPTH, "16UC1"))
    found = codes(tmp_path / "late")
    assert "rgb image of 20.000 s has no partner" in found["image-alone-rgb"]
    assert "depth image of 20.300 s" in found["image-alone-depth"]
    with Bag(tmp_path / "size") as bag:
        bag.add("/cam/color/camera_info", 1.0, bag.camera_info(1.0, (12, 16), 386.0))
        bag.add("/cam/color/image_raw", 1.0, bag.image(1.0, RGB, "rgb8"))
        bag.add("/cam/depth/image_raw", 1.0, bag.image(1.0, DEPTH[:6, :8], "16UC1"))
    assert "(6, 8)" in codes(tmp_path / "size")["images-not-aligned"]


def test_odd_messages_are_left_out_with_topic_number_and_reason(tmp_path: Path) -> None:
    with Bag(tmp_path / "log") as bag:
        fill(bag)
        bag.add("/points", 14.0, bag.cloud(14.0, points()[["x", "y"]].copy()))
        bag.add("/points", 15.0, bag.cloud(15.0, points()), cut=60)
        bag.add("/odom", 15.0, bag.odometry(15.0, 0.0, (0, 0, 0, 0)))
        short = bag.cloud(16.0, points())
        short.width = 1000
        bag.add("/points", 16.0, short)
        bag.add("/points", 17.0, bag.cloud(17.0, points()))
    recording = open_recording(tmp_path / "log")
    assert sum(isinstance(m, Scan) for m in recording.messages()) == 4
    found = {w.code: w.message for w in recording.warnings}
    assert "/points, message 4: has fields" in found["message-odd"]
    assert "(3 times)" in found["message-odd"]
    assert "/points, message 5" in found["message-unreadable"]


def test_an_encoding_that_is_not_read_is_named(tmp_path: Path) -> None:
    with Bag(tmp_path / "log") as bag:
        bag.add("/cam/color/camera_info", 1.0, bag.camera_info(1.0, (12, 16), 386.0))
        bag.add("/cam/color/image_raw", 1.0, bag.image(1.0, RGB, "bayer_rggb8"))
    assert "'bayer_rggb8'" in codes(tmp_path / "log")["message-odd"]


def test_points_that_are_not_finite_are_left_out_and_counted(tmp_path: Path) -> None:
    table = points()
    table["y"][1] = np.nan
    table["x"][2] = np.inf
    with Bag(tmp_path / "log") as bag:
        bag.add("/points", 1.0, bag.cloud(1.0, table))
    recording = open_recording(tmp_path / "log")
    (scan,) = recording.messages()
    assert len(scan.points) == 2
    assert (
        "2 points left out" in {w.code: w.message for w in recording.warnings}["points-not-finite"]
    )


def test_stamps_that_go_backwards_are_passed_on_and_named(tmp_path: Path) -> None:
    with Bag(tmp_path / "log") as bag:
        for written, stamp in ((1.0, 1.0), (2.0, 5.0), (3.0, 3.0), (4.0, 4.9)):
            bag.add("/points", written, bag.cloud(stamp, points()))
    recording = open_recording(tmp_path / "log")
    # What is within half a second is put in order; a clock that jumps is not hidden.
    assert [m.stamp for m in recording.messages()] == [1.0, 3.0, 4.9, 5.0]
    with Bag(tmp_path / "jump") as bag:
        for written, stamp in ((1.0, 11.0), (2.0, 12.0), (3.0, 3.0), (4.0, 4.0)):
            bag.add("/points", written, bag.cloud(stamp, points()))
    recording = open_recording(tmp_path / "jump")
    assert sorted(m.stamp for m in recording.messages()) == [3.0, 4.0, 11.0, 12.0]
    assert "stamp-backwards" in [w.code for w in recording.warnings]


def test_transforms_stand_in_for_odometry(tmp_path: Path) -> None:
    with Bag(tmp_path / "log") as bag:
        bag.add("/points", 1.0, bag.cloud(1.0, points()))
        for t in (1.0, 2.0):
            bag.add("/tf", t, bag.transform(t, "odom", "base_link", t))
            bag.add("/tf", t, bag.transform(t, "map", "odom", 9.0))
    poses = [m.pose[2] for m in open_recording(tmp_path / "log").messages(("odometry",))]
    assert poses == [1.0, 2.0]


@pytest.mark.parametrize("storage", ["mcap", "sqlite3", "ros1"])
def test_a_bag_cut_short_is_refused_or_read_as_far_as_it_goes(tmp_path: Path, storage: str) -> None:
    path = tmp_path / ("log.bag" if storage == "ros1" else "log")
    with Bag(path, storage) as bag:
        fill(bag, 40)
    file = path if storage == "ros1" else next(path.glob("*.[md]*[p3]"))
    data, sentences = file.read_bytes(), []
    for share in (0.0, 0.1, 0.5, 0.9, 0.99):
        file.write_bytes(data[: int(share * len(data))])
        try:
            recording = open_recording(path)
        except InputError as error:
            sentences.append(str(error))
            continue
        read = list(recording.messages())
        assert len(read) < 120
        assert "bag-cut-short" in [w.code for w in recording.warnings]
    assert all("repair it" in s or "no PointCloud2" in s for s in sentences)


def test_a_file_that_is_no_bag_is_refused(tmp_path: Path) -> None:
    for name in ("a.bag", "a.mcap", "a.db3"):
        (tmp_path / name).write_bytes(b"not a bag at all" * 100)
        with pytest.raises(InputError, match="is no bag that can be read"):
            open_recording(tmp_path / name)
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "metadata.yaml").write_text("rosbag2_bagfile_information: 3\n")
    with pytest.raises(InputError, match="is no bag that can be read"):
        open_recording(tmp_path / "folder")


@pytest.mark.parametrize("storage", ["mcap", "sqlite3"])
def test_a_long_bag_is_read_in_bounded_memory(tmp_path: Path, storage: str) -> None:
    table = points(20_000)
    with Bag(tmp_path / "log", storage) as bag:
        for i in range(200):
            bag.add("/points", 1.0 + 0.1 * i, bag.cloud(1.0 + 0.1 * i, table))
    recording = open_recording(tmp_path / "log")
    tracemalloc.start()
    try:
        count = sum(1 for _ in recording.messages())
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert count == 200
    # 48 MB of points; a handful of messages at a time.
    assert peak < 12e6
