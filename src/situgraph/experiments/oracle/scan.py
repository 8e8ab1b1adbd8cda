"""Every feasible placement, up to its correspondences: a grid of yaws, at each yaw all vertices.

At a fixed yaw each tolerance is a strip of the plane, so what is explained changes only across
lines and every feasible region has a vertex where two of them cross. All vertices are tried.
Bounding boxes only save work: a vertex of a feasible region lies in the boxes of at least K rooms.

A first grid of yaws is coarse, with boxes grown by what the centres can move up to the next grid
yaw and the tolerance on directions widened by as much; only where K rooms are left a fine one is
laid.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import networkx as nx
import numpy as np

from situgraph.experiments.oracle.explained import Motion
from situgraph.experiments.oracle.problem import Flags, Numbers, Problem, Shift
from situgraph.experiments.oracle.regions import Pattern, Regions
from situgraph.geometry.poses import Array, rotation2, wrap_angle

COARSE = math.radians(1.0)
FINE_ARC = 0.02  # metres that the farthest room centre moves from one fine yaw to the next


@dataclass(frozen=True, eq=False)
class Found:
    """A feasible placement, the room pairs (N, M) to be looked at near it, how many planes fit."""

    motion: Motion
    near: Flags
    fits: int


def feasible_placements(problem: Problem, regions: Regions | None = None) -> list[Found]:
    """One feasible placement for each set of correspondences that the grid of yaws meets."""
    regions = regions or Regions(problem)
    if not problem.seen or not problem.planned:
        return []
    found: list[Found] = []
    for shift in problem.shifts:
        samples: dict[bytes, Found] = {}
        for yaw, among in _yaws(problem, regions, shift):
            _add_samples(problem, regions, Motion(yaw, np.zeros(2), shift.z), among, samples)
        found += samples.values()
    return found


def _yaws(problem: Problem, regions: Regions, shift: Shift) -> Iterator[tuple[float, Flags]]:
    """The fine grid, laid where the coarse one leaves enough rooms, and the pairs it leaves."""
    arm = float(np.linalg.norm(problem.arms, axis=1).max())
    steps = math.ceil(COARSE * arm / FINE_ARC) + 1
    start = float(problem.planned[0].angles[0] - problem.seen[0].angles[0])
    for k in range(round(2 * math.pi / COARSE)):
        middle = start + k * COARSE
        there = _there(problem, regions, middle, COARSE / 2, shift.pairs)
        among = np.zeros_like(shift.pairs)
        for crowd in _crowds(problem, there):
            among[tuple(there.pattern.rooms[crowd].T)] = True
        if among.any():
            for m in range(steps):
                yield float(wrap_angle(middle + COARSE * ((m + 0.5) / steps - 0.5))), among


class _There(NamedTuple):
    """A pattern at a yaw: where the room centres lie from the mean one, the mean centre's boxes."""

    pattern: Pattern
    arms: Array
    low: Array
    high: Array


def _there(problem: Problem, regions: Regions, yaw: float, spread: float, among: Flags) -> _There:
    """For each room pair the box of where the mean centre may go, at a yaw or within ``spread``."""
    pattern = regions.pattern(yaw, spread, among)
    arms = (problem.arms @ rotation2(yaw).T)[pattern.rooms[:, 0]]
    slip = np.linalg.norm(arms, axis=1, keepdims=True) * spread
    return _There(pattern, arms, pattern.low - arms - slip, pattern.high - arms + slip)


def _crowds(problem: Problem, there: _There) -> Iterator[Numbers]:
    """The largest sets of room pairs whose boxes share a point, with at least K online rooms."""
    rooms, low, high = there.pattern.rooms[:, 0], there.low, there.high
    if len(set(rooms.tolist())) < problem.least_rooms:
        return
    # Boxes that share a point share the corner made of their largest lower sides.
    xs, ys = (np.unique(low[:, k][np.isfinite(low[:, k])]) for k in (0, 1))
    in_x = (low[None, :, 0] - 1e-9 <= xs[:, None]) & (xs[:, None] <= high[None, :, 0] + 1e-9)
    in_y = (low[None, :, 1] - 1e-9 <= ys[:, None]) & (ys[:, None] <= high[None, :, 1] + 1e-9)
    inside = (in_x[:, None, :] & in_y[None, :, :]).reshape(-1, len(rooms))
    starts = np.flatnonzero(np.diff(rooms, prepend=-1))
    depth = np.logical_or.reduceat(inside, starts, axis=1).sum(axis=1)
    crowded = inside[depth >= problem.least_rooms]
    if len(crowded) > 1:
        crowded = np.unique(crowded, axis=0)
    for k, row in enumerate(crowded):
        contained = ~(row[None, :] & ~crowded).any(axis=1)
        contained[k] = False
        if not contained.any():
            yield np.flatnonzero(row)


def _add_samples(
    problem: Problem, regions: Regions, at: Motion, among: Flags, samples: dict[bytes, Found]
) -> None:
    """Feasible placements at one yaw, one for each way the explained rooms' tolerances hold."""
    there = _there(problem, regions, at.yaw, 0.0, among)
    for chosen in _crowds(problem, there):
        name, crowd = regions.crowd(there.pattern, chosen)
        arms = np.repeat(there.arms[chosen], np.diff(crowd.first), axis=0)
        crowd = crowd._replace(gaps=crowd.gaps - (crowd.normals * arms).sum(axis=1))
        points = regions.vertices(crowd, there.low[chosen], there.high[chosen], problem.least_rooms)
        if not len(points):
            continue
        # Vertices meet on shared tolerances many times over.
        _, once = np.unique(points.round(7) @ (1.0, 1j), return_index=True)
        points = points[once]
        good, states, fitting = regions.what_holds(crowd, points)
        members: dict[bytes, list[int]] = {}
        enough = np.flatnonzero(good.sum(axis=1) >= problem.least_rooms)
        for k, state in zip(enough.tolist(), np.packbits(states[enough], axis=1)):
            members.setdefault(name + state.tobytes(), []).append(k)
        for key in sorted(members.keys() - samples.keys()):
            first = members[key][0]
            if matched(crowd.rooms[good[first]].tolist()) >= problem.least_rooms:
                near = np.zeros_like(among)
                near[tuple(crowd.rooms.T)] = True
                # The strips that hold at all members are convex, so they hold at the mean.
                middle = replace(at, point=points[members[key]].mean(axis=0))
                samples[key] = Found(middle, near, int(fitting[first]))


def matched(pairs: list[list[int]]) -> int:
    """How many of the room pairs can hold at once, each room used once."""
    if len({r for r, _ in pairs}) == len(pairs) == len({a for _, a in pairs}):
        return len(pairs)
    graph = nx.Graph((("r", r), ("a", a)) for r, a in pairs)
    return len(nx.max_weight_matching(graph, maxcardinality=True))
