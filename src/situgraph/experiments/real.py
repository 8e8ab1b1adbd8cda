"""Experiment ``real``: logged S-Graphs and real building models.

The S-Graphs of SE1 against the plans of their building (as planned, and with walls moved), in many
frames, against the mirrored plans, and against another building's; and partial views sampled from
building models, whose rooms, walls, doors and windows are real.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, get_args

import numpy as np

from situgraph.errors import InputError
from situgraph.experiments.certificate import COVERED
from situgraph.experiments.oracle.answer import motion_of, same
from situgraph.experiments.oracle.definition import Definition, Policy
from situgraph.experiments.oracle.problem import Problem
from situgraph.experiments.outcomes import OUTCOMES, Judge, tally
from situgraph.experiments.results import ExperimentResult
from situgraph.experiments.runner import Experiment, RunOptions, run_experiment
from situgraph.geometry.poses import Placement
from situgraph.matching import MatchResult, PlanIndex, match
from situgraph.plan.sampler import Sampler
from situgraph.scenegraph.graph import SceneGraph
from situgraph.scenegraph.mirror import mirrored
from situgraph.scenegraph.transform import transformed

DATA = "../shared/data"
ROOMS = (1, 2, 3, 5, 8)
TRIALS = (20, 100)  # samples of each building, number of rooms and semantics
FRAMES = 20  # of each pair of SE1
LOGS = ("R3", "R4", "R5", "R6", "R7", "R8", "RAll")
PLANS = ("T0", "T1", "T2", "T3", "T4", "T5")
ELSEWHERE = ("R3", "R4", "R5", "R7", "R8")  # logs whose FIXed part is another building
TOLD = (
    "outcome", "solutions", "probability", "rival_share", "rival_turned_deg", "rival_rooms",
    "rival_moved", "best_moved", "moved",
)  # fmt: skip
SE1 = Placement(x=2.48)  # map to building, known to some centimetres and a degree (FACTS.md)


def run(options: RunOptions) -> ExperimentResult:
    """Compute it; with a folder also draw the bars.

    Extra parameters: ``data``, the folder with ``ifc``, ``plans`` and ``sgraphs``; ``trials``.

    Raises:
        InputError: the folder is not there.
    """
    data = Path(str(options.extra.get("data", DATA)))
    if not data.is_dir():
        raise InputError(data, "no such folder", "name it with --extra data=FOLDER")
    trials = int(options.extra.get("trials", TRIALS[options.full]))
    tasks = [*se1_tasks(data, options.seed), *model_tasks(data, options.seed, trials)]
    result = run_experiment(
        Experiment("real", tasks, solve, summarise, options.seed, revision=3), options
    )
    if options.folder is not None:
        draw(result, options.folder)
    return result


def se1_tasks(data: Path, seed: int) -> Iterator[dict[str, Any]]:
    """Each log with each plan, with each mirrored plan, and with the other building's."""
    base = {"data": str(data), "seed": seed}
    for log in LOGS:
        for plan in PLANS:
            for semantics in get_args(Policy):
                yield {**base, "part": "SE1", "log": log, "plan": plan, "semantics": semantics}
            yield {
                **base, "part": "SE1 mirrored", "log": log, "plan": plan, "semantics": "likelihood",
            }  # fmt: skip
    for log in ELSEWHERE:
        yield {
            **base, "part": "SE1 in another building", "log": log, "plan": log,
            "semantics": "likelihood",
        }  # fmt: skip


def model_tasks(data: Path, seed: int, trials: int) -> Iterator[dict[str, Any]]:
    """Each building model, number of rooms seen and semantics."""
    for path in [*sorted(data.glob("ifc/*.ifc")), *sorted(data.glob("plans/*.osm"))]:
        for rooms in ROOMS:
            for semantics in get_args(Policy):
                yield {
                    "part": "model", "data": str(data), "file": str(path.relative_to(data)),
                    "rooms": rooms, "semantics": semantics, "trials": trials, "seed": seed,
                }  # fmt: skip


def solve(task: Mapping[str, Any]) -> dict[str, Any]:
    """One row of whatever part the task belongs to."""
    return _solve_model(task) if task["part"] == "model" else _solve_se1(task)


def _solve_se1(task: Mapping[str, Any]) -> dict[str, Any]:
    """One log with one plan, as logged and in random frames."""
    online, prior = _se1_graphs(task)
    rng = np.random.default_rng([task["seed"], LOGS.index(task["log"])])
    index = PlanIndex(prior)
    has_truth = task["part"] == "SE1"
    found = []
    for number in range(1 + (FRAMES if task["semantics"] == "likelihood" else 0)):
        x, y, z = rng.uniform(-30.0, 30.0, 3)
        yaw = rng.uniform(-math.pi, math.pi)
        frame = Placement(x, y, z, yaw) if number else Placement()
        moved = transformed(online, frame)
        result = match(moved, index, semantics=task["semantics"])
        problem = Problem(moved, prior, task["semantics"], Definition())
        truth = motion_of(problem, SE1.compose(frame.inverse()))
        ranks = [
            k
            for k, solution in enumerate(result.solutions)
            if has_truth and same(problem, motion_of(problem, solution.transform), truth)
        ]
        outcome = result.verdict if not result.unique else "right" if ranks == [0] else "wrong"
        found.append((str(outcome), ranks[0] if ranks else None, result))
    logged = found[0][2]
    best = logged.best
    return {
        "part": task["part"], "log": task["log"], "plan": task["plan"], "seed": task["seed"],
        "semantics": task["semantics"], "rooms": len(problem.seen),
        "outcome": found[0][0], "true_rank": found[0][1], "solutions": logged.count,
        "frames": len(found) - 1,
        "frames_alike": sum(other[:2] == found[0][:2] for other in found[1:]),
        "probability": best.probability if best else None,
        "probability_outside": logged.probability_outside, "reason": logged.reason,
        "deviations": len(best.deviations) if best else 0, **_told(logged),
    }  # fmt: skip


