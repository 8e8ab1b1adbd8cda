"""Two scene graphs as the definition sees them: rooms of plan lines, storeys, what is allowed."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from situgraph.experiments.oracle.definition import Definition, Policy
from situgraph.geometry.poses import Array
from situgraph.scenegraph.graph import Object, Room, SceneGraph

Flags = NDArray[np.bool_]


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

    def not_parallel(self, sine: float) -> Flags:
        """(n, n): which pairs of planes are not parallel."""
        crossed = np.sin(self.angles[:, None] - self.angles[None, :])
        return np.asarray(np.abs(crossed) >= sine)


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
    def middle(self) -> Array:
        """The mean online room centre (2,): a placement is told by where it takes this point."""
        return np.asarray(np.mean([s.center for s in self.seen], axis=0))

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

    def room_allowed(self, r: int, a: int) -> bool:
        """Whether the policy lets this room pair be a pair."""
        if self.policy != "containment":
            return True
        have = self.prior.objects_by_room.get(self.planned[a].room.id, ())
        need = self.online.objects_by_room.get(self.seen[r].room.id, ())
        return _contains(have, need, self.modelled)

    def planes_allowed(self, r: int, a: int) -> Flags:
        """(planes of r, planes of a): which plane pairs the policy lets be pairs.

        Of what is on a plane, only what is in the room too is asked for, and offered.
        """
        mine, theirs = self.seen[r], self.planned[a]
        if self.policy != "containment":
            return np.ones((len(mine.planes), len(theirs.planes)), dtype=bool)
        need = [_on_face(self.online, mine.room, p) for p in mine.planes]
        have = [_on_face(self.prior, theirs.room, q) for q in theirs.planes]
        return np.array(
            [[_contains(offer, asked, self.modelled) for offer in have] for asked in need],
            dtype=bool,
        )


def _on_face(graph: SceneGraph, room: Room, plane: str) -> tuple[Object, ...]:
    """The objects on a plane that are in the room."""
    return tuple(o for o in graph.objects_by_plane.get(plane, ()) if room.id in o.rooms)


def _contains(
    have: tuple[Object, ...], need: tuple[Object, ...], categories: frozenset[str]
) -> bool:
    return all(
        sum(o.category == c for o in have) >= sum(o.category == c for o in need) for c in categories
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
