"""Experiment ``exploration``: the paper's table I, on the whole simulated system.

A robot drives through plans of 1 to 6 rooms, room after room. Cell (m, j): in the plan of m rooms,
the seconds until the first j rooms that were detected have a unique and right match; none where
they never have. All policies and detectors look at the same drive. The layout (``six_rooms``) was
fixed before any experiment was run on it; walls alone can tell it only at 3 and 5 rooms.
"""

from __future__ import annotations

import statistics
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, get_args

import numpy as np

from situgraph.config import Settings
from situgraph.experiments.detection import Stages, oracle_of
from situgraph.experiments.results import ExperimentResult
from situgraph.experiments.runner import Experiment, RunOptions, run_experiment
from situgraph.geometry.poses import Placement
from situgraph.judging import RIGHT_ANGLE, RIGHT_DISTANCE, apart
from situgraph.matching import PlanIndex, match
from situgraph.matching.matcher import Semantics
from situgraph.objects.network import NetworkDetector
from situgraph.objects.stage import ObjectStage
from situgraph.pipeline import Pipeline, as_passed
from situgraph.plan.sample_prefix import first_rooms
from situgraph.plan.sampler import Sampler
from situgraph.plan.sampler_config import PAPER_DETECTOR, SamplerConfig
from situgraph.plan.six_rooms import six_rooms
from situgraph.run import feed
from situgraph.scenegraph.graph import SceneGraph
from situgraph.sim.simulation import Simulation

REVISION = 3
ROOMS = 6
SEEDS = {"simulation": (2, 10), "sampler": (10, 100)}  # default, full
POLICIES: tuple[Semantics, ...] = get_args(Semantics)
DOORWAYS = "doorways only"
WITH_OBJECTS: tuple[Semantics, ...] = ("containment", "likelihood")
# The paper's table I (s), a line a plan; what is left out there is no valid match.
PAPER_SEMANTIC = (
    (41,),
    (43, 84),
    (41, 87, 147),
    (42, 89, 149, 202),
    (43, 90, 152, 210, 270),
    (41, 90, 151, 209, 275, 305),
)
PAPER_GEOMETRIC = {"3x3": 148, "5x5": 272}


def run(options: RunOptions) -> ExperimentResult:
    """Compute it.

    Extra parameters: ``source`` (``simulation``, or ``sampler`` for a quick look without sensors:
    its times are metres walked), ``seeds``.
    """
    source = str(options.extra.get("source", "simulation"))
    seeds = int(options.extra.get("seeds", SEEDS[source][options.full]))
    tasks = [
        {"source": source, "rooms": rooms, "seed": options.seed + seed}
        for seed in range(seeds)
        for rooms in range(1, ROOMS + 1)
    ]
    experiment = Experiment("exploration", tasks, solve, summarise, options.seed, REVISION)
    return run_experiment(experiment, options)


@dataclass(frozen=True, eq=False)
class Moment:
    """What was known after ``seconds``: rooms in the order of detection, graphs by detector."""

    seconds: float
    order: Sequence[str]
    graphs: Mapping[str, SceneGraph]
    truth: Placement


def solve(task: Mapping[str, Any]) -> dict[str, Any]:
    """One plan, one drive: the time of each cell by policy and detector."""
    prior = six_rooms(task["rooms"])
    index, configs = PlanIndex(prior), {DOORWAYS: as_passed(Settings())}
    moments = _sampled(prior, task) if task["source"] == "sampler" else driven(prior, task["seed"])
    cells: dict[str, dict[str, float | None]] = {}
    wrong: dict[str, int] = {}
    detected: dict[int, float] = {}
    for moment in moments:
        rooms = len(moment.order)
        for count in range(1, rooms + 1):
            detected.setdefault(count, moment.seconds)
        for name, policy, detector in _cases(moment.graphs):
            graph, config = moment.graphs[detector], configs.get(detector)
            for count in range(1, min(rooms, task["rooms"]) + 1):
                cell = cells.setdefault(name, {})
                if cell.setdefault(str(count), None) is not None:
                    continue
                part = only_rooms(graph, moment.order[:count])
                result = match(part, index, semantics=policy, config=config)
                if result.unique and result.best is not None:
                    if _right(result.best.transform, moment.truth, part):
                        cell[str(count)] = moment.seconds
                    else:
                        wrong[name] = wrong.get(name, 0) + 1
    return {
        **task,
        "cells": cells,
        "wrong": wrong,
        "detected": {str(k): v for k, v in detected.items()},
    }


def _cases(detectors: Iterable[str]) -> Iterator[tuple[str, Semantics, str]]:
    """What is compared, by which policy and detector: walls alone once, the others for each.

    The first detector's cases bear the name of their policy alone.
    """
    first = next(iter(detectors))
    yield "none", "none", first
    for detector in detectors:
        for policy in WITH_OBJECTS:
            name = policy if detector == first else f"{policy}, {detector}"
            yield name, policy, detector


