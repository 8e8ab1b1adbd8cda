"""Gaps that the LiDAR saw reach the doors of the graph: a short drive without a camera."""

from __future__ import annotations

import numpy as np
import pytest
from tests.sim.buildings import door

from situgraph.experiments.slam_buildings import boxed
from situgraph.io.recording import Odometry, Scan
from situgraph.pipeline import Pipeline
from situgraph.sim.simulation import Simulation


@pytest.fixture(scope="module")
def driven() -> Pipeline:
    boxes = {"a": (0.0, 0.0, 4.0, 3.0), "b": (4.2, 0.0, 7.0, 3.4)}
    plan = boxed("two rooms", boxes, (door("d", 4.1, 1.5, ("a", "b"), ("a.e", "b.w")),))
    drive = Simulation(plan, seed=3, rooms=("a", "b"), camera=False)
    system = Pipeline(base_T_lidar=drive.info.base_T_lidar)
    for message in drive.messages(("odometry", "scans")):
        if isinstance(message, Scan):
            system.feed(scan=message)
        elif isinstance(message, Odometry):
            system.feed(odometry=message)
    system.finish()
    return system


def test_the_doorway_passed_is_confirmed_by_the_gap_in_both_faces(driven: Pipeline) -> None:
    doors = [o for o in driven.graph.objects if o.category == "door"]
    assert [o.attributes["evidence"] for o in doors] == ["trajectory,gap"]
    assert len(doors[0].planes) == 2


def test_gaps_invent_and_move_nothing(driven: Pipeline) -> None:
    graph, path = driven.slam.scene_graph(), driven.slam.places()
    bare = driven.objects.annotated(graph, path).objects
    assert [o.id for o in driven.graph.objects] == [o.id for o in bare]
    assert all(np.allclose(a.center, b.center) for a, b in zip(driven.graph.objects, bare))
