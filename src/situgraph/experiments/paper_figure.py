"""The paper's figure: solutions and time over rooms, objects and symmetry; and rooms until unique.

Layouts and samples are free of noise, as in the paper ('Synthetic dataset').
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from typing import Any, get_args

import numpy as np

from situgraph.experiments.oracle.definition import Policy
from situgraph.experiments.outcomes import Judge
from situgraph.matching import MatchResult, PlanIndex, match
from situgraph.plan.layout_config import Symmetry
from situgraph.plan.layouts import make_layout
from situgraph.plan.sample_prefix import first_rooms
from situgraph.plan.sampler import sample_online
from situgraph.scenegraph.graph import SceneGraph

PLANNED = (2, 4, 6, 8, 10, 12)
SEEN = (1, 2, 3, 4, 5, 6)
DENSITIES = (0.0, 0.1, 0.2, 0.3, 0.4)
GROWTH_ROOMS = 12
REPEATS = 3  # of which the fastest is the time of a match


def figure_tasks(seed: int, layouts: int) -> Iterator[dict[str, Any]]:
    """One task for each symmetry, semantics, plan size, rooms seen, object share and layout."""
    for symmetry in get_args(Symmetry):
        for planned in PLANNED:
            for seen in (n for n in SEEN if n <= planned):
                for density in DENSITIES:
                    for number in range(layouts):
                        for semantics in get_args(Policy):
                            yield {
                                "part": "figure",
                                "symmetry": symmetry,
                                "semantics": semantics,
                                "planned": planned,
                                "seen": seen,
                                "density": density,
                                "seed": seed + number,
                            }


def growth_tasks(seed: int, layouts: int) -> Iterator[dict[str, Any]]:
    """One task for each symmetry, semantics and layout that is explored room by room."""
    for symmetry in get_args(Symmetry):
        for semantics in get_args(Policy):
            for number in range(layouts):
                yield {
                    "part": "growth",
                    "symmetry": symmetry,
                    "semantics": semantics,
                    "seed": seed + number,
                }


def solve_figure(task: Mapping[str, Any]) -> dict[str, Any]:
    """Match one sample: solutions, time, candidates before and after the semantic stage."""
    prior = make_layout("random", task["planned"], task["seed"], task["symmetry"], task["density"])
    sample = sample_online(prior, task["seen"], task["seed"])
    index = PlanIndex(prior)
    taken = []
    for _ in range(REPEATS):
        begin = time.perf_counter()
        result = match(sample.online, index, semantics=task["semantics"])
        taken.append(time.perf_counter() - begin)
    return {
        **task,
        "ratio": task["seen"] / task["planned"],
        "object_share": object_share(prior),
        "solutions": result.count,
        "ms": 1e3 * min(taken),
        "outcome": Judge(sample, prior, task["semantics"]).outcome(result),
        **room_pairs(result),
    }


def solve_growth(task: Mapping[str, Any]) -> dict[str, Any]:
    """Explore a layout room by room until the match is unique and right."""
    prior = make_layout("random", GROWTH_ROOMS, task["seed"], task["symmetry"])
    walk = sample_online(prior, GROWTH_ROOMS, task["seed"])
    index, until, outcomes = PlanIndex(prior), None, []
    for rooms in range(1, GROWTH_ROOMS + 1):
        sample = first_rooms(walk, prior, rooms)
        result = match(sample.online, index, semantics=task["semantics"])
        outcomes.append(Judge(sample, prior, task["semantics"]).outcome(result))
        if outcomes[-1] == "right":
            until = rooms
            break
    return {**task, "rooms_until_unique": until, "wrong": outcomes.count("wrong")}


def object_share(graph: SceneGraph) -> float:
    """The share of objects among all nodes."""
    objects = len(graph.objects)
    return objects / (len(graph.rooms) + len(graph.planes) + objects)


def room_pairs(result: MatchResult) -> dict[str, int]:
    """Pairs of rooms by type, and those the semantic and the geometric stage leave."""
    return {f"pairs_{stage}": count for stage, count in result.stats["room_candidates"].items()}


def summarise_figure(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Medians by symmetry and semantics."""
    return {
        "median_solutions": _by_case(rows, lambda r: r["solutions"]),
        "median_ms": _by_case(rows, lambda r: r["ms"]),
        "success_rate": _by_case(rows, lambda r: float(r["outcome"] == "right"), np.mean),
        "candidate_reduction": _by_case(
            rows, lambda r: 1 - r["pairs_semantic"] / r["pairs_type"], np.mean
        ),
    }


def summarise_growth(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Median rooms until unique; null where most layouts never are."""
    never = GROWTH_ROOMS + 1
    medians = _by_case(rows, lambda r: r["rooms_until_unique"] or never)
    return {
        "rooms_until_unique": {
            symmetry: {name: None if n >= never else n for name, n in by.items()}
            for symmetry, by in medians.items()
        }
    }


def _by_case(
    rows: list[dict[str, Any]], value: Any, average: Any = np.median
) -> dict[str, dict[str, float]]:
    return {
        symmetry: {
            semantics: float(average([value(r) for r in group]))
            for semantics in get_args(Policy)
            if (
                group := [
                    r for r in rows if r["symmetry"] == symmetry and r["semantics"] == semantics
                ]
            )
        }
        for symmetry in get_args(Symmetry)
    }
