"""Drives: where the robot goes, how, and that a seed decides everything."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from tests.sim.buildings import building, two_rooms, two_storeys
from tests.sim.conftest import SMALL

from situgraph.errors import InputError
from situgraph.geometry.poses import pose_to_matrix
from situgraph.io.recording import Frame, Message, Odometry, Recording, Scan
from situgraph.plan.layouts import make_layout
from situgraph.sim.config import OdometryConfig, RobotConfig
from situgraph.sim.motion import RATE
from situgraph.sim.odometry import drifting
from situgraph.sim.route import Ground
from situgraph.sim.simulation import Simulation, rooms_on


def blind(plan, **more) -> Simulation:
    return Simulation(plan, more.pop("config", None), camera=False, **more)


def same(a: Message, b: Message) -> bool:
    if type(a) is not type(b) or a.stamp != b.stamp:
        return False
    if isinstance(a, Odometry):
        return np.array_equal(a.pose, b.pose)
    if isinstance(a, Scan):
        return np.array_equal(a.points, b.points) and np.array_equal(a.intensity, b.intensity)
    return np.array_equal(a.rgb, b.rgb) and np.array_equal(a.depth, b.depth)


@pytest.mark.parametrize(("kind", "rooms"), [("random", 6), ("corridor", 6), ("lshaped", 5)])
def test_a_drive_visits_every_room_and_touches_nothing(kind: str, rooms: int) -> None:
    plan = make_layout(kind, rooms, seed=2)
    drive = blind(plan, seed=2)
    assert {v.room for v in drive.truth.visits} == {r.id for r in plan.rooms}
    assert drive.warnings == ()
    floor = Ground(drive.world, RobotConfig()).floors[0]
    assert floor.clear(drive.motion.states[:, :2]).min() > 0.18


def test_speeds_are_those_of_a_walk() -> None:
    config = RobotConfig()
    states = blind(make_layout("random", 5, seed=3), seed=1).motion.states
    velocity = np.diff(states, axis=0) * RATE
    speed = np.hypot(velocity[:, 0], velocity[:, 1])
    assert speed.max() <= 1.02 * config.speed
    assert np.quantile(speed[speed > 0.2], 0.5) > 0.6
    assert np.abs(velocity[:, 5]).max() <= 1.1 * config.turn_rate
    assert np.abs(np.diff(velocity[:, :2], axis=0)).max() * RATE < 3.0
    height = states[:, 2] - config.body_height
    assert np.abs(height).max() < 0.03
    assert 0.001 < states[:, 3].std() < 0.03


def test_rooms_are_visited_in_the_order_asked_for() -> None:
    plan = make_layout("grid", 6, seed=0)
    order = ("r3", "r1", "r3")
    visits = [v.room for v in blind(plan, rooms=order).truth.visits]
    assert visits[0] == "r3"
    assert visits[-1] == "r3"
    assert "r1" in visits


def test_a_room_that_cannot_be_visited_is_named() -> None:
    shut = building({"a": (0, 0, 5, 4), "b": (5.2, 0, 10, 4)})
    with pytest.raises(InputError, match="room b cannot be reached"):
        blind(shut, rooms=("a", "b"))
    assert [w.message for w in blind(shut).warnings] == ["cannot be reached: b"]
    with pytest.raises(InputError, match="no room 'x'"):
        blind(shut, rooms=("x",))
    tiny = building({"a": (0, 0, 0.4, 0.4)})
    with pytest.raises(InputError, match="no room has space"):
        blind(tiny)


def test_the_camera_gets_to_see_every_wall_from_near() -> None:
    drive = blind(two_rooms(), seed=0)
    turned = np.ptp(drive.motion.states[:, 5])
    assert turned > 2 * np.pi - 0.5


@pytest.mark.parametrize("category", ["stairs", "ramp"])
def test_the_robot_climbs_to_the_next_storey(category: str) -> None:
    drive = blind(two_storeys(category), rooms=("low", "high", "low"))
    assert [v.room for v in drive.truth.visits] == ["low", "high", "low"]
    states = drive.motion.states
    assert np.ptp(states[:, 2]) == pytest.approx(3.0, abs=0.05)
    # Up means nose up, a negative pitch.
    assert states[:, 4].min() < -0.3
    assert states[:, 4].max() > 0.3


def test_storeys_are_named_by_id_or_name() -> None:
    plan = two_storeys()
    assert rooms_on(plan, "s1") == rooms_on(plan, "level 1") == ("high",)
    with pytest.raises(InputError, match="no storey 'attic'"):
        rooms_on(plan, "attic")


def test_the_same_seed_gives_the_same_bits_and_another_seed_does_not(drive: Simulation) -> None:
    again = Simulation(two_rooms(), SMALL, seed=5, rooms=("a", "b"), renderer="cpu")
    other = Simulation(two_rooms(), SMALL, seed=6, rooms=("a", "b"), renderer="cpu")
    first = list(itertools.islice(drive.messages(), 200))
    assert all(same(a, b) for a, b in zip(first, again.messages()))
    assert all(same(a, b) for a, b in zip(first, drive.messages()))
    assert not any(same(a, b) for a, b in zip(first, other.messages()) if not isinstance(a, Frame))
    assert again.info == drive.info


def test_a_drive_is_a_recording_in_the_order_of_its_stamps(drive: Simulation) -> None:
    assert isinstance(drive, Recording)
    messages = list(drive.messages())
    stamps = [m.stamp for m in messages]
    assert stamps == sorted(stamps)
    kinds = {"scans": Scan, "frames": Frame, "odometry": Odometry}
    for stream, kind in kinds.items():
        assert sum(isinstance(m, kind) for m in messages) == drive.info.counts[stream]
        only = list(drive.messages((stream,)))
        assert all(same(a, b) for a, b in zip(only, (m for m in messages if isinstance(m, kind))))
    scan = next(m for m in messages if isinstance(m, Scan))
    assert scan.points.dtype == np.float32
    assert (np.diff(scan.times) >= 0).all()
    assert scan.times.max() <= 0
    assert set(np.unique(scan.rings)) <= set(range(16))


def test_deskewed_scans_lie_on_the_walls_of_the_true_world(drive: Simulation) -> None:
    mount = pose_to_matrix(drive.info.base_T_lidar)
    scans = list(drive.messages(("scans",)))
    walls = drive.truth.graph.planes
    for scan in scans[::25]:
        poses = drive.motion.matrices(scan.stamp + scan.times.astype(float) - 1000.0) @ mount
        at = np.einsum("nij,nj->ni", poses[:, :3, :3], scan.points) + poses[:, :3, 3]
        away = np.abs(at @ np.array([w.normal for w in walls]).T + [w.offset for w in walls])
        near = np.minimum(away.min(axis=1), np.minimum(np.abs(at[:, 2]), np.abs(at[:, 2] - 2.8)))
        assert np.quantile(near, 0.7) < 0.045


def test_the_map_frame_is_random_and_truth_knows_it() -> None:
    drives = [blind(two_rooms(), seed=s) for s in range(4)]
    yaws = [d.truth.building_T_map.yaw for d in drives]
    assert np.ptp(yaws) > 1.0
    for drive in drives:
        first = next(iter(drive.messages(("odometry",))))
        there = drive.truth.building_T_map.matrix() @ pose_to_matrix(first.pose)
        assert np.allclose(there, pose_to_matrix(drive.truth.poses[0]), atol=1e-9)
        start = drive.truth.building_T_map.inverse().points(drive.truth.poses[0, :3])
        assert np.hypot(*start[:2]) <= 5.0 + 1e-9


def test_leg_odometry_drifts_as_configured(drive: Simulation) -> None:
    frame = drive.truth.building_T_map
    perfect = OdometryConfig(scale=0, slip=0, turn_slip=0, walk_slip=0, climb=0, tilt=0)

    def error_at_the_end(config: OdometryConfig, seed: int) -> float:
        rng = np.random.default_rng(seed)
        times, poses = drifting(drive.motion, frame.inverse(), config, rng)
        assert np.allclose(np.diff(times), 0.02)
        truth = drive.motion.at(times[[0, -1]])[:, :3]
        errors = np.linalg.norm(frame.points(poses[[0, -1], :3]) - truth, axis=1)
        assert errors[0] < 1e-9
        return float(errors[1])

    assert error_at_the_end(perfect, 0) < 1e-6
    errors = [error_at_the_end(OdometryConfig(), seed) for seed in range(40)]
    walked = np.linalg.norm(np.diff(drive.motion.states[:, :2], axis=0), axis=1).sum()
    assert 0.002 < np.median(errors) / walked < 0.03


def test_the_camera_can_be_left_out_without_changing_the_rest(drive: Simulation) -> None:
    without = Simulation(two_rooms(), SMALL, seed=5, rooms=("a", "b"), camera=False)
    assert without.info.base_T_camera is None
    wanted = ("scans", "odometry")
    pairs = zip(without.messages(), drive.messages(wanted), strict=True)
    assert all(same(a, b) for a, b in itertools.islice(pairs, 150))
