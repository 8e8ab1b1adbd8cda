"""Experiment ``slam``: the map and the trajectory of simulated drives against the truth.

Each row is a drive through a building, some with a fault in the recording. Work is counted as time
of the processor (all threads), without the simulator's, so that figures hold on a busy machine too.
After the drive the map is matched with the plan by walls alone.
"""

from __future__ import annotations

import contextlib
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from situgraph.config import Settings
from situgraph.errors import InputError
from situgraph.experiments.results import ExperimentResult
from situgraph.experiments.runner import Experiment, RunOptions, run_experiment
from situgraph.plan.ifc import peak_memory_mb

DATA = "../shared/data"
SEEDS = (1, 3)
LONG = "long drive"
REPEATS = (2, 17)  # times through the six rooms: about 3 and 30 minutes
# Images make a drive twice as long to simulate; by default only these have them.
WITH_CAMERA = ("six rooms", "FZK-Haus", "six rooms, a dark image")
FAULTY = "six rooms"  # the building of the drives with faults


def run(options: RunOptions) -> ExperimentResult:
    """Compute it; with a folder also draw the cost of a scan over the long drive.

    Extra parameters: ``data``, the folder with ``ifc``; ``buildings``, names with semicolons
    between; ``seeds``; ``camera`` (true or false for all drives; by default with ``--full``
    all have one, else some).

    Raises:
        InputError: the folder or a building is not there.
    """
    from situgraph.experiments.faults import FAULTS
    from situgraph.experiments.slam_buildings import DRIVES

    data = Path(str(options.extra.get("data", DATA)))
    faults = [f"{FAULTY}, {fault}" for fault in FAULTS]
    names = [*DRIVES, *faults, LONG]
    wanted = [n.strip() for n in str(options.extra.get("buildings", "")).split(";") if n.strip()]
    if set(wanted) - set(names):
        raise InputError("--extra buildings", f"unknown among {wanted}", f"choose of {names}")
    seeds = int(options.extra.get("seeds", SEEDS[options.full]))
    tasks = [
        {
            "building": name, "seed": options.seed + k, "full": options.full, "data": str(data),
            "camera": bool(options.extra.get("camera", options.full or name in WITH_CAMERA)),
        }
        for name in wanted or names
        for k in range(seeds if name in DRIVES else 1)
    ]  # fmt: skip
    experiment = Experiment("slam", tasks, solve, summarise, options.seed)
    result = run_experiment(experiment, options)
    if options.folder is not None:
        draw(result, options.folder)
    return result


def solve(task: Mapping[str, Any]) -> dict[str, Any]:
    """Drive through one building, map it and judge the map."""
    from situgraph.detectors import default_detector, make_detector
    from situgraph.experiments.faults import faulty
    from situgraph.judging import judge
    from situgraph.matching import PlanIndex, match
    from situgraph.pipeline import Pipeline
    from situgraph.sim.simulation import Simulation

    plan, rooms, fault = _drive(task)
    simulation = Simulation(plan, seed=task["seed"], rooms=rooms, camera=task["camera"])
    recording = faulty(simulation, fault, task["seed"]) if fault else simulation
    info = simulation.info
    detector = make_detector(default_detector(info), "")
    pipeline = Pipeline(
        None, Settings(), detector, base_T_lidar=info.base_T_lidar, base_T_camera=info.base_T_camera
    )
    reset_peak()
    cost = _fed(pipeline, recording)
    result = match(pipeline.graph, PlanIndex(plan), semantics="none")
    found = judge(pipeline.graph, pipeline.slam.trajectory(), simulation.truth, result)
    steps = np.array(pipeline.slam.graph.seconds) * 1e3
    return {
        **task,
        "duration": info.duration,
        "detector": "none" if detector is None else detector.name,
        **msgspec.structs.asdict(found),
        "rooms": len(pipeline.graph.rooms),
        "keyframes": len(pipeline.slam.keyframes),
        "realtime": info.duration / max(sum(cost), 1e-9),
        "cost_by_minute": cost,
        "seconds": pipeline.seconds,
        "isam_p95_ms": float(np.percentile(steps, 95)),
        "isam_max_ms": float(steps.max()),
        "peak_mb": peak_memory_mb(),
        "verdict": result.verdict,
        "solutions": result.count,
        "warnings": sorted({w.code for w in pipeline.warnings}),
    }


def _drive(task: Mapping[str, Any]) -> tuple[Any, tuple[str, ...], str]:
    """The plan, the rooms to visit and the fault of a task."""
    from situgraph.experiments.slam_buildings import drive

    name = str(task["building"])
    if name == LONG:
        plan, _ = drive("six rooms", Path(task["data"]), True)
        return plan, ("r1", "r2", "r3", "r6", "r5", "r4") * REPEATS[task["full"]], ""
    building, _, fault = name.partition(", ")
    plan, rooms = drive(building, Path(task["data"]), task["full"])
    return plan, rooms, fault


def _fed(pipeline: Any, recording: Any) -> list[float]:
    """Feed a recording; the processor's seconds by minute of the drive."""
    from situgraph.run import feed

    cost: list[float] = []
    start = recording.info.start
    for message in recording.messages():
        minute = max(int((message.stamp - start) / 60.0), 0)
        cost += [0.0] * (minute + 1 - len(cost))
        begin = time.process_time()
        feed(pipeline, message)
        cost[minute] += time.process_time() - begin
    pipeline.finish()
    return cost


def summarise(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Figures by building, over its seeds."""
    summary = {}
    for name in dict.fromkeys(r["building"] for r in rows):
        mine = [r for r in rows if r["building"] == name]

        def over(key: str, pick: Any = np.median, mine: list[dict[str, Any]] = mine) -> float:
            return float(pick([r[key] for r in mine]))

        summary[name] = {
            "runs": len(mine),
            "minutes": over("duration", np.sum) / 60.0,
            "ate_m": {"median": over("ate_rmse"), "max": over("ate_rmse", np.max)},
            "wall_offset_median_m": over("wall_offset_median"),
            "room_precision": over("room_precision", np.mean),
            "room_recall": over("room_recall", np.mean),
            "storeys_right": sum(r["storeys"] == r["true_storeys"] for r in mine),
            "realtime_factor": over("realtime", np.min),
            "isam_p95_ms": over("isam_p95_ms", np.max),
            "peak_mb": over("peak_mb", np.max),
            "placed": {
                verdict: sum(r["verdict"] == verdict for r in mine)
                for verdict in ("unique", "ambiguous", "none")
            },
            "placed_wrong": sum(r["placement_right"] is False for r in mine),
        }
    return summary


def reset_peak() -> None:
    """Let the kernel count the peak of memory from now on, where it can (Linux)."""
    with contextlib.suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5")


def draw(result: ExperimentResult, folder: Path) -> None:
    """Work for a scan over the minutes of the long drive."""
    from situgraph.view.experiments import draw_lines

    rows = [
        {"building": r["building"], "minute": k + 0.5, "ms": cost / 600.0 * 1e3}
        for r in result.rows
        if r["building"] == LONG
        for k, cost in enumerate(r["cost_by_minute"][:-1])
    ]
    if rows:
        figure = draw_lines(
            rows, "minute", "ms", "building", title="Work for a scan over the drive",
            x_name="minutes driven", y_name="milliseconds a scan",
        )  # fmt: skip
        figure.savefig(folder / "cost.png", dpi=150, bbox_inches="tight")
