"""Time of one match, the index built before, beside cliques and injections.

``make bench ARGS="-k test_matching"``: one table for each size, and the 95th percentiles after.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import msgspec
import pytest
from benchmarks.baselines import Answer, by_cliques, by_injections

import situgraph as sg
from situgraph.plan.layouts import make_layout
from situgraph.plan.sample_truth import OnlineSample
from situgraph.plan.sampler import sample_online
from situgraph.plan.sampler_config import CLEAN, REALISTIC
from situgraph.scenegraph.graph import SceneGraph

# Over 50 rooms the drift of a realistic sample bends the map until no rigid placement is left.
STEADY = msgspec.structs.replace(REALISTIC, drift=0.0)
SMALL = [(4, 8), (6, 12)]

Baseline = Callable[[SceneGraph, SceneGraph], Answer]


def drawn(benchmark: Any, seen: int, planned: int) -> tuple[SceneGraph, OnlineSample]:
    """The same plan and sample for all matchers of one size, which share a table."""
    benchmark.group = f"{seen} x {planned} rooms"
    prior = make_layout("random", planned, 0)
    return prior, sample_online(prior, seen, 0, STEADY)


@pytest.mark.parametrize(("seen", "planned"), [*SMALL, (10, 100), (50, 500), (50, 10_000)])
def test_situgraph(benchmark: Any, seen: int, planned: int) -> None:
    prior, sample = drawn(benchmark, seen, planned)
    index = sg.PlanIndex(prior)
    sg.match(sample.online, index)
    result = benchmark(sg.match, sample.online, index)
    assert result.verdict == "unique"


def test_identical_grid(benchmark: Any) -> None:
    benchmark.group = "50 x 500 rooms, all alike"
    prior = make_layout("grid", 500, 0, "local")
    online = sample_online(prior, 50, 0, CLEAN).online
    index = sg.PlanIndex(prior)
    sg.match(online, index, semantics="none")
    result = benchmark(sg.match, online, index, semantics="none")
    assert result.verdict == "ambiguous"


def test_index(benchmark: Any) -> None:
    benchmark.group = "index of 10,000 rooms"
    prior = make_layout("random", 10_000, 0)
    sg.PlanIndex(make_layout("random", 12, 0))  # compiles
    assert benchmark(sg.PlanIndex, prior).rooms == 10_000


@pytest.mark.parametrize(("seen", "planned"), SMALL)
@pytest.mark.parametrize("baseline", [by_cliques, by_injections])
def test_baseline(benchmark: Any, baseline: Baseline, seen: int, planned: int) -> None:
    prior, sample = drawn(benchmark, seen, planned)
    answer = benchmark(baseline, sample.online, prior)
    true = sample.truth.rooms.items()
    benchmark.extra_info.update(
        answers=len(answer.assignments), steps=answer.steps, complete=answer.complete
    )
    assert answer.complete
    assert any(true <= found.items() for found in answer.assignments)
