"""The small parts of the slam stage: deskewing, memory of odometry, missing scans, the trail."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from situgraph.geometry.poses import matrix_to_pose, pose_to_matrix
from situgraph.slam.deskew import deskew
from situgraph.slam.motion import OdometryTrack, interpolate, relative
from situgraph.slam.pace import Pace
from situgraph.slam.slam import Slam
from situgraph.slam.trajectory import Trail


def pose(x: float = 0.0, y: float = 0.0, yaw: float = 0.0) -> np.ndarray:
    return pose_to_matrix([x, y, 0.0, 0.0, 0.0, np.sin(yaw / 2), np.cos(yaw / 2)])


def seen_while_moving(motion: np.ndarray, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points of a fixed cloud as the moving sensor measures them, and in the frame at the end."""
    world = np.random.default_rng(0).uniform(-8.0, 8.0, (len(times), 3))
    measured = []
    for point, t in zip(world, times):
        at = interpolate(np.eye(4), motion, 1.0 + t / 0.1)
        measured.append(np.linalg.inv(at) @ [*point, 1.0])
    end = (np.linalg.inv(motion) @ np.column_stack([world, np.ones(len(world))]).T).T
    return np.array(measured)[:, :3], end[:, :3]


def test_deskewing_puts_points_where_they_are_at_the_end_of_the_turn() -> None:
    times = np.sort(np.random.default_rng(1).uniform(-0.1, 0.0, 400))
    measured, end = seen_while_moving(pose(0.09, 0.01, 0.1), times)
    blurred = np.abs(measured - end).max()
    assert np.abs(deskew(measured, times, pose(0.09, 0.01, 0.1), 0.1) - end).max() < 0.03 * blurred


@given(st.permutations(list(range(60))))
def test_the_order_of_the_points_does_not_matter(order: list[int]) -> None:
    times = np.linspace(-0.1, 0.0, 60)
    points = np.random.default_rng(2).uniform(-5, 5, (60, 3))
    motion = pose(0.1, 0.0, 0.2)
    straight = deskew(points, times, motion, 0.1)
    assert np.allclose(deskew(points[order], times[order], motion, 0.1), straight[order])


def test_sparse_odometry_is_remembered_however_long_ago() -> None:
    track = OdometryTrack(memory=10.0, least=20)
    for k in range(30):
        track.add(12.0 * k, pose(x=float(k)))
    motion = track.between(12.0 * 28, 12.0 * 29, 0.2)
    assert motion is not None
    assert motion[0, 3] == pytest.approx(1.0)
    assert track.between(0.0, 12.0, 0.2) is None


@pytest.mark.parametrize(
    ("stamps", "gaps"),
    [
        ([0.0, 0.1, 0.2, 0.3, 0.5, 0.6], [0.2]),
        ([0.0, 0.1, 0.2, 2.2, 2.3], [2.0]),
        ([0.0, 5.0, 12.0, 30.0], []),  # keyframes have no rate
    ],
)
def test_missing_scans_are_told_by_the_usual_rate(stamps: list[float], gaps: list[float]) -> None:
    pace = Pace()
    found = [g for g in map(pace.gap, stamps) if g is not None]
    assert found == pytest.approx(gaps)


def test_the_trail_follows_its_keyframes() -> None:
    trail = Trail(0.1)
    for x in np.arange(0.0, 1.0, 0.04):
        trail.add(0, np.array([x, 0.0, 0.0]))
    trail.add(1, np.array([0.0, 0.0, 0.0]))
    poses = np.array([pose(yaw=np.pi / 2), pose(x=5.0)])
    places = trail.places(poses)
    assert 9 <= len(places) <= 12
    assert np.abs(places[:-1, 0]).max() < 1e-9
    assert places[-1].tolist() == [5.0, 0.0, 0.0]


def test_a_moment_between_two_scans_lies_between_their_poses() -> None:
    slam = Slam()
    rng = np.random.default_rng(0)
    walls = rng.uniform(-1, 1, (4000, 3)) * [3, 2, 1]
    walls[::2, 0] = 3 * np.sign(walls[::2, 0])
    walls[1::2, 1] = 2 * np.sign(walls[1::2, 1])
    for k in range(4):
        x = 0.05 * k
        slam.feed_odometry(0.1 * k, matrix_to_pose(pose(x)))
        slam.feed_scan(0.1 * k, walls - [x, 0, 0])
    assert slam.moment(-1.0) is None
    assert slam.moment(0.31) is None
    number, motion = slam.moment(0.25) or (None, np.eye(4))
    assert number == 0
    assert motion[0, 3] == pytest.approx(0.125, abs=0.01)
    first = slam.moment(0.0)
    assert first is not None
    assert np.allclose(first[1], np.eye(4))


def test_scans_of_odd_shape_are_named_and_left_out() -> None:
    slam = Slam()
    assert slam.feed_scan(0.0, np.zeros((500, 2))) is None
    points = np.random.default_rng(0).uniform(1, 5, (500, 3))
    slam.feed_scan(1.0, points, np.zeros(3))
    assert {w.code for w in slam.warnings} == {"scan-odd", "times-odd"}


def test_a_clock_that_was_set_back_is_named() -> None:
    slam = Slam()
    points = np.random.default_rng(0).uniform(1, 5, (500, 3))
    slam.feed_scan(100.0, points)
    for k in range(25):
        assert slam.feed_scan(0.1 * k, points) is None
    texts = {w.code: w.message for w in slam.warnings}
    assert "25 times" in texts["scan-out-of-order"]
    assert "cut the log" in texts["clock-set-back"]


def test_relative_undoes_a_motion() -> None:
    a, b = pose(1, 2, 0.3), pose(-1, 0.5, -1.2)
    assert np.allclose(a @ relative(a, b), b)
