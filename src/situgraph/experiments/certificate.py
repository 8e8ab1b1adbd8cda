"""How far can 'unique' and a probability be trusted: trials, foreign and mirrored buildings."""

from __future__ import annotations

import math
import typing
from collections import Counter
from collections.abc import Iterator, Mapping
from typing import Any

import msgspec
import numpy as np

from situgraph.experiments.outcomes import Judge, tally
from situgraph.matching import MatchingConfig, MatchResult, PlanIndex, match
from situgraph.plan.layout_config import Kind
from situgraph.plan.layouts import make_layout
from situgraph.plan.sample_truth import OnlineSample
from situgraph.plan.sampler import sample_online
from situgraph.plan.sampler_config import REALISTIC, DetectionRates, SamplerConfig
from situgraph.scenegraph.graph import SceneGraph
from situgraph.scenegraph.mirror import mirrored

# The errors the model of the matcher covers, and errors well beyond it.
COVERED = msgspec.structs.replace(
    REALISTIC,
    detection_default=DetectionRates(
        missed=0.08, false=0.04, duplicated=0.03, confused=0.02, wrong_wall=0.05
    ),
)
BEYOND = msgspec.structs.replace(
    COVERED,
    plane_offset_sigma=0.05,
    plane_yaw_sigma=math.radians(1.0),
    moved_walls=0.15,
    drift=math.radians(5.0) / 50.0,
    detection_default=DetectionRates(
        missed=0.2, false=0.15, duplicated=0.1, confused=0.05, wrong_wall=0.1
    ),
)
# Detection errors and drift beyond the model, walls as it has them.
ASTRAY = msgspec.structs.replace(
    COVERED, drift=BEYOND.drift, detection_default=BEYOND.detection_default
)
ERRORS: dict[str, SamplerConfig] = {"covered": COVERED, "astray": ASTRAY, "beyond": BEYOND}
LISTED = 20  # solutions of a trial whose probabilities are kept
STRICTER = (0.999, 0.9999)  # than the 0.99 from which on a single solution is unique
FOREIGN_SHARE = 0.01  # the definition's prior for 'not in this plan'
# Walls that differ less than this are the same to a robot whose walls are 3 to 6 cm off.
EXACT = MatchingConfig(min_share=1.0, plane_offset_tolerance=0.1, moved_limit=0.101, part_rooms=0)


def trial_tasks(seed: int, trials: int, errors: str) -> Iterator[dict[str, Any]]:
    """Random buildings of all kinds and sizes; of the covered ones a hundredth are foreign."""
    return ({"part": "trial", "errors": errors, "seed": seed + n} for n in range(trials))


