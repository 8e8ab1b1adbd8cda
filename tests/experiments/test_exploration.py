"""The paper's table I from sampled views: its form, and what walls alone can tell."""

from __future__ import annotations

from itertools import islice

import pytest

from situgraph.experiments.exploration import driven, only_rooms, paper, run, summarise
from situgraph.experiments.results import ExperimentResult
from situgraph.experiments.runner import RunOptions
from situgraph.objects.network import NetworkDetector
from situgraph.pipeline import Pipeline
from situgraph.plan.six_rooms import six_rooms
from situgraph.run import feed
from situgraph.scenegraph.graph import SceneGraph
from situgraph.sim.simulation import Simulation


@pytest.fixture(scope="module")
def result() -> ExperimentResult:
    return run(RunOptions(extra={"source": "sampler", "seeds": 2}))


def test_walls_alone_tell_only_where_the_layout_breaks_its_symmetry(
    result: ExperimentResult,
) -> None:
    summary = result.summary
    assert set(summary["cells"]) == {"none", "containment", "likelihood"}
    cells = summary["cells"]["none"]
    assert len(cells) == 21
    found = {key for key, value in cells.items() if value is not None}
    assert {"3x3", "5x5"} <= found <= {"3x3", "5x4", "5x5"}
    assert summary["wrong"] == 0


def test_objects_tell_in_every_cell(result: ExperimentResult) -> None:
    assert result.summary["cells_found"]["likelihood"] == 21
    assert result.summary["seeds"]["likelihood"]["6x1"] == "2/2"


def test_the_papers_cells_are_those_of_its_table() -> None:
    cells = paper()
    assert cells["semantic"]["6x6"] == 305
    assert cells["semantic"]["5x1"] == 43
    assert [c for c, t in cells["geometric"].items() if t] == ["3x3", "5x5"]
    assert set(cells["semantic"]) == set(cells["geometric"])


def test_a_cell_that_half_of_the_seeds_miss_is_empty() -> None:
    rows = [
        {"rooms": 1, "cells": {"none": {"1": t}}, "wrong": {}, "detected": {"1": 1.0}}
        for t in (3.0, None)
    ]
    summary = summarise(rows)
    assert summary["cells"]["none"]["1x1"] is None
    assert summary["seeds"]["none"]["1x1"] == "1/2"


def test_only_some_rooms_are_kept() -> None:
    graph = six_rooms()
    part = only_rooms(graph, ["r1", "r4"])
    assert [r.id for r in part.rooms] == ["r1", "r4"]
    assert len(part.planes) == 8
    assert all(set(o.rooms) <= {"r1", "r4"} for o in part.objects)
    assert all(set(o.planes) <= {p.id for p in part.planes} for o in part.objects)


def test_what_is_matched_is_what_the_live_system_matches() -> None:
    plan = six_rooms(1)
    drive = Simulation(plan, seed=0, rooms=("r1",))
    live = Pipeline(
        detector=NetworkDetector(),
        base_T_lidar=drive.info.base_T_lidar,
        base_T_camera=drive.info.base_T_camera,
    )
    messages = drive.messages()
    counts = []
    # By the third keyframe the gaps that the LiDAR saw in the walls say something of the doors.
    for moment in islice(driven(plan, 0), 4):
        while live.state.stamp - drive.info.start < moment.seconds - 0.01:
            feed(live, next(messages))
        here, there = moment.graphs["network"], live.graph
        assert [(r.id, r.planes) for r in here.rooms] == [(r.id, r.planes) for r in there.rooms]
        assert related(here) == related(there)
        counts.append(len(related(here)))
    assert counts == sorted(counts)
    assert counts[-1] > 2


def related(graph: SceneGraph) -> list[tuple[str, tuple[str, ...], tuple[str, ...]]]:
    return sorted((o.category, o.rooms, o.planes) for o in graph.objects)
