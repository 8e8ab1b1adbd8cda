"""A graph that grows room by room: ``Matcher.update`` beside a match from scratch.

``make bench ARGS=benchmarks/test_incremental.py``: one table for all 50 rooms, one for each of some
single rooms. In processor time, which a busy machine disturbs less.
"""

from __future__ import annotations

import time
from functools import cache
from typing import Any

import pytest
from benchmarks.test_matching import STEADY

import situgraph as sg
from situgraph.plan.layouts import make_layout
from situgraph.plan.sampler import sample_online
from situgraph.scenegraph.graph import SceneGraph

pytestmark = pytest.mark.benchmark(timer=time.process_time)

SEEN, PLANNED = 50, 500
ROOMS = (5, 10, 20, 35, 49, 50)  # a few whose step is timed by itself
ROUNDS = 7


@cache
def walk() -> tuple[sg.PlanIndex, list[SceneGraph]]:
    """The plan, and the graph after each room."""
    prior = make_layout("random", PLANNED, 0)
    online = sample_online(prior, SEEN, 0, STEADY).online
    states = [online.replace(rooms=online.rooms[: k + 1]) for k in range(len(online.rooms))]
    return sg.PlanIndex(prior), states


def up_to(rooms: int) -> sg.Matcher:
    """A matcher that has seen so many rooms, one after the other."""
    index, states = walk()
    matcher = sg.Matcher(index)
    for state in states[:rooms]:
        matcher.update(state)
    return matcher


def test_all_updates(benchmark: Any) -> None:
    benchmark.group = f"{SEEN} rooms one by one into {PLANNED}"
    up_to(SEEN)
    benchmark.pedantic(up_to, (SEEN,), rounds=ROUNDS)


def test_all_from_scratch(benchmark: Any) -> None:
    benchmark.group = f"{SEEN} rooms one by one into {PLANNED}"
    index, states = walk()

    def all_anew() -> None:
        for state in states[:SEEN]:
            sg.match(state, index)

    benchmark.pedantic(all_anew, rounds=ROUNDS)


@pytest.mark.parametrize("room", ROOMS)
def test_update(benchmark: Any, room: int) -> None:
    benchmark.group = f"room {room} of {SEEN} into {PLANNED}"
    state = walk()[1][room - 1]
    benchmark.pedantic(
        sg.Matcher.update, setup=lambda: ((up_to(room - 1), state), {}), rounds=ROUNDS
    )


@pytest.mark.parametrize("room", ROOMS)
def test_from_scratch(benchmark: Any, room: int) -> None:
    benchmark.group = f"room {room} of {SEEN} into {PLANNED}"
    index, states = walk()
    benchmark.pedantic(sg.match, (states[room - 1], index), rounds=ROUNDS)
