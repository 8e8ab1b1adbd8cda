"""Where in the plan a room's centre may lie for the room to be explained by a given prior room.

A placement moves the centre of a room anywhere, so in terms of the moved centre the region depends
on the yaw only through *which* planes have the same direction.
"""

from __future__ import annotations

import bisect
from dataclasses import dataclass, field

import numpy as np

from situgraph.experiments.oracle.explained import SLACK, assignments
from situgraph.experiments.oracle.loops import Crowd, Limits, vertices, what_holds
from situgraph.experiments.oracle.problem import Flags, Numbers, Problem
from situgraph.geometry.poses import Array, wrap_angle

TURN = 2 * np.pi
EVERYWHERE = np.array([[-np.inf, -np.inf], [np.inf, np.inf]])


@dataclass(frozen=True, eq=False)
class Pattern:
    """Which planes have the same direction at some yaw, and the boxes of the room pairs there.

    ``rooms`` (k, 2) are the room pairs that can be explained somewhere, ``directed`` their plane
    pairs, ``low`` and ``high`` (k, 2) the bounding boxes of where their moved centres may lie.
    """

    rooms: Numbers
    directed: list[Flags]
    low: Array
    high: Array
    crowds: dict[bytes, tuple[bytes, Crowd]] = field(default_factory=dict)


