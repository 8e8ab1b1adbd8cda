"""Is the search complete? Against the brute force on small cases, against counting on grids."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import msgspec

from situgraph import matching
from situgraph.experiments.oracle import comparison, kept
from situgraph.experiments.oracle.answer import search
from situgraph.experiments.oracle.cases import Case, draw
from situgraph.experiments.oracle.comparison import compare
from situgraph.experiments.oracle.definition import Definition
from situgraph.experiments.oracle.grids import grid, placements
from situgraph.experiments.oracle.problem import Problem
from situgraph.experiments.oracle.verdict import judge
from situgraph.geometry.poses import Placement
from situgraph.matching import MatchingConfig, PlanIndex, match
from situgraph.scenegraph.graph import SceneGraph
from situgraph.scenegraph.transform import transformed

# Identical patterns (rows, columns) in identical plans, and whether the rooms are square.
GRIDS = (
    ((1, 1), (2, 3), False),
    ((2, 3), (3, 4), False),
    ((2, 3), (3, 4), True),
    ((2, 5), (10, 10), False),
    ((2, 5), (10, 10), True),
    ((5, 10), (20, 25), False),
    ((5, 10), (20, 25), True),
    ((5, 10), (50, 100), True),
)
FRAME = Placement(3.0, -7.0, 0.0, 0.7)


def brute_force_tasks(seed: int, cases: int) -> Iterator[dict[str, Any]]:
    """The numbered cases of ``oracle.cases``, to be answered by the brute force as it is now."""
    for number in range(seed, seed + cases):
        yield {"part": "brute force", "number": number, "sources": kept.sources()}


def solve_brute_force(task: Mapping[str, Any]) -> dict[str, Any]:
    """What the brute force finds in one case, as text."""
    online, problem = _problem(draw(task["number"]))
    found = search(problem)
    judged = judge(problem, found.candidates, found.outside)
    found = replace(found, mirrored=judged.mirrored)
    return {**task, "answer": kept.to_text(found, online, problem.prior)}


def oracle_tasks(answers: Iterable[Mapping[str, Any]]) -> Iterator[dict[str, Any]]:
    """The cases that the brute force answered, for search and comparison as they are now."""
    sources = [*Path(matching.__file__).parent.glob("*.py"), Path(comparison.__file__)]
    key = kept.sources_key(sources)
    for row in answers:
        yield {
            "part": "oracle",
            "number": row["number"],
            "search": key,
            "answer": row["answer"],
        }


def grid_tasks(full: bool) -> Iterator[dict[str, Any]]:
    """The grids; those with thousands of solutions in the full size only."""
    for pattern, plan, square in GRIDS:
        if full or plan[0] * plan[1] <= 500:
            yield {"part": "grid", "pattern": list(pattern), "plan": list(plan), "square": square}


def solve_oracle(task: Mapping[str, Any]) -> dict[str, Any]:
    """Compare the matcher and the brute force on one case."""
    case = draw(task["number"])
    online, problem = _problem(case)
    own = kept.from_text(task["answer"], online, problem.prior)
    found = compare(online, problem.prior, problem, own)
    return {
        **{name: task[name] for name in ("part", "number", "search")},
        **msgspec.to_builtins(case),
        **msgspec.to_builtins(found),
        "agrees": found.agrees,
    }


def _problem(case: Case) -> tuple[SceneGraph, Problem]:
    prior, sample = case.graphs()
    return sample.online, Problem(sample.online, prior, case.policy, Definition())


def solve_grid(task: Mapping[str, Any]) -> dict[str, Any]:
    """Count the candidates of an identical pattern."""
    pattern: tuple[int, int] = tuple(task["pattern"])
    plan: tuple[int, int] = tuple(task["plan"])
    width = 5.0 if task["square"] else 4.0
    config = MatchingConfig(rival_ratio=0.0, max_solutions=1)
    online = transformed(grid(*pattern, width), FRAME)
    result = match(online, PlanIndex(grid(*plan, width)), semantics="none", config=config)
    expected = placements(pattern, plan, task["square"], Definition())
    return {**task, "expected": expected, "found": result.count, "complete": result.complete}


def summarise_oracle(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """How many cases, and what differed in all of them."""
    return {
        "oracle_cases": len(rows),
        "oracle_candidates": sum(r["candidates"] for r in rows),
        "oracle_missed": sum(r["missed"] for r in rows),
        "oracle_invented": sum(r["invented"] for r in rows),
        "oracle_other_solutions": sum(r["unlike"] > 0 for r in rows),
        "oracle_other_verdict": sum(r["verdict"] != r["reported_verdict"] for r in rows),
        "oracle_disagreeing": [r["number"] for r in rows if not r["agrees"]],
        "oracle_incomplete": sum(not r["complete"] for r in rows),
    }


def summarise_grids(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """How many grids were counted right."""
    return {
        "grids": len(rows),
        "grids_counted_right": sum(r["expected"] == r["found"] for r in rows),
        "grid_candidates": sum(r["expected"] for r in rows),
    }
