"""Storeys from heights, stretches of walls, and rooms from free space and planes."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.slam.worlds import World, drive, rectangle

from situgraph.scenegraph.graph import SceneGraph
from situgraph.slam.config import StoreyConfig
from situgraph.slam.map_evaluation import room_scores
from situgraph.slam.planemap import PlaneMap, united
from situgraph.slam.slam import Slam
from situgraph.slam.storeys import BETWEEN, Storeys

intervals = st.lists(
    st.tuples(st.floats(-20, 20), st.floats(0, 5)).map(lambda p: (p[0], p[0] + p[1])), max_size=8
)


@given(intervals, st.floats(0, 1))
def test_a_union_covers_what_went_in_and_has_no_small_gaps(
    parts: list[tuple[float, float]], gap: float
) -> None:
    whole = united(parts, gap)
    assert all(any(a <= u and v <= b for a, b in whole) for u, v in parts)
    assert all(b[0] - a[1] > gap for a, b in pairwise(whole))
    assert united(whole, gap) == whole


def test_a_plane_keeps_its_stretches_with_the_keyframes_that_saw_them() -> None:
    planes = PlaneMap(0.3)
    wall = planes.new(0, np.array([0.0, 1.0, 0.0, 0.0]))
    still, moved = np.eye(4), np.eye(4)
    moved[0, 3] = 2.0
    planes.widen(wall.number, 0, np.array([[1.0, 0, 0], [2.0, 0, 0]]), (1.5, 1.6), still)
    planes.widen(wall.number, 1, np.array([[1.0, 0, 0], [2.0, 0, 0]]), (1.5, 1.6), moved)
    assert wall.length == pytest.approx(2.0)
    planes.place(wall.number, wall.plane, lambda k: still)  # both keyframes are at one place now
    assert wall.length == pytest.approx(1.0)


def test_merging_two_halves_of_a_wall_leaves_one() -> None:
    planes = PlaneMap(0.3)
    pose = np.eye(4)
    for x in (0.0, 3.0):
        half = planes.new(0, np.array([0.0, 1.0, 0.0, 0.01 * x]))
        planes.widen(half.number, 0, np.array([[x, 0, 0], [x + 2, 0, 0]]), (1.5, 1.6), pose)
    planes.merge(0, 1, lambda k: pose)
    assert list(planes.planes) == [0]
    assert planes.planes[0].length == pytest.approx(4.0)
    assert planes.planes[0].sightings == 2


def test_a_robot_that_stays_level_higher_up_is_on_another_storey() -> None:
    storeys = Storeys(StoreyConfig())
    climb = [0.5, 0.5, 0.9, 1.6, 2.3, 3.0, 3.5, 3.5, 3.5, 3.5]
    found = [storeys.at(z, -0.5) for z in climb]
    assert found[:2] == [0, 0]
    assert BETWEEN in found[2:8]
    assert found[-1] == 1
    assert [s.elevation for s in storeys.storeys] == pytest.approx([0.0, 3.0])
    down = [storeys.at(z, -0.5) for z in (2.0, 1.0, 0.5, 0.5, 0.5)]
    assert down[-1] == 0


def l_shaped() -> tuple[World, np.ndarray]:
    """An L-shaped room with a closed room beside it that the robot does not see."""
    world = World()
    corners = [(0, 0), (7, 0), (7, 3), (4, 3), (4, 6), (0, 6)]
    for a, b in zip(corners, [*corners[1:], corners[0]]):
        world.wall(a, b)
    inside = [(0.1, 0.1), (6.9, 0.1), (6.9, 2.9), (3.9, 2.9), (3.9, 5.9), (0.1, 5.9)]
    return world, np.array(inside)


def test_an_l_shaped_room_is_one_room_with_six_walls() -> None:
    world, inside = l_shaped()
    slam = Slam()
    for sweep in drive(world, [(5.5, 1.5), (2.0, 1.5), (2.0, 4.5)], columns=360):
        slam.feed_odometry(sweep.stamp, sweep.odometry)
        slam.feed_scan(sweep.stamp, sweep.points, sweep.times)
    (room,) = slam.scene_graph().rooms
    assert len(room.planes) == 6
    found = np.array(room.footprint)
    nearest = np.linalg.norm(found[:, None] - inside[None], axis=2).min(axis=1)
    assert len(found) == 6
    assert nearest.max() < 0.05
    assert not slam.reasons


def test_a_room_only_looked_into_leaves_a_reason_with_its_place() -> None:
    world = World()
    for a, b in (((0, 0), (5, 0)), ((0, 4), (5, 4)), ((0, 0), (0, 4))):
        world.wall(a, b)
    world.wall((5, 0), (5, 4), doors=((2.0, 0.9),))
    for a, b in (((5, 0), (10, 0)), ((5, 4), (10, 4)), ((10, 0), (10, 4))):
        world.wall(a, b)
    slam = Slam()
    for sweep in drive(world, [(1.5, 2.0), (3.5, 2.0)], columns=360):
        slam.feed_odometry(sweep.stamp, sweep.odometry)
        slam.feed_scan(sweep.stamp, sweep.points, sweep.times)
    graph = slam.scene_graph()
    assert len(graph.rooms) == 1
    reasons = [w for w in graph.warnings if w.code.startswith("room-")]
    assert reasons
    assert all("room candidate at (" in r.message for r in reasons)


def test_scores_of_a_map_that_is_the_truth_are_perfect() -> None:
    from situgraph.experiments.slam_buildings import boxed

    truth: SceneGraph = boxed("pair", {"a": (0, 0, 4, 3), "b": (4.2, 0, 8, 3)}, ())
    scores = room_scores(truth, truth, ["a", "b"])
    assert (scores.precision, scores.recall) == (1.0, 1.0)
    assert room_scores(truth.replace(rooms=truth.rooms[:1]), truth, ["a", "b"]).recall == 0.5
    assert rectangle(0, 0, 1, 1).shape == (4, 2)
