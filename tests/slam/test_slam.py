"""A drive through an analytic world becomes a scene graph."""

from __future__ import annotations

import numpy as np
import pytest
from tests.slam.worlds import Sweep, World, drive

from situgraph.scenegraph.validation import validate
from situgraph.slam.slam import Slam


def one_room() -> World:
    world = World()
    for a, b in (((0, 0), (6, 0)), ((6, 0), (6, 5)), ((6, 5), (0, 5)), ((0, 5), (0, 0))):
        world.wall(a, b)
    return world


@pytest.fixture(scope="module")
def driven() -> tuple[Slam, list[Sweep]]:
    slam = Slam()
    sweeps = list(drive(one_room(), [(1.5, 1.5), (4.5, 1.5), (4.5, 3.5)], columns=360))
    for sweep in sweeps:
        slam.feed_odometry(sweep.stamp, sweep.odometry)
        slam.feed_scan(sweep.stamp, sweep.points, sweep.times)
    return slam, sweeps


def test_the_trajectory_follows_the_robot(driven: tuple[Slam, list[Sweep]]) -> None:
    slam, sweeps = driven
    stamps, poses = slam.trajectory()
    truth = np.array([s.truth for s in sweeps])
    assert stamps.tolist() == [s.stamp for s in sweeps]
    error = (poses - poses[0])[:, :2] - (truth - truth[0])[:, :2]
    assert np.abs(error).max() < 0.03


def test_the_four_walls_are_planes_that_face_the_room(driven: tuple[Slam, list[Sweep]]) -> None:
    slam, _ = driven
    graph = validate(slam.scene_graph(), "test")
    assert graph.kind == "online"
    long = [p for p in graph.planes if float(p.attributes["length"] or 0) > 2]
    found = sorted((round(p.normal[0]), round(p.normal[1]), round(p.offset, 1)) for p in long)
    assert found == [(-1, 0, 5.9), (0, -1, 4.9), (0, 1, -0.1), (1, 0, -0.1)]


def test_a_wall_with_a_door_is_one_plane_however_short_its_parts() -> None:
    world = World()
    world.wall((0, 0), (9, 0))
    world.wall((0, 2), (9, 2))
    world.wall((0, 0), (0, 2))
    world.wall((9, -2), (9, 4), doors=((3.0, 0.9),))
    for a, b in (((9, -2), (13, -2)), ((9, 4), (13, 4)), ((13, -2), (13, 4))):
        world.wall(a, b)
    slam = Slam()
    for sweep in drive(world, [(2.0, 1.0), (7.0, 1.0), (11.0, 1.0), (11.5, 2.0)], columns=450):
        slam.feed_odometry(sweep.stamp, sweep.odometry)
        slam.feed_scan(sweep.stamp, sweep.points, sweep.times)
    graph = slam.scene_graph()
    across = [p for p in graph.planes if abs(p.normal[0]) > 0.9]
    ends = sorted(round(-p.offset / p.normal[0], 1) for p in across)
    assert ends == [0.1, 8.9, 9.1, 12.9]
    corridor = min(graph.rooms, key=lambda r: r.center[0])
    assert len(corridor.planes) == 4
