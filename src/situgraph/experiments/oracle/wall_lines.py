"""Rooms stand wall to wall: how many of their walls' places another room predicts (section 4)."""

from __future__ import annotations

import itertools

import networkx as nx
import numpy as np

from situgraph.experiments.oracle.problem import Problem
from situgraph.geometry.poses import Array, wrap_angle

Wall = tuple[int, int]  # online room, its plane


def tied(problem: Problem) -> int:
    """By how much the sets of walls that stand fast together get fewer as rooms are tied."""
    lines: nx.Graph[Wall] = nx.Graph()
    walls = [(r, i) for r, room in enumerate(problem.seen) for i in range(len(room.planes))]
    lines.add_nodes_from(walls)
    pairs = [p for p in itertools.combinations(walls, 2) if _parallel(problem, *p)]
    lines.add_edges_from((one, two) for one, two in pairs if one[0] == two[0])
    apart = nx.number_connected_components(lines)
    lines.add_edges_from(
        (one, two) for one, two in pairs if one[0] != two[0] and _on_one_line(problem, one, two)
    )
    return int(apart - nx.number_connected_components(lines))


def _direction(problem: Problem, wall: Wall) -> float:
    return float(problem.seen[wall[0]].angles[wall[1]])


def _parallel(problem: Problem, one: Wall, two: Wall) -> bool:
    turn = abs(float(wrap_angle(2 * (_direction(problem, one) - _direction(problem, two))))) / 2
    return turn <= problem.constants.angle_tolerance


def _on_one_line(problem: Problem, one: Wall, two: Wall) -> bool:
    """Whether two parallel faces are in line, or back to back with a wall's thickness between."""
    c = problem.constants
    middle = (problem.seen[one[0]].center + problem.seen[two[0]].center) / 2
    mine, theirs = _depth(problem, one, middle), _depth(problem, two, middle)
    if np.cos(_direction(problem, one) - _direction(problem, two)) > 0:
        return abs(mine - theirs) <= c.fit_limit
    return -c.fit_limit <= -(mine + theirs) <= c.wall_thickness


def _depth(problem: Problem, wall: Wall, point: Array) -> float:
    """How far a point of the map lies in front of a wall, metres."""
    room, angle = problem.seen[wall[0]], _direction(problem, wall)
    normal = np.array([np.cos(angle), np.sin(angle)])
    return float(room.distances[wall[1]] + normal @ (point - room.center))
