"""Your own odometry: anything with `register`.

This one believes the robot's own odometry and looks at no scan; walls and rooms then correct it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

import situgraph as sg
from situgraph.plan.six_rooms import six_rooms
from situgraph.run import feed
from situgraph.sim.simulation import Simulation
from situgraph.slam.odometry import Step

Array = NDArray[np.float64]


class Believer:
    """Takes the expected pose, which comes from the robot's odometry, for the truth."""

    def register(self, points: Array, sensor: Array, guess: Array, reach: float) -> Step:
        """The pose (4x4) of a scan whose ``points`` (n, 3) lie in base."""
        return Step(guess, trusted=True, fit=1.0)


building = six_rooms(2)
log = Simulation(building, rooms=("r1", "r2"), camera=False)
mounted = log.info.base_T_lidar
pipeline = sg.Pipeline(building, odometry=Believer(), base_T_lidar=mounted, semantics="none")
for message in log.messages(("scans", "odometry")):
    feed(pipeline, message)
state = pipeline.finish()
print(f"{state.rooms} rooms, {state.keyframes} keyframes; {state.verdict}, {state.solutions} left")
x, y = state.pose[:2]
print(f"in its map the robot is at ({x:.2f}, {y:.2f}) m")
