"""Experiment ``advice``: does the advice of an ambiguous match lead to a unique one sooner?

A robot in a building of like rooms has seen one room and may be in several places. It goes on
through doors until the match is unique: once through the door that the advice names, once through
any. Both see the same rooms with the same errors.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import msgspec
import numpy as np

from situgraph.experiments.certificate import COVERED
from situgraph.experiments.outcomes import Judge
from situgraph.experiments.results import ExperimentResult
from situgraph.experiments.runner import Experiment, RunOptions, run_experiment
from situgraph.matching import MatchResult, PlanIndex, match
from situgraph.matching.matcher import Semantics
from situgraph.matching.predictions import entrances
from situgraph.plan.layout_config import Kind
from situgraph.plan.layouts import make_layout
from situgraph.plan.sample_prefix import first_rooms
from situgraph.plan.sample_truth import OnlineSample
from situgraph.plan.sampler import sample_online

TRIALS = (100, 500)
PLANNED = 24  # rooms
MOST_FURTHER = 8  # rooms after which a robot gives up
ATTEMPTS = 40  # samples looked at for one that is ambiguous after its first room
BESIDE = 0.3  # metres by which the advice may miss the room that is meant
KINDS: tuple[Kind, ...] = ("modular", "corridor", "wings")
# Errors the model covers; no drift and no false rooms, which belong to the way that is walked.
ERRORS = msgspec.structs.replace(COVERED, drift=0.0, false_rooms=0.0)


def run(options: RunOptions) -> ExperimentResult:
    """Compute it.

    Extra parameter: ``trials``.
    """
    trials = int(options.extra.get("trials", TRIALS[options.full]))
    tasks = [
        {"kind": KINDS[n % len(KINDS)], "semantics": semantics, "seed": options.seed + n}
        for n in range(trials)
        for semantics in ("none", "likelihood")
    ]
    return run_experiment(Experiment("advice", tasks, solve, summarise, options.seed), options)


def solve(task: Mapping[str, Any]) -> dict[str, Any]:
    """One robot, twice."""
    for attempt in range(ATTEMPTS):
        seed = 1_000 * task["seed"] + attempt
        prior = make_layout(task["kind"], PLANNED, seed, "local")
        sample, index = sample_online(prior, PLANNED, seed, ERRORS), PlanIndex(prior)
        robot = Robot(sample, index, task["semantics"])
        first = sample.truth.order[:1]
        start = robot.look(first)
        if start.verdict == "ambiguous" and robot.judge(first).true_rank(start) is not None:
            break
    else:
        return {**task, "ambiguous": 0}
    ways = {
        way: robot.explore(start, way, np.random.default_rng([seed, 3]))
        for way in ("advice", "random")
    }
    row: dict[str, Any] = {**task, "ambiguous": start.count}
    for way, (rooms, outcome) in ways.items():
        row |= {f"{way}_rooms": rooms, f"{way}_outcome": outcome}
    return row


class Robot:
    """Explores a building room by room; its map is a part of one sample of all rooms."""

    def __init__(self, sample: OnlineSample, index: PlanIndex, semantics: Semantics) -> None:
        self._sample, self._index, self._semantics = sample, index, semantics

    def look(self, rooms: tuple[str, ...]) -> MatchResult:
        """The match of these online rooms."""
        return match(self._part(rooms).online, self._index, semantics=self._semantics)

    def judge(self, rooms: tuple[str, ...]) -> Judge:
        """Who knows where these rooms are."""
        return Judge(self._part(rooms), self._index.prior, self._semantics)

    def explore(self, result: MatchResult, way: str, rng: np.random.Generator) -> tuple[int, str]:
        """How many further rooms until the match is unique, and whether it is right."""
        rooms = self._sample.truth.order[:1]
        for further in range(1, MOST_FURTHER + 1):
            doors = self._doors(rooms)
            if not doors:
                return MOST_FURTHER, "enclosed"
            chosen = self._advised(result, doors) if way == "advice" else None
            if chosen is None:
                chosen = doors[int(rng.integers(len(doors)))]
            rooms = (*rooms, chosen)
            result = self.look(rooms)
            if result.unique:
                return further, self.judge(rooms).outcome(result)
        return MOST_FURTHER, result.verdict

    def _part(self, rooms: tuple[str, ...]) -> OnlineSample:
        truth = self._sample.truth
        rest = tuple(r for r in truth.order if r not in rooms)
        turned = msgspec.structs.replace(truth, order=(*rooms, *rest))
        whole = OnlineSample(self._sample.online, turned)
        return first_rooms(whole, self._index.prior, len(rooms))

    def _doors(self, rooms: tuple[str, ...]) -> list[str]:
        """The online rooms not seen yet into which there is a way."""
        truth, prior = self._sample.truth, self._index.prior
        online = {theirs: mine for mine, theirs in truth.rooms.items()}
        beyond = {
            online.get(other.id)
            for mine in rooms
            for _, _, other in entrances(prior, prior.room_by_id[truth.rooms[mine]])
        }
        return sorted(r for r in beyond if r is not None and r not in rooms)

    def _advised(self, result: MatchResult, doors: list[str]) -> str | None:
        """The room that one gets into where the first advice that leads into one says."""
        for item in result.advice:
            if item.kind == "room":
                x, y, z = self._sample.truth.placement.points(np.array([*item.place, 0.0]))
                inside = [d for d in doors if self._depth(d, (x, y, z)) > -BESIDE]
                if inside:
                    return max(inside, key=lambda d: self._depth(d, (x, y, z)))
        return None

    def _depth(self, room: str, point: tuple[float, float, float]) -> float:
        """How far a point of the building lies inside the walls of an online room's true room."""
        prior = self._index.prior
        true = prior.room_by_id[self._sample.truth.rooms[room]]
        normals, offsets = prior.plane_arrays(true.planes)
        level = np.array([point[0], point[1], true.center[2]])
        return float((normals @ level + offsets).min())


def summarise(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Further rooms until unique, by semantics: with the advice and without."""
    summary = {}
    for semantics in dict.fromkeys(r["semantics"] for r in rows):
        mine = [r for r in rows if r["semantics"] == semantics and r["ambiguous"]]
        if not mine:
            continue
        rooms = {w: np.array([r[f"{w}_rooms"] for r in mine]) for w in ("advice", "random")}
        summary[semantics] = {
            "trials": len(mine),
            **{f"mean_rooms_{w}": float(n.mean()) for w, n in rooms.items()},
            **{f"found_{w}": sum(r[f"{w}_outcome"] == "right" for r in mine) for w in rooms},
            **{f"wrong_{w}": sum(r[f"{w}_outcome"] == "wrong" for r in mine) for w in rooms},
            "sooner": int((rooms["advice"] < rooms["random"]).sum()),
            "later": int((rooms["advice"] > rooms["random"]).sum()),
        }
    return summary
