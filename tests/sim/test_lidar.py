"""Scans of a box whose every range has a formula."""

from __future__ import annotations

import msgspec
import numpy as np
import pytest
from tests.sim.buildings import HEIGHT, box_room, two_rooms, window

from situgraph.io.vlp16 import vlp16
from situgraph.sim.config import LidarConfig, WorldConfig
from situgraph.sim.lidar import Lidar
from situgraph.sim.rays import RayCaster
from situgraph.sim.world import World, build_world

CLEAN = LidarConfig(range_noise=0.0, dropout=0.0, grazing=0.0, range_low=0.0)
BARE = WorldConfig(pictures=0.0)
SIZE = np.array([6.0, 4.0, HEIGHT])


def lidar(world: World, **changes: object) -> Lidar:
    return Lidar(world, RayCaster(world), msgspec.structs.replace(CLEAN, **changes))


def at(*position: float) -> np.ndarray:
    pose = np.eye(4)[None]
    pose[0, :3, 3] = position
    return pose


def box_range(origin: np.ndarray, rays: np.ndarray) -> np.ndarray:
    """Where rays from inside leave the box from (0, 0, 0) to SIZE."""
    with np.errstate(divide="ignore"):
        away = np.where(rays > 0, (SIZE - origin) / rays, -origin / rays)
    return np.where(rays == 0, np.inf, away).min(axis=-1)


def test_the_pattern_is_that_of_the_manual() -> None:
    pattern = vlp16(10.0)
    assert pattern.directions.shape == (16, 1808, 3)
    elevation = np.degrees(np.arcsin(pattern.directions[:, 0, 2].astype(float)))
    assert np.allclose(elevation, np.arange(-15, 16, 2), atol=1e-4)
    assert np.allclose(np.linalg.norm(pattern.directions, axis=2), 1, atol=1e-6)
    # Interleaved: the second shot of a cycle is the first beam above the horizon.
    first_cycle = np.argsort(pattern.times[:, 0])
    assert first_cycle.tolist()[:4] == [0, 8, 1, 9]
    azimuth = np.unwrap(np.arctan2(pattern.directions[0, :, 1], pattern.directions[0, :, 0]))
    assert np.degrees(azimuth[0] - azimuth[-1]) == pytest.approx(359.72, abs=0.05)
    assert pattern.times.max() < 0 < pattern.times.min() + 0.1 + 1e-6


def test_ranges_in_a_box_follow_the_formula() -> None:
    world = build_world(box_room(), BARE, 0)
    sensor = lidar(world)
    origin = np.array([1.7, 1.1, 0.85])
    steps, _ = sensor.scan(at(*origin), np.random.default_rng(0))
    expected = box_range(origin, sensor.pattern.directions.astype(float))
    assert (steps > 0).all()
    assert np.abs(steps * 0.002 - expected).max() < 0.0015


def test_noise_and_losses_have_the_stated_size() -> None:
    world = build_world(box_room(), BARE, 0)
    sensor = lidar(world, range_noise=0.03, dropout=0.1)
    steps, _ = sensor.scan(at(3, 2, 1), np.random.default_rng(1))
    expected = box_range(np.array([3.0, 2.0, 1.0]), sensor.pattern.directions.astype(float))
    error = (steps * 0.002 - expected)[steps > 0]
    assert error.std() == pytest.approx(0.03, rel=0.03)
    assert abs(error.mean()) < 0.001
    assert (steps == 0).mean() == pytest.approx(0.1, abs=0.01)


def test_points_of_a_moving_sensor_lie_on_the_walls_only_at_their_own_time() -> None:
    world = build_world(box_room(), BARE, 0)
    sensor = lidar(world)
    speed = 2.0
    poses = np.repeat(np.eye(4)[None], sensor.pattern.columns, axis=0)
    poses[:, :3, 3] = (3, 2, 1)
    poses[:, 0, 3] += speed * sensor.pattern.times[0]
    steps, _ = sensor.scan(poses, np.random.default_rng(0))
    points = sensor.pattern.points(steps, 0.002).astype(float)

    def off_the_walls(xyz: np.ndarray) -> float:
        away = np.minimum(np.abs(xyz), np.abs(SIZE - xyz)).min(axis=-1)
        return float(np.quantile(away, 0.95))

    rested = points + np.array([3, 2, 1])
    moved = points + poses[None, :, :3, 3]
    assert off_the_walls(moved) < 0.003
    assert off_the_walls(rested) > 0.05


def test_a_pane_lets_most_beams_through() -> None:
    glazed = build_world(box_room((window("w", -0.1, 2.0, "a", "a.w"),)), BARE, 0)
    origin = np.array([2.0, 2.0, 1.5])

    def returns(**glass: float) -> np.ndarray:
        sensor = lidar(glazed, **glass)
        steps, _ = sensor.scan(at(*origin), np.random.default_rng(3))
        rays = sensor.pattern.directions.astype(float)
        t = (-0.1 - origin[0]) / np.where(rays[..., 0] < 0, rays[..., 0], np.nan)
        cross = origin + t[..., None] * rays
        inside = (np.abs(cross[..., 1] - 2.0) < 0.55) & (np.abs(cross[..., 2] - 1.5) < 0.45)
        # Away from the bar in the middle of the window.
        inside &= np.abs(cross[..., 1] - 2.0) > 0.1
        near = np.abs(steps * 0.002 - t) < 0.05
        assert inside.sum() > 100
        return near[inside]

    assert returns(glass_pass=1.0, glass_return=0.0).mean() == 0
    assert returns(glass_pass=0.0, glass_return=1.0).mean() == 1
    assert returns(glass_pass=0.7, glass_return=0.2).mean() == pytest.approx(0.2, abs=0.06)


def test_nothing_leaks_out_of_a_closed_room() -> None:
    world = build_world(two_rooms(state="closed"), BARE, 0)
    solid = world.mesh.where(~world.panes)
    assert len(solid.part) < len(world.mesh.part)
    rng = np.random.default_rng(0)
    rays = rng.normal(size=(50_000, 3)).astype(np.float32)
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    start = (np.array([2.0, 2.0, 1.0]) - world.origin).astype(np.float32)
    hits = RayCaster(world).cast(np.broadcast_to(start, rays.shape), rays)
    assert (hits.triangle >= 0).all()
    assert hits.distance.max() < 7.0
