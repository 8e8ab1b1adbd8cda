"""Experiment ``robustness``: verdicts when maps, plans or detections are wrong.

Each case draws buildings of all kinds and a robot that errs in one way, or in all at once. Trials
in which the truth is no candidate under the printed model are counted apart (``admissible``).
"""

from __future__ import annotations

import math
import typing
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from situgraph.errors import InputError
from situgraph.experiments.oracle.definition import Policy
from situgraph.experiments.outcomes import Judge, tally
from situgraph.experiments.results import ExperimentResult
from situgraph.experiments.runner import Experiment, RunOptions, run_experiment
from situgraph.matching import MatchingConfig, PlanIndex, match
from situgraph.plan.layout_config import Kind
from situgraph.plan.layouts import make_layout
from situgraph.plan.sampler import sample_online
from situgraph.plan.sampler_config import (
    PAPER_DETECTOR,
    REALISTIC,
    DetectionRates,
    SamplerConfig,
)

TRIALS = (100, 1_000)
NOISE = SamplerConfig(
    plane_offset_sigma=0.03,
    plane_yaw_sigma=math.radians(0.3),
    plane_tilt_sigma=math.radians(0.3),
    center_sigma=0.05,
    object_sigma=0.1,
)
DETECTOR = {
    name: msgspec.structs.replace(rates, duplicated=0.03) for name, rates in PAPER_DETECTOR.items()
}
ALL_KNOWN = typing.get_args(Kind)


class Case(msgspec.Struct, frozen=True, kw_only=True):
    """How the robot errs, what it has seen, how it is matched."""

    errors: SamplerConfig
    semantics: Policy = "none"
    seen: tuple[int, ...] = (3, 4, 6, 8, 10)
    planned: int = 24
    kinds: tuple[Kind, ...] = ALL_KNOWN


def _noise(**changes: Any) -> SamplerConfig:
    return msgspec.structs.replace(NOISE, **changes)


CASES: Mapping[str, Case] = {
    "clean": Case(errors=SamplerConfig()),
    "noise 3 cm": Case(errors=NOISE),
    "10 % of planes missing": Case(errors=_noise(missing_planes=0.1)),
    "10 % false rooms": Case(errors=_noise(false_rooms=0.1)),
    "5 % of walls moved up to 0.4 m": Case(errors=_noise(moved_walls=0.05)),
    "15 % of walls moved up to 0.4 m": Case(errors=_noise(moved_walls=0.15)),
    "drift 2 deg in 50 m": Case(errors=_noise(drift=math.radians(2) / 50)),
    "all of these": Case(errors=REALISTIC),
    "all of these, likelihood": Case(
        errors=msgspec.structs.replace(REALISTIC, detection=DETECTOR), semantics="likelihood"
    ),
    **{
        f"all of these, {rooms} rooms": Case(errors=REALISTIC, seen=(rooms,), planned=4 * rooms)
        for rooms in (20, 50)
    },
    "beyond the model: noise 8 cm": Case(errors=_noise(plane_offset_sigma=0.08)),
    "beyond the model: drift 6 deg in 50 m": Case(errors=_noise(drift=math.radians(6) / 50)),
    "beyond the model: walls moved 0.4 to 0.8 m": Case(
        errors=_noise(moved_walls=0.1, moved_min=0.4, moved_max=0.8)
    ),
    "beyond the model: detector errs three times as often": Case(
        errors=msgspec.structs.replace(
            REALISTIC,
            detection_default=DetectionRates(
                missed=0.25, false=0.12, duplicated=0.1, confused=0.06, wrong_wall=0.15
            ),
        ),
        semantics="likelihood",
    ),
    **{
        f"detector of the paper, 3 % duplicates, {rooms} rooms, {semantics}": Case(
            errors=SamplerConfig(detection=DETECTOR, object_sigma=0.1),
            semantics=semantics,
            seen=(rooms,),
            planned=60,
            kinds=("random",),
        )
        for rooms in (1, 6, 10, 20, 50)
        for semantics in ("likelihood", "containment")
    },
}
# Lists every candidate, however improbable.
ALL = MatchingConfig(rival_ratio=0.0, outside_prior=1e-300, max_solutions=100_000)


def run(options: RunOptions) -> ExperimentResult:
    """Compute it; with a folder also draw the bars.

    Extra parameters: ``trials`` (for each case), ``case`` (one alone).

    Raises:
        InputError: there is no such case.
    """
    trials = int(options.extra.get("trials", TRIALS[options.full]))
    wanted = options.extra.get("case")
    if wanted is not None and wanted not in CASES:
        remedy = f"take one of: {' | '.join(CASES)}"
        raise InputError("--extra case", f"there is no case {wanted!r}", remedy)
    tasks = [
        {"case": case, "number": number, "seed": options.seed + number}
        for case in CASES
        if wanted in (None, case)
        for number in range(trials)
    ]
    experiment = Experiment("robustness", tasks, solve, summarise, options.seed)
    result = run_experiment(experiment, options)
    if options.folder is not None:
        draw(result, options.folder)
    return result


def solve(task: Mapping[str, Any]) -> dict[str, Any]:
    """One trial of one case."""
    case = CASES[task["case"]]
    rng = np.random.default_rng([task["seed"], 3])
    kind: Kind = str(rng.choice(case.kinds))  # type: ignore[assignment]
    seen = int(rng.choice(case.seen))
    prior = make_layout(kind, case.planned, task["seed"])
    sample = sample_online(prior, seen, task["seed"], case.errors)
    index = PlanIndex(prior)
    result = match(sample.online, index, semantics=case.semantics)
    listed = match(sample.online, index, semantics=case.semantics, config=ALL)
    judge = Judge(sample, prior, case.semantics)
    return {
        **task,
        "kind": kind,
        "seen": seen,
        "rooms": result.stats["rooms_online"],
        "outcome": judge.outcome(result),
        "admissible": judge.admissible(result, listed),
        "candidate": judge.true_rank(listed) is not None,
        "solution": judge.true_rank(result) is not None,
        "contained": judge.contained(),
        "solutions": result.count,
        "complete": listed.complete,
    }


def summarise(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Outcomes by case over all trials, and what holds for the admissible ones."""
    summary = {}
    for case in dict.fromkeys(r["case"] for r in rows):
        mine = [r for r in rows if r["case"] == case]
        covered = [r for r in mine if r["admissible"]]
        summary[case] = {
            **tally(mine),
            "admissible": len(covered),
            "admissible_wrong": sum(r["outcome"] == "wrong" for r in covered),
            "truth_among_candidates": _share(covered, "candidate"),
            "truth_among_solutions": _share(covered, "solution"),
            "truth_survives": _share(mine, "solution"),
            "all_pairs_contained": _share(mine, "contained"),
        }
    return summary


def _share(rows: list[dict[str, Any]], key: str) -> float | None:
    return sum(bool(r[key]) for r in rows) / len(rows) if rows else None


def draw(result: ExperimentResult, folder: Path) -> None:
    """Outcomes as bars, a bar for each case."""
    from situgraph.view.experiments import draw_outcomes

    figure = draw_outcomes(result.summary, title="Verdicts when something is wrong")
    figure.savefig(folder / "outcomes.png", dpi=150, bbox_inches="tight")
