"""Where in the plan a room's centre may lie for the room to be explained by a given prior room.

A placement moves the centre of a room anywhere, so in terms of the moved centre the region depends
on the yaw only through *which* planes have the same direction.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from situgraph.experiments.oracle.explained import SLACK, assignments
from situgraph.experiments.oracle.problem import Flags, Problem, Shape
from situgraph.geometry.poses import Array, wrap_angle

TURN = 2 * np.pi
EVERYWHERE = np.array([[-np.inf, -np.inf], [np.inf, np.inf]])


def crossings(normals: Array, values: Array) -> Array:
    """All points (k, 2) where two of the lines ``n.x = value`` cross."""
    first, second = np.triu_indices(len(normals), 1)
    n, m = normals[first], normals[second]
    cross = n[:, 0] * m[:, 1] - n[:, 1] * m[:, 0]
    keep = np.abs(cross) > 1e-6
    n, m, cross = n[keep], m[keep], cross[keep]
    u, v = values[first][keep], values[second][keep]
    x = (u * m[:, 1] - v * n[:, 1]) / cross
    y = (v * n[:, 0] - u * m[:, 0]) / cross
    return np.stack([x, y], axis=1)


def _stacked(shapes: list[Shape]) -> tuple[list[slice], Array]:
    """All planes of all rooms one after the other: where each room's are, and their directions."""
    ends = np.cumsum([len(s.planes) for s in shapes]).tolist()
    slices = [slice(end - len(s.planes), end) for s, end in zip(shapes, ends)]
    return slices, np.concatenate([s.angles for s in shapes])


class Held(NamedTuple):
    """For some places of a room: is it explained; which plane pairs (k, pairs) are near, fit."""

    good: Flags
    near: Flags
    fits: Flags


class Regions:
    """The regions of all room pairs of a problem, remembered by which planes share a direction."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self._boxes: dict[tuple[int, int, bytes], Array | None] = {}
        self._rows, row_angles = _stacked(problem.seen)
        self._columns, column_angles = _stacked(problem.planned)
        self._turn = row_angles[:, None] - column_angles[None, :]
        self._allowed = np.zeros(self._turn.shape, dtype=bool)
        for r, rows in enumerate(self._rows):
            for a, columns in enumerate(self._columns):
                if problem.room_allowed(r, a):
                    self._allowed[rows, columns] = problem.planes_allowed(r, a)

    def directed(self, yaw: float, spread: float, among: Flags) -> dict[tuple[int, int], Flags]:
        """Plane pairs of the same direction at a yaw, or at some yaw within ``spread`` of it.

        Only for those room pairs ``among`` (N, M) where at most one plane has no counterpart.
        """
        limit = self.problem.constants.angle_tolerance + spread + SLACK
        near = (np.abs(wrap_angle(self._turn + yaw)) <= limit) & self._allowed
        found = np.logical_or.reduceat(near, [c.start for c in self._columns], axis=1)
        bare = np.add.reduceat(~found, [r.start for r in self._rows], axis=0, dtype=int)
        return {
            (r, a): near[self._rows[r], self._columns[a]]
            for r, a in np.argwhere((bare <= 1) & among).tolist()
        }

    def lines(self, r: int, a: int, directed: Flags) -> tuple[Array, Array]:
        """Every tolerance limit of the pair as a line ``n.x = value`` for the moved centre."""
        c = self.problem.constants
        i, j = np.nonzero(directed)
        theirs = self.problem.planned[a]
        zero = self.problem.seen[r].distances[i] - theirs.offsets[j]
        limits = np.array([-c.moved_limit, -c.fit_limit, c.fit_limit, c.moved_limit])
        values = zero[:, None] + limits[None, :]
        return np.repeat(theirs.normals[j], len(limits), axis=0), values.ravel()

    def explained(self, r: int, a: int, directed: Flags, centers: Array) -> Held:
        """What holds when the room's centre is moved to each of ``centers`` (k, 2)."""
        c = self.problem.constants
        mine, theirs = self.problem.seen[r], self.problem.planned[a]
        rows, columns = np.nonzero(directed)
        reach = centers @ theirs.normals[columns].T + theirs.offsets[columns]
        offset = np.abs(mine.distances[rows] - reach)
        near, fits = offset <= c.moved_limit + SLACK, offset <= c.fit_limit + SLACK
        place = {(i, j): k for k, (i, j) in enumerate(zip(rows.tolist(), columns.tolist()))}
        crossed = mine.not_parallel(c.parallel_sine)
        good = np.zeros(len(centers), dtype=bool)
        for choice in assignments(directed):
            pairs = [(i, place[i, j]) for i, j in enumerate(choice) if j >= 0]
            held = [k for _, k in pairs]
            if len(choice) == 2 or not crossed.any():
                if len(pairs) == len(choice):
                    good |= fits[:, held].all(axis=1)
                continue
            anchored = np.zeros(len(centers), dtype=bool)
            for n, (i, k) in enumerate(pairs):
                for j, m in pairs[n + 1 :]:
                    if crossed[i, j]:
                        anchored |= fits[:, k] & fits[:, m]
            good |= anchored & near[:, held].all(axis=1)
        return Held(good, near, fits)

    def box(self, r: int, a: int, directed: Flags) -> Array | None:
        """Bounding box ``[[x, y], [x, y]]`` of the region, None when it is empty."""
        key = (r, a, directed.tobytes())
        if key not in self._boxes:
            self._boxes[key] = self._find_box(r, a, directed)
        return self._boxes[key]

    def _find_box(self, r: int, a: int, directed: Flags) -> Array | None:
        mine = self.problem.seen[r]
        if not mine.not_parallel(self.problem.constants.parallel_sine).any():
            return self._strip_box(r, a, directed)
        centers = crossings(*self.lines(r, a, directed))
        if not len(centers):
            return None
        centers = centers[self.explained(r, a, directed, centers).good]
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
        block = self._rows[r], self._columns[a]
        turn, allowed = self._turn[block], self._allowed[block]
        tolerance = self.problem.constants.angle_tolerance
        ends = np.sort(np.concatenate([-turn - tolerance, -turn + tolerance], axis=None) % TURN)
        ends = np.append(ends, ends[0] + TURN)
        # Between two ends nothing changes, so one yaw in each gap stands for it.
        yaws = np.unique((ends[1:] + ends[:-1]) / 2)
        directed = (np.abs(wrap_angle(turn + yaws[:, None, None])) <= tolerance) & allowed
        enough = (~directed.any(axis=2)).sum(axis=1) <= 1
        return any(self.box(r, a, flags) is not None for flags in directed[enough])
