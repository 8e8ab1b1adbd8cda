"""The object stage on one core: the network, the rest of a frame, and the relations.

Targets: the network 30 ms a 640 x 480 picture, all the rest 30 ms.
"""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest

from situgraph.geometry.poses import pose_to_matrix
from situgraph.objects.detections import Camera
from situgraph.objects.network import NetworkDetector
from situgraph.objects.stage import ObjectStage, View
from situgraph.plan.six_rooms import six_rooms
from situgraph.sim.simulation import Simulation, pose_matrix

FRAMES = 30


@pytest.fixture(scope="module")
def views() -> list[View]:
    drive = Simulation(six_rooms(), seed=1)
    mount = pose_matrix(drive.info.base_T_camera)
    out = []
    for frame in itertools.islice(drive.messages(("frames",)), FRAMES):
        at = int(np.argmin(np.abs(drive.truth.stamps - frame.stamp)))
        pose = pose_to_matrix(drive.truth.poses[at])
        out.append(
            View(
                f"k{len(out)}", frame.stamp, frame.rgb, frame.depth,
                Camera(*frame.intrinsics), pose, mount,
            )
        )  # fmt: skip
    return out


class Remembered:
    """What the network found, without its time."""

    name = "remembered"

    def __init__(self, views: list[View]) -> None:
        network = NetworkDetector()
        self.categories = network.categories
        self._found = {v.stamp: network.detect(v.rgb, v.stamp) for v in views}

    def detect(self, rgb: Any, stamp: float) -> Any:
        return self._found[stamp]


def test_network(benchmark: Any, views: list[View]) -> None:
    network, images = NetworkDetector(), itertools.cycle(views)
    benchmark.pedantic(lambda: network.detect(next(images).rgb), rounds=2 * FRAMES, warmup_rounds=2)


def test_rest_of_a_frame(benchmark: Any, views: list[View]) -> None:
    stage, images = ObjectStage(Remembered(views)), itertools.cycle(views)
    benchmark.pedantic(lambda: stage.feed(next(images)), rounds=2 * FRAMES, warmup_rounds=1)


def test_relations_of_all_objects(benchmark: Any, views: list[View]) -> None:
    stage = ObjectStage(Remembered(views))
    for view in views:
        stage.feed(view)
    rooms, path = six_rooms().replace(objects=()), np.array([v.pose[:3, 3] for v in views])
    graph = benchmark.pedantic(lambda: stage.annotated(rooms, path), rounds=10, warmup_rounds=1)
    assert any(o.category == "door" for o in graph.objects)
