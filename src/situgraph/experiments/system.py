"""Experiment ``system``: the whole system on random buildings with faults, from sensors to a place.

Each run draws a building of some kind, moves a wall of it now and then, drives a robot through a
few of its rooms, and hurts the log or takes the camera away. ``right``: the placement at the end is
the true one; ``wrong``: it is not, and the system did not say that there were others;
``ambiguous``: several were left; ``never``: none was. With the building models at hand a last run
locates a robot in the Institute by its ROS 2 bag.
"""

from __future__ import annotations

import tempfile
import typing
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np

from situgraph.experiments.results import ExperimentResult
from situgraph.experiments.runner import Experiment, RunOptions, run_experiment
from situgraph.judging import counted
from situgraph.plan.ifc import peak_memory_mb
from situgraph.plan.layout_config import Kind

if TYPE_CHECKING:
    from situgraph.io.recording import Recording
    from situgraph.pipeline import Pipeline
    from situgraph.run import Run
    from situgraph.scenegraph.graph import SceneGraph
    from situgraph.sim.config import SimConfig
    from situgraph.sim.simulation import Simulation
    from situgraph.sim.truth import Truth

REVISION = 4
DATA = "../shared/data"
RUNS = (10, 100)
KINDS: tuple[Kind, ...] = typing.get_args(Kind)
PLANNED = 10  # rooms of a building
VISITED = 4  # rooms the robot is sent to
BAG = "Institute, ROS 2 bag"
INSTITUTE, STOREY = "ifc/AC11-Institute-Var-2-IFC.ifc", "Erdgeschoss"
SEES = ("network", "none")
WALKS = 5  # tries to draw rooms that can all be reached


def run(options: RunOptions) -> ExperimentResult:
    """Compute it. Extra parameters: ``runs``; ``data``, the folder with ``ifc``; ``bag`` (bool)."""
    from situgraph.experiments.faults import FAULTS

    runs = int(options.extra.get("runs", RUNS[options.full]))
    data = Path(str(options.extra.get("data", DATA)))
    faults = ("", "", *FAULTS)
    tasks: list[dict[str, Any]] = []
    for number in range(runs):
        rng = np.random.default_rng([options.seed, 61, number])
        tasks.append(
            {
                "building": str(rng.choice(KINDS)),
                "seed": options.seed + number,
                "fault": str(rng.choice(faults)),
                "detector": SEES[int(rng.random() < 0.2)],
                "moved_walls": int(rng.integers(0, 2)),
            }
        )
    if options.extra.get("bag", True) and (data / INSTITUTE).is_file():
        tasks.append({"building": BAG, "seed": options.seed, "data": str(data)})
    experiment = Experiment("system", tasks, solve, summarise, options.seed, REVISION)
    return run_experiment(experiment, options)


def solve(task: Mapping[str, Any]) -> dict[str, Any]:
    """One run."""
    from situgraph.experiments.slam import reset_peak
    from situgraph.judging import judged_deviations, outcome

    reset_peak()
    done, system, truth = _bag(task) if task["building"] == BAG else _drawn(task)
    return {
        **task,
        **outcome(system, truth),
        "located_s": done.located_at,
        "duration": done.duration,
        "rooms": done.rooms,
        "objects": done.objects,
        "sees": done.detector,
        "events": [
            {"s": e.stamp - truth.stamps[0], "what": e.happening, "rooms": e.rooms, "why": e.reason}
            for e in done.events
        ],
        "reason": done.reason,
        **judged_deviations(done.deviations, truth),
        "moved": [d.ids for d in truth.deviations if d.kind == "moved-wall"],
        "realtime": done.realtime,
        "peak_mb": peak_memory_mb(),
        "warnings": sorted({w.code for w in done.warnings}),
    }