def cross_tasks(seed: int, pairs: int) -> Iterator[dict[str, Any]]:
    """A robot from another building of the same kind, and from the mirrored one.

    Large maps are bent, so they may be placed in parts.
    """
    kinds = typing.get_args(Kind)
    for part, planned, rooms in (
        ("foreign", 12, (3, 4, 6, 8)),
        ("mirrored", 12, (3, 4, 6, 8)),
        ("foreign_large", 60, (12, 16, 20, 30)),
        ("mirrored_large", 60, (12, 16, 20, 30)),
    ):
        for number in range(pairs):
            for semantics in ("none", "likelihood"):
                yield {
                    "part": part,
                    "kind": kinds[number % len(kinds)],
                    "planned": planned,
                    "seen": rooms[number // len(kinds) % 4],
                    "semantics": semantics,
                    "seed": seed + number,
                }


def solve_trial(task: Mapping[str, Any]) -> dict[str, Any]:
    """One random building, seen in part, matched with itself (or rarely with another)."""
    rng = np.random.default_rng([task["seed"], 7])
    kind: Kind = str(rng.choice(typing.get_args(Kind)))  # type: ignore[assignment]
    symmetry = rng.choice(["none", "none", "none", "local", "global"])
    planned = int(rng.integers(4, 41))
    seen = int(rng.integers(1, min(10, planned) + 1))
    semantics = str(rng.choice(["none", "likelihood"]))
    foreign = bool(rng.random() < FOREIGN_SHARE)
    building = make_layout(kind, planned, 2 * task["seed"], str(symmetry))  # type: ignore[arg-type]
    sample = sample_online(building, seen, task["seed"], ERRORS[task["errors"]])
    prior = make_layout(kind, planned, 2 * task["seed"] + 1) if foreign else building
    index = PlanIndex(prior)
    result = match(sample.online, index, semantics=semantics)  # type: ignore[arg-type]
    judge = Judge(sample, prior, semantics)  # type: ignore[arg-type]
    outcome = judge.outcome(result)
    if foreign and outcome == "right":
        outcome = "wrong"  # another building has no right place
    return {
        **task,
        "kind": kind,
        "symmetry": str(symmetry),
        "planned": planned,
        "seen": seen,
        "rooms": result.stats["rooms_online"],
        "semantics": semantics,
        "foreign": foreign,
        "congruent": foreign and congruent(sample, building, index),
        "admissible": not foreign and judge.admissible(result),
        "outcome": outcome,
        "rooms_right": judge.rooms_right(result),
        "aside": judge.is_aside(result),
        "certified": result.certified,
        "complete": result.complete,
        "said": _said(result, judge, foreign),
        "probability_outside": result.probability_outside,
    }


def _said(result: MatchResult, judge: Judge, foreign: bool) -> list[list[float]]:
    """Probability and truth of each of the first solutions."""
    listed = result.solutions[:LISTED]
    return [[s.probability, float(not foreign and judge.is_right(s))] for s in listed]


def solve_cross(task: Mapping[str, Any]) -> dict[str, Any]:
    """A robot where the plan is not that of its building."""
    building = make_layout(task["kind"], task["planned"], 2 * task["seed"])
    if task["part"].startswith("mirrored"):
        prior = mirrored(building)
    else:
        prior = make_layout(task["kind"], task["planned"], 2 * task["seed"] + 1)
    index = PlanIndex(prior)
    sample = sample_online(building, task["seen"], task["seed"], COVERED)
    result = match(sample.online, index, semantics=task["semantics"])
    return {
        **task,
        "outcome": result.verdict,
        "probability_outside": result.probability_outside,
        "congruent": congruent(sample, building, index),
    }


def share_tasks(seed: int, cases: int) -> Iterator[dict[str, Any]]:
    """Six of twelve rooms, in layouts without symmetry: how many must end unique?"""
    for kind in ("random", "modular"):
        for number in range(cases):
            for semantics in ("none", "likelihood"):
                yield {"part": "share", "kind": kind, "semantics": semantics, "seed": seed + number}


def solve_share(task: Mapping[str, Any]) -> dict[str, Any]:
    """One building and a robot that has seen half of it."""
    building = make_layout(task["kind"], 12, task["seed"])
    sample = sample_online(building, 6, task["seed"], COVERED)
    result = match(sample.online, PlanIndex(building), semantics=task["semantics"])
    return {**task, "outcome": Judge(sample, building, task["semantics"]).outcome(result)}


def summarise_share(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """The share of right and unique answers, by kind and semantics."""
    share: dict[str, dict[str, float]] = {}
    for kind, semantics in sorted({(r["kind"], r["semantics"]) for r in rows}):
        mine = [r for r in rows if (r["kind"], r["semantics"]) == (kind, semantics)]
        right = sum(r["outcome"] == "right" for r in mine)
        share.setdefault(kind, {})[semantics] = right / len(mine)
    wrong = sum(r["outcome"] == "wrong" for r in rows)
    return {"unique_6x12": share, "unique_6x12_wrong": wrong, "unique_6x12_cases": len(rows)}


def congruent(sample: OnlineSample, building: SceneGraph, index: PlanIndex) -> bool:
    """Whether the walls that were seen and not moved, as planned, are part of the plan."""
    exact = _as_planned(sample, building)
    found = match(exact, index, semantics="none", config=EXACT).solutions
    seen = {p for room in exact.rooms for p in room.planes}
    return any(len(s.planes) == len(seen) for s in found)


def _as_planned(sample: OnlineSample, building: SceneGraph) -> SceneGraph:
    """The rooms of the building that were seen, each with the walls that were seen in place.

    A wall that was moved is in no plan, and a room with less than two others tells nothing.
    """
    truth, rooms = sample.truth, []
    moved = {m.prior for m in truth.moved}
    for mine, theirs in truth.rooms.items():
        planned = building.room_by_id[theirs]
        seen = {truth.planes.get(p) for p in sample.online.room_by_id[mine].planes}
        walls = tuple(p for p in planned.planes if p in seen and p not in moved)
        if len(walls) > 1:
            rooms.append(msgspec.structs.replace(planned, planes=walls))
    return building.replace(rooms=tuple(rooms), objects=())


def summarise_trials(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Wrongly unique in trials that the printed model covers, and in those beyond it.

    ``displaced`` are those wrong ones whose rooms are all right (more than 0.3 m off, that is),
    ``aside`` those right ones that are true for the rooms they explain and, as the map is bent,
    more than 0.3 m off the best fit over all rooms. ``expected_wrong`` is what the stated
    probabilities of the unique ones add up to; ``from_0.999`` and the like are what would be left
    of the right and wrong ones if a solution had to be so probable. Foreign robots that saw walls
    which the plan has as well (``congruent``) are counted apart.
    """
    summary = {}
    for errors in ERRORS:
        mine = [r for r in rows if r["errors"] == errors and not r["foreign"]]
        covered = [r for r in mine if r["admissible"]]
        away = [r for r in rows if r["errors"] == errors and r["foreign"]]
        summary[f"trials_{errors}"] = {
            **tally(covered),
            "displaced": sum(r["outcome"] == "wrong" and r["rooms_right"] for r in covered),
            "aside": sum(r["outcome"] == "right" and r["aside"] for r in covered),
            "inadmissible": tally(r for r in mine if not r["admissible"]),
            "foreign": tally(r for r in away if not r["congruent"]),
            "congruent": tally(r for r in away if r["congruent"]),
            "certified_wrong": sum(r["certified"] and r["outcome"] == "wrong" for r in covered),
            "expected_wrong": sum(
                1.0 - r["said"][0][0] for r in covered if r["outcome"] in ("right", "wrong")
            ),
            **{f"from_{least}": _from(least, covered) for least in STRICTER},
        }
    return summary


def _from(least: float, rows: list[dict[str, Any]]) -> dict[str, int]:
    """How many unique answers with at least this probability are right and wrong."""
    sure = [r for r in rows if r["said"] and r["said"][0][0] >= least]
    return {name: sum(r["outcome"] == name for r in sure) for name in ("right", "wrong")}


def summarise_cross(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Verdicts by what the plan is and by semantics; congruent ones apart."""
    summary: dict[str, Any] = {}
    for row in rows:
        by = summary.setdefault(row["part"], {}).setdefault(row["semantics"], Counter())
        by["trials"] += 1
        by["congruent" if row["congruent"] else row["outcome"]] += 1
    return {part: {s: dict(c) for s, c in by.items()} for part, by in summary.items()}


def statements(rows: list[dict[str, Any]]) -> list[dict[str, float]]:
    """What was said of each solution in the covered trials, and whether it was so."""
    return [
        {"probability": p, "right": right}
        for row in rows
        if row["errors"] == "covered"
        for p, right in row["said"]
    ]
