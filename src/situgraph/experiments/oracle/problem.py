"""Two scene graphs as the definition sees them: rooms of plan lines, storeys, what is allowed."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from situgraph.experiments.oracle.definition import Definition, Policy, Terms
from situgraph.geometry.poses import Array
from situgraph.scenegraph.graph import Object, Room, SceneGraph

Flags = NDArray[np.bool_]
Numbers = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Shape:
    """A room in the plan: centre (2,), and for each usable plane its line ``n.x + d = 0``."""

    room: Room
    storey: float
    center: Array
    planes: tuple[str, ...]
    normals: Array
    offsets: Array

    @cached_property
    def angles(self) -> Array:
        """Direction of each normal."""
        return np.arctan2(self.normals[:, 1], self.normals[:, 0])

    @cached_property
    def distances(self) -> Array:
        """Signed distance of the centre from each plane, as the file orients it."""
        return self.normals @ self.center + self.offsets


class Stack(NamedTuple):
    """All planes of all rooms, one after the other; room ``r`` has ``first[r]:first[r + 1]``."""

    first: Numbers
    angles: Array
    normals: Array
    offsets: Array
    distances: Array

    def planes(self, r: int) -> slice:
        """Where the planes of a room are."""
        return slice(int(self.first[r]), int(self.first[r + 1]))


@dataclass(frozen=True, eq=False)
class Shift:
    """A shift in height and the room pairs (N, M) whose storeys it maps onto each other."""

    z: float
    pairs: Flags


@dataclass(frozen=True, eq=False)
class Problem:
    """An online and a prior graph, a policy and the constants."""

    online: SceneGraph
    prior: SceneGraph
    policy: Policy
    constants: Definition

    @cached_property
    def seen(self) -> list[Shape]:
        """The online rooms that count."""
        return _shapes(self.online, self.constants)

    @cached_property
    def planned(self) -> list[Shape]:
        """The prior rooms that count."""
        return _shapes(self.prior, self.constants)

    @cached_property
    def mine(self) -> Stack:
        """The planes of the online rooms."""
        return _stacked(self.seen)

    @cached_property
    def theirs(self) -> Stack:
        """The planes of the prior rooms."""
        return _stacked(self.planned)

    @cached_property
    def planned_lines(self) -> list[list[tuple[tuple[float, float], float]]]:
        """The lines of each prior room's planes, from the mean of the prior rooms' centres."""
        middle = np.mean([s.center for s in self.planned], axis=0)
        return [
            [((x, y), d) for (x, y), d in zip(s.normals.tolist(), (s.offsets + s.normals @ middle))]
            for s in self.planned
        ]

    @cached_property
    def crossed(self) -> Flags:
        """(P, P): which of all online planes are not parallel."""
        turn = np.sin(self.mine.angles[:, None] - self.mine.angles[None, :])
        return np.asarray(np.abs(turn) >= self.constants.parallel_sine)

    @cached_property
    def arms(self) -> Array:
        """Where each online room's centre lies from the mean one (N, 2)."""
        return np.array([s.center for s in self.seen]) - self.middle

    @cached_property
    def middle(self) -> Array:
        """The mean online room centre (2,): a placement is told by where it takes this point."""
        return np.asarray(np.mean([s.center for s in self.seen], axis=0))

    @cached_property
    def terms(self) -> Terms:
        """The constants of the log ratio of planes."""
        return self.constants.terms(self.sigma)

    @cached_property
    def sigma(self) -> float:
        """Standard deviation of the offset of a wall that fits, in whole millimetres or as set."""
        c, mean_square = self.constants, float((self.arms**2).sum(axis=1).mean())
        bent = math.sqrt(c.plane_sigma**2 + (c.map_bend * mean_square) ** 2)
        even = c.fit_limit / math.sqrt(3)  # of offsets spread evenly over what fits
        if even > c.plane_sigma:
            bent = min(bent, even)
            return max(c.plane_sigma, math.ceil(1000 * bent - 1e-6) / 1000)
        return c.plane_sigma

    @cached_property
    def least_rooms(self) -> int:
        """K."""
        return self.constants.least_rooms(len(self.seen))

    @cached_property
    def modelled(self) -> frozenset[str]:
        """The categories that are evidence."""
        return self.prior.modelled

    @cached_property
    def shifts(self) -> list[Shift]:
        """Every shift in height worth a look."""
        return _shifts(self.seen, self.planned, self.constants.storey_tolerance)

    @cached_property
    def allowed(self) -> Flags:
        """(P, Q): which plane pairs the policy lets be pairs, in room pairs that may be pairs."""
        rooms = self._rooms_allowed
        rows = np.repeat(np.arange(len(rooms)), np.diff(self.mine.first))
        columns = np.repeat(np.arange(rooms.shape[1]), np.diff(self.theirs.first))
        return np.asarray(self._planes_allowed & rooms[np.ix_(rows, columns)])

    def room_allowed(self, r: int, a: int) -> bool:
        """Whether the policy lets this room pair be a pair."""
        return bool(self._rooms_allowed[r, a])

    def planes_allowed(self, r: int, a: int) -> Flags:
        """(planes of r, planes of a): which plane pairs the policy lets be pairs.

        Of what is on a plane, only what is in the room too is asked for, and offered.
        """
        return self._planes_allowed[self.mine.planes(r), self.theirs.planes(a)]

    @cached_property
    def _rooms_allowed(self) -> Flags:
        if self.policy != "containment":
            return np.ones((len(self.seen), len(self.planned)), dtype=bool)
        need = [self.online.objects_by_room.get(s.room.id, ()) for s in self.seen]
        have = [self.prior.objects_by_room.get(s.room.id, ()) for s in self.planned]
        return _contained(need, have, self.modelled)

    @cached_property
    def _planes_allowed(self) -> Flags:
        if self.policy != "containment":
            return np.ones((len(self.mine.angles), len(self.theirs.angles)), dtype=bool)
        need = [_on_face(self.online, s.room, p) for s in self.seen for p in s.planes]
        have = [_on_face(self.prior, s.room, q) for s in self.planned for q in s.planes]
        return _contained(need, have, self.modelled)