class Regions:
    """The regions of all room pairs of a problem, remembered by which planes share a direction."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        c = problem.constants
        self.lines = Limits(c.angle_tolerance, c.moved_limit, c.fit_limit)
        self.limits = Limits(*(limit + SLACK for limit in self.lines))
        self._boxes: dict[tuple[int, int, bytes], Array | None] = {}
        self._patterns: dict[tuple[float, int, bytes], Pattern] = {}
        self._ends: dict[float, list[float]] = {}
        self._turn = problem.mine.angles[:, None] - problem.theirs.angles[None, :]

    def pattern(self, yaw: float, spread: float, among: Flags) -> Pattern:
        """The planes of the same direction at a yaw, or at some yaw within ``spread`` of it.

        Only of those room pairs ``among`` (N, M) where at most one plane has no counterpart.
        """
        if spread not in self._ends:
            self._ends[spread] = self._changes(self.limits.angle + spread)
        # Between two changes nothing changes.
        key = spread, bisect.bisect(self._ends[spread], yaw % TURN), among.tobytes()
        if key not in self._patterns:
            near = np.abs(wrap_angle(self._turn + yaw)) <= self.limits.angle + spread
            self._patterns[key] = self._find_pattern(near & self.problem.allowed, among)
        return self._patterns[key]

    def _changes(self, tolerance: float) -> list[float]:
        """The yaws at which some plane pair begins or ceases to have the same direction."""
        ends = np.concatenate([-self._turn - tolerance, -self._turn + tolerance], axis=None)
        return sorted((ends % TURN).tolist())

    def _find_pattern(self, near: Flags, among: Flags) -> Pattern:
        mine, theirs = self.problem.mine, self.problem.theirs
        found = np.logical_or.reduceat(near, theirs.first[:-1], axis=1)
        bare = np.add.reduceat(~found, mine.first[:-1], axis=0, dtype=int)
        rooms, every, boxes = [], [], []
        for r, a in np.argwhere((bare <= 1) & among).tolist():
            directed = near[mine.planes(r), theirs.planes(a)]
            box = self.box(r, a, directed)
            if box is not None:
                rooms.append((r, a))
                every.append(directed)
                boxes.append(box)
        sides = np.array(boxes).reshape(-1, 2, 2)
        return Pattern(np.array(rooms, dtype=int).reshape(-1, 2), every, sides[:, 0], sides[:, 1])

    def crowd(self, pattern: Pattern, chosen: Numbers) -> tuple[bytes, Crowd]:
        """Some of a pattern's room pairs, and a name for them and their plane pairs."""
        key = chosen.tobytes()
        if key not in pattern.crowds:
            directed = [pattern.directed[n] for n in chosen.tolist()]
            rooms = pattern.rooms[chosen]
            name = repr([(*pair, d.tobytes()) for pair, d in zip(rooms.tolist(), directed)])
            pattern.crowds[key] = name.encode(), self._crowd(rooms, directed)
        return pattern.crowds[key]

    def _crowd(self, rooms: Numbers, directed: list[Flags]) -> Crowd:
        mine, theirs = self.problem.mine, self.problem.theirs
        planes = np.concatenate([np.argwhere(flags) for flags in directed])
        sizes = [int(flags.sum()) for flags in directed]
        of = np.repeat(rooms, sizes, axis=0)
        p, q = mine.first[of[:, 0]] + planes[:, 0], theirs.first[of[:, 1]] + planes[:, 1]
        gaps = mine.distances[p] - theirs.offsets[q]
        return Crowd(rooms, np.cumsum([0, *sizes]), planes, theirs.normals[q], gaps)

    def vertices(self, crowd: Crowd, low: Array, high: Array, least: int) -> Array:
        """All points where two tolerance limits cross, in the boxes of at least so many rooms."""
        return vertices(crowd, self.lines, low, high, least)

    def what_holds(self, crowd: Crowd, points: Array) -> tuple[Flags, Flags, Numbers]:
        """What holds at each of the points (``loops.what_holds``)."""
        problem = self.problem
        return what_holds(crowd, self.limits, problem.crossed, problem.mine, problem.theirs, points)

    def box(self, r: int, a: int, directed: Flags) -> Array | None:
        """Bounding box ``[[x, y], [x, y]]`` of the region, None when it is empty."""
        key = (r, a, directed.tobytes())
        if key not in self._boxes:
            self._boxes[key] = self._find_box(r, a, directed)
        return self._boxes[key]

    def _find_box(self, r: int, a: int, directed: Flags) -> Array | None:
        rows = self.problem.mine.planes(r)
        if not self.problem.crossed[rows, rows].any():
            return self._strip_box(r, a, directed)
        crowd = self._crowd(np.array([[r, a]]), [directed])
        centers = self.vertices(crowd, EVERYWHERE[:1], EVERYWHERE[1:], 1)
        centers = centers[self.what_holds(crowd, centers)[0][:, 0]]
        return np.array([centers.min(axis=0), centers.max(axis=0)]) if len(centers) else None

    def _strip_box(self, r: int, a: int, directed: Flags) -> Array | None:
        """Rooms of parallel planes are explained along a strip: bounded only across an axis."""
        c, theirs = self.problem.constants, self.problem.planned[a]
        boxes = []
        for choice in assignments(directed):
            if -1 in choice:
                continue
            box = EVERYWHERE.copy()
            for i, j in enumerate(choice):
                n = theirs.normals[j]
                axis = int(np.argmax(np.abs(n)))
                if abs(n[axis]) < 1 - 1e-12:
                    continue
                middle = (self.problem.seen[r].distances[i] - theirs.offsets[j]) / n[axis]
                box[0, axis] = max(box[0, axis], middle - c.fit_limit - SLACK)
                box[1, axis] = min(box[1, axis], middle + c.fit_limit + SLACK)
            if (box[0] <= box[1]).all():
                boxes.append(box)
        if not boxes:
            return None
        return np.array(
            [np.min([b[0] for b in boxes], axis=0), np.max([b[1] for b in boxes], axis=0)]
        )

    def fits_somewhere(self, r: int, a: int) -> bool:
        """Whether prior room ``a`` explains online room ``r`` in isolation, at any yaw."""
        block = self.problem.mine.planes(r), self.problem.theirs.planes(a)
        turn, allowed = self._turn[block], self.problem.allowed[block]
        tolerance = self.problem.constants.angle_tolerance
        ends = np.sort(np.concatenate([-turn - tolerance, -turn + tolerance], axis=None) % TURN)
        ends = np.append(ends, ends[0] + TURN)
        # Between two ends nothing changes, so one yaw in each gap stands for it.
        yaws = np.unique((ends[1:] + ends[:-1]) / 2)
        directed = (np.abs(wrap_angle(turn + yaws[:, None, None])) <= tolerance) & allowed
        enough = (~directed.any(axis=2)).sum(axis=1) <= 1
        return any(self.box(r, a, flags) is not None for flags in directed[enough])
