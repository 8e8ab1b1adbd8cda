"""What moved planes of one wall spare: a wall moves as one (section 4)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import networkx as nx

from situgraph.experiments.oracle.explained import PlanePair
from situgraph.experiments.oracle.problem import Problem


def moved_together(problem: Problem, moved: Sequence[Sequence[tuple[int, PlanePair]]]) -> float:
    """The weight of a largest spanning forest; ``moved`` holds each plane's (prior room, pair)."""
    faces = [_face(problem, found) for found in moved]
    walls: nx.Graph[int] = nx.Graph()
    for p, one in enumerate(faces):
        for q, two in enumerate(faces[:p]):
            spared = _spared(problem, one, two)
            if spared > 0:
                walls.add_edge(p, q, weight=spared)
    if not walls:
        return 0.0
    forest = nx.maximum_spanning_edges(walls, data=True)
    return float(sum(edge["weight"] for _, _, edge in forest))


class _Face(NamedTuple):
    """A moved plane: the line where it is planned, and how far it was moved."""

    normal: tuple[float, float]
    offset: float
    shift: float


def _face(problem: Problem, found: Sequence[tuple[int, PlanePair]]) -> _Face:
    a, pair = found[-1]
    assert pair.j is not None
    normal, offset = problem.planned_lines[a][pair.j]
    return _Face(normal, offset, sum(p.offset for _, p in found) / len(found))


def _spared(problem: Problem, one: _Face, two: _Face) -> float:
    c = problem.constants
    (x, y), (u, v) = one.normal, two.normal
    if abs(x * v - y * u) > c.wall_sine:
        return 0.0
    side = math.copysign(1.0, x * u + y * v)
    if abs(one.offset - side * two.offset) > c.wall_thickness:
        return 0.0
    sigma = math.sqrt(2) * problem.sigma
    difference = one.shift - side * two.shift
    density = math.exp(-0.5 * (difference / sigma) ** 2) / (math.sqrt(2 * math.pi) * sigma)
    alone = c.p_moved / (2 * c.moved_limit)
    return math.log((c.p_together * density + (1 - c.p_together) * alone) / alone)