def _drawn(task: Mapping[str, Any]) -> tuple[Run, Pipeline, Truth]:
    """A random building, a drive through a few rooms of it, something wrong."""
    from situgraph.config import Settings
    from situgraph.detectors import make_detector
    from situgraph.experiments.faults import faulty
    from situgraph.plan.layouts import make_layout

    settings = Settings()
    plan = make_layout(task["building"], PLANNED, task["seed"])
    world = msgspec.structs.replace(settings.sim.world, moved_walls=task["moved_walls"])
    config = msgspec.structs.replace(settings.sim, world=world)
    camera = task["detector"] != "none"
    drive = _drive(plan, config, task["seed"], camera)
    recording: Recording = faulty(drive, task["fault"], task["seed"]) if task["fault"] else drive
    done, system = _run(recording, settings, plan, make_detector(task["detector"], ""))
    return done, system, drive.truth


def _drive(plan: SceneGraph, config: SimConfig, seed: int, camera: bool) -> Simulation:
    """Through a few rooms; drawn again where one of them is blocked by furniture."""
    from situgraph.errors import InputError
    from situgraph.plan.exploration import RoomLinks
    from situgraph.sim.simulation import Simulation

    for attempt in range(WALKS):
        key = [seed, 62, attempt] if attempt else [seed, 62]
        walk = RoomLinks(plan).walk(VISITED, np.random.default_rng(key))
        rooms = tuple(plan.rooms[k].id for k in walk.stops)
        try:
            return Simulation(plan, config, seed=seed, rooms=rooms, camera=camera)
        except InputError:
            if attempt == WALKS - 1:
                raise
    raise AssertionError(WALKS)


def _bag(task: Mapping[str, Any]) -> tuple[Run, Pipeline, Truth]:
    """A drive on one storey of the Institute as a ROS 2 bag, located in the whole building."""
    from situgraph.api import read_plan
    from situgraph.config import Settings
    from situgraph.detectors import default_detector, make_detector
    from situgraph.io.recording import open_recording
    from situgraph.sim.record import record
    from situgraph.sim.simulation import Simulation, rooms_on

    settings = Settings()
    plan = read_plan(Path(task["data"]) / INSTITUTE)
    drive = Simulation(plan, seed=task["seed"], rooms=rooms_on(plan, STOREY)[:5])
    with tempfile.TemporaryDirectory() as folder:
        recording = open_recording(record(drive, Path(folder) / "bag", "ros2"))
        detector = make_detector(default_detector(recording.info), "")
        done, system = _run(recording, settings, plan, detector)
    return done, system, drive.truth


def _run(recording: Recording, settings: Any, plan: SceneGraph, detector: Any) -> Any:
    from situgraph.run import run_log

    return run_log(recording, settings, plan=plan, detector=detector)


def summarise(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Counts over the drawn runs; speed and memory; the bag apart."""
    drawn = [r for r in rows if r["building"] != BAG]
    counts = {
        name: sum(r["outcome"] == name for r in drawn)
        for name in ("right", "ambiguous", "never", "wrong")
    }
    told = {which: counted(drawn, f"told_{which}") for which in ("true", "false")}
    located = [r["located_s"] for r in drawn if r["outcome"] == "right"]
    summary: dict[str, Any] = {
        "runs": len(drawn),
        **counts,
        "located_s_median": float(np.median(located)) if located else None,
        "realtime_median": float(np.median([r["realtime"] for r in rows])),
        "peak_mb": max(r["peak_mb"] for r in rows),
        "withdrawn": sum(any(e["what"] == "withdrawn" for e in r["events"]) for r in drawn),
        "told_true": sum(told["true"].values()),
        "told_false": sum(told["false"].values()),
        "told": told,
    }
    for row in rows:
        if row["building"] == BAG:
            keys = ("outcome", "placement_error_m", "located_s", "realtime", "peak_mb", "duration")
            summary["institute bag"] = {k: row[k] for k in keys} | {
                "told_false": sum(row.get("told_false", {}).values())
            }
    return summary
