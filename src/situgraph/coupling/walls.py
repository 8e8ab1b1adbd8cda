"""Pairs of faces, seen and planned, and the frame in which their deviation is measured."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from situgraph.coupling.evidence import place_of
from situgraph.coupling.lines import WallLines
from situgraph.geometry.poses import Array, Placement
from situgraph.scenegraph.graph import Plane, SceneGraph

SHORTEST = 0.1  # m; no face is seen over less


@dataclass(frozen=True, eq=False)
class Wall:
    """A planned face and the online plane that is it.

    ``frame`` (4, 4) stands in the building on the planned face where it was seen: x along its
    normal into the room, z up. The deviation of the face as built is a motion in this frame: its
    shift along x and its turn about z can be seen in the face, the rest cannot. ``line`` is the
    wall of the plan that the face belongs to (``WallLines``); ``length`` (m) is how much of it was
    seen, infinite where that is not known.
    """

    online: str
    prior: str
    frame: Array
    line: str
    length: float = math.inf


def walls(
    online: SceneGraph,
    prior: SceneGraph,
    pairs: Iterable[tuple[str, str]],
    placement: Placement,
    lines: WallLines,
) -> tuple[Wall, ...]:
    """The pairs (online id, prior id) that both graphs know, in the order of the online ids."""
    found = []
    for name, planned in sorted(pairs):
        seen, face = online.plane_by_id.get(name), prior.plane_by_id.get(planned)
        if seen is not None and face is not None:
            height = float(placement.points(place_of(online, seen))[2])
            place, length = _middle(seen, face, prior, placement, height)
            found.append(Wall(name, planned, _frame(face, place), lines.of(planned), length))
    return tuple(found)


def grouped(walls: Sequence[Wall]) -> list[list[Wall]]:
    """The faces of each wall: seen as one plane, or of one wall of the plan."""
    parts: list[list[int]] = []
    for i, face in enumerate(walls):
        touching = [
            part
            for part in parts
            if any(face.online == walls[j].online or face.line == walls[j].line for j in part)
        ]
        parts = [part for part in parts if part not in touching]
        parts.append(sorted([i, *(j for part in touching for j in part)]))
    return [[walls[i] for i in part] for part in sorted(parts)]


def stretch(
    plane: Plane, along: Array, placement: Placement | None = None
) -> tuple[float, float] | None:
    """First and last metre of a face's extent along the direction ``along`` (2,)."""
    if plane.extent is None:
        return None
    ends = np.asarray(plane.extent, dtype=float)
    if placement is not None:
        ends = placement.points(ends)
    low, high = sorted((ends @ along).tolist())
    return float(low), float(high)


def _middle(
    seen: Plane, face: Plane, prior: SceneGraph, placement: Placement, height: float
) -> tuple[Array, float]:
    """The middle (3,) of the stretch that was planned and seen, on the planned face; its length."""
    n = _unit(face)
    along = np.array([-n[1], n[0]])
    planned, found = stretch(face, along), stretch(seen, along, placement)
    place, length = place_of(prior, face), math.inf
    if found is not None:
        low, high = found
        if planned is not None and min(high, planned[1]) > max(low, planned[0]):
            low, high = max(low, planned[0]), min(high, planned[1])
        length = max(high - low, SHORTEST)
        place[:2] += ((low + high) / 2 - place[:2] @ along) * along
    place[2] = height
    place -= (n @ place + face.offset) * n
    return place, length


def _unit(face: Plane) -> Array:
    n = np.asarray(face.normal, dtype=float)
    return np.asarray(n / np.linalg.norm(n))


def _frame(face: Plane, place: Array) -> Array:
    x = _unit(face)
    y = np.array([-x[1], x[0], 0.0])
    y /= np.linalg.norm(y)
    frame = np.eye(4)
    frame[:3, 0], frame[:3, 1], frame[:3, 2] = x, y, np.cross(x, y)
    frame[:3, 3] = place
    return frame
