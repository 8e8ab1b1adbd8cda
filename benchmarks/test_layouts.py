"""Layouts, samples and IFC files: what drawing them costs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from situgraph.plan.ifc_writer import write_ifc
from situgraph.plan.layouts import make_layout
from situgraph.plan.sampler import Sampler
from situgraph.plan.sampler_config import CLEAN, REALISTIC
from situgraph.plan.six_rooms import six_rooms


@pytest.mark.parametrize("rooms", [12, 500, 10_000])
def test_layout(benchmark: Any, rooms: int) -> None:
    graph = benchmark.pedantic(make_layout, ("random", rooms), rounds=5, warmup_rounds=1)
    assert len(graph.rooms) == rooms


@pytest.mark.parametrize(("seen", "rooms"), [(6, 12), (10, 100), (50, 500), (50, 10_000)])
@pytest.mark.parametrize("noise", ["clean", "realistic"])
def test_sample(benchmark: Any, seen: int, rooms: int, noise: str) -> None:
    sampler = Sampler(make_layout("random", rooms), CLEAN if noise == "clean" else REALISTIC)
    sample = benchmark(sampler.sample, seen, 1)
    assert len(sample.truth.rooms) == seen


@pytest.mark.parametrize("rooms", [12, 500, 10_000])
def test_sampler(benchmark: Any, rooms: int) -> None:
    prior = make_layout("random", rooms)
    benchmark.pedantic(Sampler, (prior,), rounds=3)


def test_write_ifc(benchmark: Any, tmp_path: Path) -> None:
    benchmark.pedantic(write_ifc, (six_rooms(), tmp_path / "six.ifc"), rounds=5, warmup_rounds=1)
