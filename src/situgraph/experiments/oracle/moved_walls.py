"""What moved planes of one wall spare: a wall moves as one (section 4)."""

from __future__ import annotations

import math
from collections.abc import Sequence

import networkx as nx
import numpy as np

from situgraph.experiments.oracle.explained import PlanePair
from situgraph.experiments.oracle.problem import Problem


def moved_together(problem: Problem, moved: Sequence[Sequence[tuple[int, PlanePair]]]) -> float:
    """The weight of a largest spanning forest; ``moved`` holds each plane's (prior room, pair)."""
    walls: nx.Graph[int] = nx.Graph()
    for p, one in enumerate(moved):
        for q, two in enumerate(moved[:p]):
            spared = _spared(problem, one, two)
            if spared > 0:
                walls.add_edge(p, q, weight=spared)
    forest = nx.maximum_spanning_edges(walls, data=True)
    return float(sum(edge["weight"] for _, _, edge in forest))


def _spared(
    problem: Problem, one: Sequence[tuple[int, PlanePair]], two: Sequence[tuple[int, PlanePair]]
) -> float:
    c = problem.constants
    middle = np.mean([room.center for room in problem.planned], axis=0)
    normals, offsets, shifts = [], [], []
    for found in (one, two):
        a, pair = found[-1]
        room = problem.planned[a]
        normal = room.normals[pair.j]
        normals.append(normal)
        offsets.append(float(room.offsets[pair.j] + normal @ middle))
        shifts.append(float(np.mean([p.offset for _, p in found])))
    if abs(float(np.linalg.det(np.array(normals)))) > c.wall_sine:
        return 0.0
    side = math.copysign(1.0, float(normals[0] @ normals[1]))
    if abs(offsets[0] - side * offsets[1]) > c.wall_thickness:
        return 0.0
    sigma = math.sqrt(2) * c.plane_sigma
    difference = shifts[0] - side * shifts[1]
    density = math.exp(-0.5 * (difference / sigma) ** 2) / (math.sqrt(2 * math.pi) * sigma)
    alone = c.p_moved / (2 * c.moved_limit)
    return math.log((c.p_together * density + (1 - c.p_together) * alone) / alone)
