"""One short drive that many tests look at."""

from __future__ import annotations

from pathlib import Path

import pytest
from tests.sim.buildings import two_rooms

from situgraph.sim.config import CameraConfig, RobotConfig, SimConfig
from situgraph.sim.record import record
from situgraph.sim.simulation import Simulation

# Little pictures by ray casting: quick, and the same where there is no OpenGL.
SMALL = SimConfig(
    camera=CameraConfig(fallback_width=64, rate=1.0), robot=RobotConfig(look_turn=0.6)
)


@pytest.fixture(scope="session")
def drive() -> Simulation:
    """Through the door from one room to the other."""
    return Simulation(two_rooms(), SMALL, seed=5, rooms=("a", "b"), renderer="cpu")


@pytest.fixture(scope="session")
def log(drive: Simulation, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The drive in the folder format."""
    return record(drive, tmp_path_factory.mktemp("drive") / "log")


@pytest.fixture(scope="session")
def bag(drive: Simulation, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The drive as a ROS 2 bag."""
    return record(drive, tmp_path_factory.mktemp("drive") / "bag", "ros2")
