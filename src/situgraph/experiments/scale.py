"""Experiment ``scale``: time and memory of a match as plans grow.

The time of a match is the wall time of ``match(loaded_graph, index)`` with the default policy.
Robots err as those of ``REALISTIC``, but without drift where 50 rooms were seen: with it their maps
are bent, no placement is left, and they are placed in parts, which is timed apart (``bent``).
Memory and the first use are measured in processes of their own.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from situgraph.experiments.results import ExperimentResult
from situgraph.experiments.runner import Experiment, RunOptions, run_experiment
from situgraph.matching import PlanIndex, match
from situgraph.plan.layout_config import Kind
from situgraph.plan.layouts import make_layout
from situgraph.plan.sampler import Sampler
from situgraph.plan.sampler_config import REALISTIC
from situgraph.scenegraph.codec import write_json
from situgraph.scenegraph.graph import SceneGraph


class Size(msgspec.Struct, frozen=True):
    """Rooms seen, rooms planned, and the kind of building."""

    seen: int
    planned: int
    kind: Kind = "random"
    bent: bool = False  # whether the map has drift


SIZES: Mapping[str, Size] = {
    "6x12": Size(6, 12, bent=True),
    "10x100": Size(10, 100, bent=True),
    "50x500": Size(50, 500),
    "50x10000": Size(50, 10_000),
    "grid 50x500": Size(50, 500, "grid"),
    "bent 50x500": Size(50, 500, bent=True),
}
LADDER = (100, 300, 1_000, 3_000, 10_000, 30_000, 100_000)  # planned rooms, 50 seen
STEADY = msgspec.structs.replace(REALISTIC, drift=0.0)
SAMPLES = (20, 100)  # of each size
BUILDINGS = (2, 5)
REPEATS = 5  # of which the fastest counts: other processes disturb, they do not speed up
STEEP_FROM = 1_000  # rooms from which the exponent is fitted; below, constant costs rule

_CHILD = """
import resource, sys, time
begin = time.perf_counter()
import situgraph
online, prior = (situgraph.load(path) for path in sys.argv[1:3])
loaded = time.perf_counter()
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
index = situgraph.PlanIndex(prior)
situgraph.match(online, index)
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
print(loaded - begin, time.perf_counter() - loaded, before / 1024, peak / 1024)
"""


def run(options: RunOptions) -> ExperimentResult:
    """Compute it; with a folder also draw the curve.

    Extra parameters: ``samples`` and ``buildings`` of each size, ``largest`` plan of the ladder.
    """
    samples = int(options.extra.get("samples", SAMPLES[options.full]))
    buildings = int(options.extra.get("buildings", BUILDINGS[options.full]))
    largest = int(options.extra.get("largest", LADDER[-1]))
    base = {"samples": samples, "seed": options.seed}
    tasks: list[dict[str, Any]] = []
    for name, size in SIZES.items():
        shape = {"size": name, **msgspec.to_builtins(size)}
        tasks += [{"part": "size", **shape, **base, "building": k} for k in range(buildings)]
        tasks.append({"part": "memory", **shape, "seed": options.seed})
    tasks += [
        {"part": "ladder", "size": f"50x{m}", "seen": 50, "planned": m, "kind": "random", **base}
        | {"building": 0, "bent": False}
        for m in LADDER
        if m <= largest
    ]
    tasks.append({"part": "first", **msgspec.to_builtins(SIZES["6x12"]), "seed": options.seed})
    result = run_experiment(Experiment("scale", tasks, solve, summarise, options.seed), options)
    if options.folder is not None:
        draw(result, options.folder)
    return result


def solve(task: Mapping[str, Any]) -> dict[str, Any]:
    """One building: the times of its samples, or the memory and times of a fresh process."""
    prior = building(task)
    sampler = Sampler(prior, REALISTIC if task["bent"] else STEADY)
    if task["part"] in ("memory", "first"):
        online = sampler.sample(task["seen"], task["seed"]).online
        return {**task, **_in_fresh_processes(online, prior, task["part"] == "first")}
    begin = time.perf_counter()
    index = PlanIndex(prior)
    index_ms = 1e3 * (time.perf_counter() - begin)
    taken: list[float] = []
    verdicts: list[str] = []
    for number in range(task["samples"]):
        online = sampler.sample(task["seen"], task["seed"] + number).online
        if not taken:
            match(online, index)  # compiles, where that has not been done
        times = []
        for _ in range(REPEATS):
            begin = time.perf_counter()
            result = match(online, index)
            times.append(1e3 * (time.perf_counter() - begin))
        taken.append(min(times))
        verdicts.append(result.verdict)
    return {**task, "ms": taken, "index_ms": index_ms, "unique": verdicts.count("unique")}


def building(task: Mapping[str, Any]) -> SceneGraph:
    """The plan of a task."""
    seed = 1_000 * task["seed"] + task.get("building", 0)
    if task["kind"] != "grid":
        return make_layout(task["kind"], task["planned"], seed)
    columns = next(c for c in range(int(task["planned"] ** 0.5), 0, -1) if task["planned"] % c == 0)
    return make_layout("grid", task["planned"], seed, shape=(columns, task["planned"] // columns))


def _in_fresh_processes(online: SceneGraph, prior: SceneGraph, first: bool) -> dict[str, Any]:
    """Seconds and MB of a process that loads and matches; ``first``: also with nothing compiled.

    Python keeps bytecode, as it does unless it is told not to; the first process finds none.
    """
    with tempfile.TemporaryDirectory() as name:
        kept = {"PYTHONDONTWRITEBYTECODE": "", "PYTHONPYCACHEPREFIX": f"{name}/bytecode"}
        paths = [Path(name) / "online.json", Path(name) / "prior.json"]
        for graph, path in zip((online, prior), paths):
            write_json(graph, path)
        measured: dict[str, Any] = {}
        if first:
            cold = {"SITUGRAPH_CACHE": f"{name}/cache", "NUMBA_CACHE_DIR": "", **kept}
            measured["first_use_s"] = _child(paths, cold)["seconds"]
        _child(paths, kept)  # compiles, where that has not been done
        warm = _child(paths, kept)
        return {**measured, "fresh_process_s": warm["seconds"], **warm}


def _child(paths: list[Path], environment: Mapping[str, str]) -> dict[str, float]:
    begin = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-c", _CHILD, *map(str, paths)],
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=True,
    )
    seconds = time.perf_counter() - begin
    load_s, match_s, loaded_mb, peak_mb = map(float, done.stdout.split())
    return {
        "seconds": seconds,
        "load_s": load_s,
        "match_s": match_s,
        "loaded_mb": loaded_mb,
        "peak_mb": peak_mb,
    }


def summarise(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Medians by size, the exponent over planned rooms, first use."""
    timed = {
        name: [t for r in rows if r["part"] == "size" and r["size"] == name for t in r["ms"]]
        for name in SIZES
    }
    memory = {r["size"]: r for r in rows if r["part"] == "memory"}
    ladder = [r for r in rows if r["part"] == "ladder"]
    first = next((r for r in rows if r["part"] == "first"), {})
    return {
        "median_ms": {name: float(np.median(t)) for name, t in timed.items() if t},
        "p95_ms": {name: float(np.quantile(t, 0.95)) for name, t in timed.items() if t},
        "peak_mb": {name: r["peak_mb"] for name, r in memory.items()},
        "index_and_match_mb": {name: r["peak_mb"] - r["loaded_mb"] for name, r in memory.items()},
        "index_ms": {
            name: float(np.median([r["index_ms"] for r in mine]))
            for name in SIZES
            if (mine := [r for r in rows if r["part"] == "size" and r["size"] == name])
        },
        "exponent_rooms": _exponent(ladder, "ms"),
        "exponent_index": _exponent(ladder, "index_ms"),
        "fresh_process_s": first.get("fresh_process_s"),
        "first_use_s": first.get("first_use_s"),
    }


def _exponent(ladder: list[dict[str, Any]], key: str) -> float | None:
    """Slope of the logarithm of the median time over that of the planned rooms."""
    steep = [r for r in ladder if r["planned"] >= STEEP_FROM]
    if len(steep) < 2:
        return None
    rooms = np.log([r["planned"] for r in steep])
    return float(np.polyfit(rooms, np.log([np.median(r[key]) for r in steep]), 1)[0])


def draw(result: ExperimentResult, folder: Path) -> None:
    """Time over planned rooms on logarithmic axes."""
    from situgraph.view.experiments import draw_scale

    rows = [
        {"planned": r["planned"], "ms": ms, "what": "match, 50 rooms seen"}
        for r in result.rows
        if r["part"] == "ladder"
        for ms in r["ms"]
    ]
    rows += [
        {"planned": r["planned"], "ms": r["index_ms"], "what": "index"}
        for r in result.rows
        if r["part"] == "ladder"
    ]
    names = {"x_name": "rooms of the plan", "y_name": "ms"}
    figure = draw_scale(rows, "planned", "ms", "what", title="Time of a match", **names)
    figure.savefig(folder / "scale.png", dpi=150)