def _on_face(graph: SceneGraph, room: Room, plane: str) -> tuple[Object, ...]:
    """The objects on a plane that are in the room."""
    return tuple(o for o in graph.objects_by_plane.get(plane, ()) if room.id in o.rooms)


def _contained(
    need: list[tuple[Object, ...]], have: list[tuple[Object, ...]], categories: frozenset[str]
) -> Flags:
    """(needs, offers): whether each category is offered as often as it is needed."""
    enough = np.ones((len(need), len(have)), dtype=bool)
    for category in categories:
        asked = [sum(o.category == category for o in objects) for objects in need]
        offered = [sum(o.category == category for o in objects) for objects in have]
        enough &= np.array(offered)[None, :] >= np.array(asked)[:, None]
    return enough


def _stacked(shapes: list[Shape]) -> Stack:
    return Stack(
        first=np.cumsum([0, *(len(s.planes) for s in shapes)]),
        angles=np.concatenate([s.angles for s in shapes]),
        normals=np.concatenate([s.normals for s in shapes]),
        offsets=np.concatenate([s.offsets for s in shapes]),
        distances=np.concatenate([s.distances for s in shapes]),
    )


def _shapes(graph: SceneGraph, constants: Definition) -> list[Shape]:
    elevations = {s.id: s.elevation for s in graph.storeys}
    shapes = []
    for room in graph.rooms:
        normals, offsets = graph.plane_arrays(room.planes)
        flat = np.abs(normals[:, 2]) <= math.sin(constants.usable_tilt) + 1e-12
        if flat.sum() < 2:
            continue
        length = np.linalg.norm(normals[flat, :2], axis=1)
        # The wall is cut at the height of the room's centre, where it is seen.
        cut = offsets[flat] + normals[flat, 2] * room.center[2]
        shapes.append(
            Shape(
                room=room,
                storey=elevations.get(room.storey, 0.0) if room.storey else 0.0,
                center=np.array(room.center[:2]),
                planes=tuple(p for p, keep in zip(room.planes, flat) if keep),
                normals=normals[flat, :2] / length[:, None],
                offsets=cut / length,
            )
        )
    return shapes


def _shifts(seen: list[Shape], planned: list[Shape], tolerance: float) -> list[Shift]:
    lower, upper = sorted({s.storey for s in seen}), sorted({s.storey for s in planned})
    by_mapping: dict[tuple[int, ...], list[float]] = {}
    for z in sorted({v - u for u in lower for v in upper}):
        mapping = tuple(_nearest(u + z, upper, tolerance) for u in lower)
        by_mapping.setdefault(mapping, []).append(z)
    shifts = []
    for mapping, heights in by_mapping.items():
        goes = {u: upper[v] for u, v in zip(lower, mapping) if v >= 0}
        pairs = np.array([[goes.get(r.storey) == a.storey for a in planned] for r in seen])
        for group in _grouped(heights, tolerance):
            shifts.append(Shift(float(np.mean(group)), pairs))
    return sorted(shifts, key=lambda s: s.z)


def _nearest(height: float, storeys: list[float], tolerance: float) -> int:
    gaps = [abs(height - v) for v in storeys]
    best = int(np.argmin(gaps))
    return best if gaps[best] <= tolerance + 1e-9 else -1


def _grouped(heights: list[float], tolerance: float) -> list[list[float]]:
    groups: list[list[float]] = []
    for z in heights:
        if groups and z - groups[-1][0] <= tolerance:
            groups[-1].append(z)
        else:
            groups.append([z])
    return groups
