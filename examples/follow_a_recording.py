"""Follow a recording message by message and say what is known after each new room.

    python examples/follow_a_recording.py [LOG PLAN]

LOG is any recording (a folder of `situgraph simulate`, a ROS bag ...), PLAN any plan. Without
them a robot is simulated that walks from one room of the embedded building into the next.
"""

from __future__ import annotations

import sys

import situgraph as sg
from situgraph.io.recording import Recording
from situgraph.plan.six_rooms import six_rooms
from situgraph.run import feed
from situgraph.sim.simulation import Simulation


def follow(recording: Recording, plan: sg.SceneGraph) -> None:
    """Print a line at each change of what is known."""
    info = recording.info
    pipeline = sg.Pipeline(plan, base_T_lidar=info.base_T_lidar, base_T_camera=info.base_T_camera)
    known: tuple[str | None, int] = (None, 0)
    for message in recording.messages():
        feed(pipeline, message)
        state = pipeline.state
        if (state.verdict, state.rooms) != known:
            known = (state.verdict, state.rooms)
            when = state.stamp - info.start
            print(f"after {when:.1f} s: {state.rooms} rooms, {state.verdict or 'not matched yet'}")


if __name__ == "__main__":
    if len(sys.argv) > 2:
        follow(sg.open_recording(sys.argv[1]), sg.read_plan(sys.argv[2]))
    else:
        building = six_rooms()
        follow(Simulation(building, rooms=("r1", "r2"), camera=False), building)
