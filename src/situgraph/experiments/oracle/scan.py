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
from dataclasses import dataclass

import networkx as nx
import numpy as np

from situgraph.experiments.oracle.explained import Motion
from situgraph.experiments.oracle.problem import Flags, Problem, Shift
from situgraph.experiments.oracle.regions import Regions, crossings
from situgraph.geometry.poses import Array, rotation2, wrap_angle

COARSE = math.radians(1.0)
FINE_ARC = 0.02  # metres that the farthest room centre moves from one fine yaw to the next

Pair = tuple[int, int]


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
            for key, sample in _at_yaw(problem, regions, yaw, shift.z, among):
                samples.setdefault(key, sample)
        found += samples.values()
    return found


def _yaws(problem: Problem, regions: Regions, shift: Shift) -> Iterator[tuple[float, Flags]]:
    """The fine grid, laid where the coarse one leaves enough rooms, and the pairs it leaves."""
    arm = max(float(np.linalg.norm(s.center - problem.middle)) for s in problem.seen)
    steps = math.ceil(COARSE * arm / FINE_ARC) + 1
    start = float(problem.planned[0].angles[0] - problem.seen[0].angles[0])
    for k in range(round(2 * math.pi / COARSE)):
        middle = start + k * COARSE
        boxes = _boxes(problem, regions, middle, COARSE / 2, shift.pairs)
        among = np.zeros_like(shift.pairs)
        for crowd in _crowds(problem, boxes):
            among[tuple(np.transpose(crowd))] = True
        if among.any():
            for m in range(steps):
                yield float(wrap_angle(middle + COARSE * ((m + 0.5) / steps - 0.5))), among


def _boxes(
    problem: Problem, regions: Regions, yaw: float, spread: float, among: Flags
) -> dict[Pair, Array]:
    """For each room pair the box of where the mean centre may go, at a yaw or within ``spread``."""
    boxes: dict[Pair, Array] = {}
    turn = rotation2(yaw)
    for (r, a), directed in regions.directed(yaw, spread, among).items():
        box = regions.box(r, a, directed)
        if box is not None:
            arm = problem.seen[r].center - problem.middle
            slip = float(np.linalg.norm(arm)) * spread
            boxes[r, a] = box - turn @ arm + slip * np.array([[-1.0], [1.0]])
    return boxes


def _crowds(problem: Problem, boxes: dict[Pair, Array]) -> Iterator[list[Pair]]:
    """The largest sets of room pairs whose boxes share a point, with at least K online rooms."""
    if len({r for r, _ in boxes}) < problem.least_rooms:
        return
    pairs = list(boxes)
    low = np.array([b[0] for b in boxes.values()])
    high = np.array([b[1] for b in boxes.values()])
    # Boxes that share a point share the corner made of their largest lower sides.
    xs, ys = (np.unique(low[:, k][np.isfinite(low[:, k])]) for k in (0, 1))
    in_x = (low[None, :, 0] - 1e-9 <= xs[:, None]) & (xs[:, None] <= high[None, :, 0] + 1e-9)
    in_y = (low[None, :, 1] - 1e-9 <= ys[:, None]) & (ys[:, None] <= high[None, :, 1] + 1e-9)
    inside = (in_x[:, None, :] & in_y[None, :, :]).reshape(-1, len(pairs))
    rooms = np.array([r for r, _ in pairs])
    depth = sum(inside[:, rooms == r].any(axis=1).astype(int) for r in set(rooms.tolist()))
    crowded = np.unique(inside[np.asarray(depth) >= problem.least_rooms], axis=0)
    for k, row in enumerate(crowded):
        contained = ~(row[None, :] & ~crowded).any(axis=1)
        contained[k] = False
        if not contained.any():
            yield [pairs[int(p)] for p in np.flatnonzero(row)]


def _at_yaw(
    problem: Problem, regions: Regions, yaw: float, z: float, among: Flags
) -> Iterator[tuple[bytes, Found]]:
    """Feasible placements at one yaw, one for each way the explained rooms' tolerances hold."""
    boxes = _boxes(problem, regions, yaw, 0.0, among)
    for crowd in _crowds(problem, boxes):
        near = np.zeros_like(among)
        near[tuple(np.transpose(crowd))] = True
        directed = regions.directed(yaw, 0.0, near)
        for key, point, fits in _vertices(problem, regions, yaw, directed, boxes):
            yield key, Found(Motion(yaw, point, z), near, fits)


def _vertices(
    problem: Problem,
    regions: Regions,
    yaw: float,
    directed: dict[Pair, Flags],
    boxes: dict[Pair, Array],
) -> Iterator[tuple[bytes, Array, int]]:
    crowd = list(directed)
    arms = {r: rotation2(yaw) @ (problem.seen[r].center - problem.middle) for r, _ in crowd}
    normals: list[Array] = []
    values: list[Array] = []
    for r, a in crowd:
        normal, value = regions.lines(r, a, directed[r, a])
        normals.append(normal)
        values.append(value - normal @ arms[r])
    points = crossings(np.concatenate(normals), np.concatenate(values))
    points = points[_crowded(problem, points, crowd, boxes)]
    # Vertices meet on shared tolerances many times over.
    _, once = np.unique(points.round(7) @ (1.0, 1j), return_index=True)
    points = points[once]
    good = np.zeros((len(points), len(crowd)), dtype=bool)
    fitting = np.zeros(len(points), dtype=int)
    states: list[Flags] = []
    for k, (r, a) in enumerate(crowd):
        held = regions.explained(r, a, directed[r, a], points + arms[r])
        good[:, k] = held.good
        fitting += held.fits.sum(axis=1) * held.good
        states += [
            held.good[:, None],
            held.near & held.good[:, None],
            held.fits & held.good[:, None],
        ]
    possible = good.sum(axis=1) >= problem.least_rooms
    keys = np.packbits(np.concatenate(states, axis=1), axis=1)[possible]
    points, good, fitting = points[possible], good[possible], fitting[possible]
    names = repr([(pair, flags.tobytes()) for pair, flags in directed.items()]).encode()
    groups, first, group = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    for g, key in enumerate(groups):
        explained = [pair for pair, ok in zip(crowd, good[first[g]]) if ok]
        if matched(explained) >= problem.least_rooms:
            # The strips that hold at all members are convex, so they hold at the mean.
            mean = points[group.ravel() == g].mean(axis=0)
            yield names + key.tobytes(), mean, int(fitting[first[g]])


def _crowded(problem: Problem, points: Array, crowd: list[Pair], boxes: dict[Pair, Array]) -> Flags:
    """Which points lie in the boxes of at least K rooms."""
    depth = np.zeros(len(points), dtype=int)
    for r in {r for r, _ in crowd}:
        inside = np.zeros(len(points), dtype=bool)
        for pair in crowd:
            if pair[0] == r:
                low, high = boxes[pair]
                inside |= ((points >= low - 1e-6) & (points <= high + 1e-6)).all(axis=1)
        depth += inside
    return np.asarray(depth >= problem.least_rooms)


def matched(pairs: list[Pair]) -> int:
    """How many of the room pairs can hold at once, each room used once."""
    if len({r for r, _ in pairs}) == len(pairs) == len({a for _, a in pairs}):
        return len(pairs)
    graph = nx.Graph((("r", r), ("a", a)) for r, a in pairs)
    return len(nx.max_weight_matching(graph, maxcardinality=True))
