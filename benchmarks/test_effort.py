"""A step of the search takes about as long wherever it is made: so ``max_work`` bounds the time.

``make bench ARGS="benchmarks/test_effort.py"``: searches that are all cut short after as many
steps, in one table. Without the shared data, only of the plans that are made here.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

import situgraph as sg
from situgraph.api import read_plan
from situgraph.experiments.certificate import COVERED
from situgraph.matching import MatchingConfig
from situgraph.plan.layouts import make_layout
from situgraph.plan.sampler import sample_online
from situgraph.plan.sampler_config import CLEAN
from situgraph.scenegraph.graph import Plane, Room, SceneGraph

STEPS = 50_000_000
EVERYTHING = MatchingConfig(max_work=STEPS, rival_ratio=0.0)


def polygon(walls: int) -> SceneGraph:
    """One room with so many walls in as many directions."""
    turns = [2 * math.pi * k / walls for k in range(walls)]
    planes = tuple(
        Plane(f"p{k}", (-math.cos(t), -math.sin(t), 0.0), 5.0) for k, t in enumerate(turns)
    )
    room = Room("r", (0.0, 0.0, 1.3), tuple(p.id for p in planes))
    return SceneGraph(rooms=(room,), planes=planes)


def time_steps(benchmark: Any, online: SceneGraph, prior: SceneGraph) -> None:
    """Search until the steps are used up."""
    benchmark.group = f"{STEPS:,} steps"
    index = sg.PlanIndex(prior, EVERYTHING)
    result = benchmark.pedantic(
        sg.match, (online, index), {"semantics": "none"}, rounds=3, warmup_rounds=1
    )
    benchmark.extra_info["steps"] = result.stats["steps"]
    assert not result.complete


def test_polygon(benchmark: Any) -> None:
    time_steps(benchmark, polygon(120), polygon(120))


def test_grid(benchmark: Any) -> None:
    prior = make_layout("grid", 5_000, 0, "local")
    time_steps(benchmark, sample_online(prior, 60, 0, CLEAN).online, prior)


@pytest.mark.external
@pytest.mark.parametrize(
    ("file", "rooms"),
    [("plans/SIST_1.osm", n) for n in (1, 2, 3, 5)] + [("ifc/Office_A_20110811.ifc", 1)],
)
def test_building(benchmark: Any, shared_data: Path, file: str, rooms: int) -> None:
    prior = read_plan(shared_data / file)
    time_steps(benchmark, sample_online(prior, rooms, 0, COVERED).online, prior)
