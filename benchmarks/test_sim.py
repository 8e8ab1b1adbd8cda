"""The simulator on one core: a world, a second of LiDAR, an image; and what a recording weighs.

Real time needs a second of LiDAR and two images to take less than a second together.
"""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Any

import pytest

from situgraph.io.folder import FolderWriter
from situgraph.plan.six_rooms import six_rooms
from situgraph.sim.simulation import Simulation


@pytest.fixture(scope="module")
def drive() -> Simulation:
    return Simulation(six_rooms(), seed=1)


def test_build_world_and_route(benchmark: Any) -> None:
    benchmark.pedantic(lambda: Simulation(six_rooms(), seed=1, camera=False), rounds=3)


def test_second_of_lidar(benchmark: Any, drive: Simulation) -> None:
    scans = benchmark(lambda: list(itertools.islice(drive.messages(("scans",)), 10)))
    assert len(scans) == 10


def test_image(benchmark: Any, drive: Simulation) -> None:
    frames = iter(drive.messages(("frames",)))
    benchmark.pedantic(lambda: next(frames), rounds=30, warmup_rounds=1)


def test_weight_of_a_recording(drive: Simulation, tmp_path: Path) -> None:
    """A drive of five minutes stays below 300 MB."""
    writer = FolderWriter(tmp_path, drive.info)
    end = drive.config.start + 20.0
    for message in itertools.takewhile(lambda m: m.stamp < end, drive.messages()):
        writer.add(message)
    writer.finish()
    size = sum(f.stat().st_size for f in tmp_path.rglob("*") if f.is_file())
    print(f"\n{size / 20 / 1e6:.2f} MB a second, {size * 15 / 1e6:.0f} MB in five minutes")
    assert size * 15 < 300e6