def _right(found: Placement, true: Placement, online: SceneGraph) -> bool:
    middle = np.mean([r.center for r in online.rooms], axis=0)
    distance, angle = apart(found, true, middle)
    return distance <= RIGHT_DISTANCE and angle <= RIGHT_ANGLE


def only_rooms(graph: SceneGraph, rooms: Sequence[str]) -> SceneGraph:
    """The graph with these rooms alone, their planes and their objects."""
    import msgspec

    kept = set(rooms)
    nodes = tuple(r for r in graph.rooms if r.id in kept)
    planes = {p for r in nodes for p in r.planes}
    objects = tuple(
        msgspec.structs.replace(
            o,
            rooms=tuple(r for r in o.rooms if r in kept),
            planes=tuple(p for p in o.planes if p in planes),
        )
        for o in graph.objects
        if kept & set(o.rooms)
    )
    faces = tuple(p for p in graph.planes if p.id in planes)
    return graph.replace(rooms=nodes, planes=faces, objects=objects)


def driven(prior: SceneGraph, seed: int) -> Iterator[Moment]:
    """A drive through the rooms in their order; a moment for each keyframe."""
    drive = Simulation(prior, seed=seed, rooms=tuple(r.id for r in prior.rooms))
    stages = Stages([NetworkDetector(), oracle_of(drive.truth, seed)])
    names = [s.detector.name for s in stages.all if s.detector is not None]
    blind = ObjectStage(None)
    info = drive.info
    system = Pipeline(
        detector=stages.all[0].detector,
        base_T_lidar=info.base_T_lidar,
        base_T_camera=info.base_T_camera,
    )
    system.objects = stages
    order: list[str] = []
    frames = 0
    for message in drive.messages():
        feed(system, message)
        if len(system.slam.keyframes) == frames:
            continue
        frames = len(system.slam.keyframes)
        seen = system.slam.scene_graph(), system.slam.places(), system.wall_gaps()
        there = {r.id for r in seen[0].rooms}
        order = [r for r in order if r in there] + sorted(there - set(order))
        graphs = {n: s.annotated(*seen) for n, s in zip(names, stages.all)}
        graphs[DOORWAYS] = blind.annotated(*seen)
        if order:
            passed = message.stamp - info.start
            yield Moment(passed, tuple(order), graphs, drive.truth.building_T_map)


def _sampled(prior: SceneGraph, task: Mapping[str, Any]) -> Iterator[Moment]:
    """The same without sensors: a view sampled from the plan, room by room."""
    config = SamplerConfig(plane_offset_sigma=0.02, object_sigma=0.1, detection=PAPER_DETECTOR)
    whole = Sampler(prior, config).sample(task["rooms"], task["seed"], prior.rooms[0].id)
    for count in range(1, len(whole.truth.order) + 1):
        part = first_rooms(whole, prior, count)
        truth = part.truth
        graphs = {"sampled detector": part.online}
        yield Moment(truth.walked[-1], truth.order, graphs, truth.placement)


def paper() -> dict[str, dict[str, int | None]]:
    """The paper's cells, for the same table as ours."""
    cells = [f"{m}x{j}" for m in range(1, ROOMS + 1) for j in range(1, m + 1)]
    semantic = [seconds for line in PAPER_SEMANTIC for seconds in line]
    return {
        "semantic": dict(zip(cells, semantic)),
        "geometric": {cell: PAPER_GEOMETRIC.get(cell) for cell in cells},
    }


def summarise(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Medians over the seeds where more than half of them have a time; shares beside them."""
    names = list(dict.fromkeys(n for r in rows for n in r["cells"]))
    cells: dict[str, dict[str, float | None]] = {}
    shares: dict[str, dict[str, str]] = {}
    for name in names:
        for row_count in range(1, ROOMS + 1):
            mine = [r for r in rows if r["rooms"] == row_count]
            for count in range(1, row_count + 1):
                times = [r["cells"].get(name, {}).get(str(count)) for r in mine]
                found = [t for t in times if t is not None]
                key = f"{row_count}x{count}"
                enough = 2 * len(found) > len(times)
                cells.setdefault(name, {})[key] = statistics.median(found) if enough else None
                shares.setdefault(name, {})[key] = f"{len(found)}/{len(times)}"
    largest = [r for r in rows if r["rooms"] == ROOMS]
    detected = {
        str(k): statistics.median(r["detected"][str(k)] for r in largest if str(k) in r["detected"])
        for k in range(1, ROOMS + 1)
        if any(str(k) in r["detected"] for r in largest)
    }
    return {
        "cells": cells,
        "paper": paper(),
        "cells_found": {n: sum(v is not None for v in c.values()) for n, c in cells.items()},
        "seeds": shares,
        "room_detected_s": detected,
        "wrong": sum(sum(r["wrong"].values()) for r in rows),
        "wrong_by": {n: sum(r["wrong"].get(n, 0) for r in rows) for n in names},
    }