def _told(result: MatchResult) -> dict[str, Any]:
    """Which walls of the plan the best solution finds moved, and what the next best is worth."""
    best, rival = result.best, result.candidate(1)
    if best is None:
        return {}
    moved = {best.planes[d.plane]: d.offset for d in best.deviations if d.plane in best.planes}
    told: dict[str, Any] = {
        "moved": ", ".join(f"{wall} {offset:+.2f} m" for wall, offset in sorted(moved.items()))
    }
    if rival is not None:
        turned = rival.transform.yaw - best.transform.yaw
        told |= {
            "rival_share": rival.probability / best.probability,
            "rival_turned_deg": abs(math.degrees(math.remainder(turned, 2 * math.pi))),
            "rival_rooms": len(rival.rooms), "rival_moved": rival.moved, "best_moved": best.moved,
        }  # fmt: skip
    return told


def _se1_graphs(task: Mapping[str, Any]) -> tuple[SceneGraph, SceneGraph]:
    from situgraph.io.g2o import read_g2o

    folder = Path(task["data"]) / "sgraphs" / "SE1"
    online = read_g2o(folder / "S-Graphs" / task["log"] / "graph.g2o", "free")
    if task["part"] == "SE1 in another building":
        return online, read_g2o(folder / "S-Graphs" / task["plan"] / "graph.g2o", "fixed")
    prior = read_g2o(folder / "A-Graphs" / task["plan"] / "graph.g2o", "fixed")
    return online, mirrored(prior) if task["part"] == "SE1 mirrored" else prior


def _solve_model(task: Mapping[str, Any]) -> dict[str, Any]:
    """Partial views of one building model."""
    from situgraph.api import read_plan

    prior = read_plan(Path(task["data"]) / task["file"])
    sampler, index = Sampler(prior, COVERED), PlanIndex(prior)
    outcomes = []
    for number in range(task["trials"]):
        sample = sampler.sample(task["rooms"], task["seed"] + number)
        result = match(sample.online, index, semantics=task["semantics"])
        judge = Judge(sample, prior, task["semantics"])
        outcomes.append({
            "seed": task["seed"] + number, "outcome": judge.outcome(result),
            "admissible": judge.admissible(result), "solutions": result.count,
        })  # fmt: skip
    covered = [o for o in outcomes if o["admissible"]]
    return {
        "part": "model", "building": Path(task["file"]).stem, "rooms": task["rooms"],
        "semantics": task["semantics"], "planned": len(prior.rooms), **tally(outcomes),
        "admissible": len(covered),
        "admissible_wrong": sum(o["outcome"] == "wrong" for o in covered),
        "wrong_seeds": [o["seed"] for o in outcomes if o["outcome"] == "wrong"],
        "median_solutions": float(np.median([o["solutions"] for o in outcomes])),
    }  # fmt: skip


def summarise(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """By building, then by rooms seen and semantics: how often right, ambiguous, none, wrong."""
    summary: dict[str, dict[str, Any]] = {}
    for row in rows:
        name = row["building"] if row["part"] == "model" else row["part"]
        case = summary.setdefault(name, {}).setdefault(
            f"{row['rooms']} {row['semantics']}", dict.fromkeys(OUTCOMES, 0)
        )
        if row["part"] == "model":
            case |= {key: row[key] for key in (*OUTCOMES, "admissible", "admissible_wrong")}
            continue
        case[row["outcome"]] += 1
        case["truth_among_solutions"] = case.get("truth_among_solutions", 0) + (
            row["true_rank"] is not None
        )
        case["frames"] = case.get("frames", 0) + row["frames"]
        case["frames_alike"] = case.get("frames_alike", 0) + row["frames_alike"]
        if row["part"] == "SE1" and row["semantics"] == "likelihood":
            pairs = summary.setdefault("SE1 by pair", {})
            pairs[f"{row['log']} x {row['plan']}"] = {key: row[key] for key in TOLD if key in row}
    return summary


def draw(result: ExperimentResult, folder: Path) -> None:
    """Outcomes as bars: one drawing for each semantics."""
    from situgraph.view.experiments import draw_outcomes

    for semantics in get_args(Policy):
        cases = {
            f"{building}, {case.split()[0]} rooms": counts
            for building, by in result.summary.items()
            for case, counts in by.items()
            if "outcome" not in counts and case.endswith(f" {semantics}")
        }
        figure = draw_outcomes(cases, title=f"Real buildings, {semantics}")
        figure.savefig(folder / f"real-{semantics}.png", dpi=150, bbox_inches="tight")
