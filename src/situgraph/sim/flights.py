"""Stairs and ramps that join storeys: straight flights of a slope a walking robot can climb."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from situgraph.geometry.poses import Array, rotation2
from situgraph.scenegraph.graph import Object, SceneGraph
from situgraph.sim.levels import Level, yaw_of
from situgraph.sim.mesh import MeshBuilder, edges

CATEGORIES = frozenset({"stair", "stairs", "ramp"})

_SLOPE = math.radians(32.0)  # of a comfortable stair
_STEEPEST = math.radians(48.0)
_LANDING = 0.75  # m, free floor at the foot and at the head
_HEADROOM = 2.0  # m
_STEP = 0.17  # m, height of a step


@dataclass(frozen=True, eq=False)
class Flight:
    """A straight way up from ``foot`` (3,) to ``head`` (3,), the middles of its ends; metres."""

    object: Object
    lower: int
    upper: int
    foot: Array
    head: Array
    width: float

    @property
    def direction(self) -> Array:
        """Unit vector (2,) from foot to head in the plan view."""
        run = self.head[:2] - self.foot[:2]
        return np.asarray(run / np.linalg.norm(run))

    def strip(self, start: float, end: float, margin: float = 0.0) -> Any:
        """The plan view between two fractions of the run, as a shapely polygon."""
        import shapely

        line = np.array([self.foot[:2] + f * (self.head - self.foot)[:2] for f in (start, end)])
        return shapely.LineString(line).buffer(self.width / 2 + margin, cap_style="flat")

    @property
    def hole(self) -> Any:
        """What is cut out of the slab above so that a head has room."""
        rise = float(self.head[2] - self.foot[2])
        return self.strip(max(1.0 - _HEADROOM / rise, 0.0), 1.0, 0.05)

    @property
    def low_part(self) -> Any:
        """What stands in the way on the lower floor."""
        return self.strip(0.0, 1.0)


def flights_of(
    plan: SceneGraph, levels: tuple[Level, ...]
) -> tuple[tuple[Flight, ...], tuple[str, ...]]:
    """The flights between neighbouring levels, and sentences about those that do not fit.

    A flight stands for each object of category stairs or ramp whose rooms are on two levels. It
    runs through the object's centre along the object's x or y axis, whichever has more space, and
    up the axis; its attribute ``up`` (``+x``, ``-x``, ``+y``, ``-y``) says otherwise.
    """
    found, odd = [], []
    for item in plan.objects:
        if item.category not in CATEGORIES:
            continue
        at = [i for i, level in enumerate(levels) if any(r in level.rooms for r in item.rooms)]
        if len(at) < 2:
            continue
        flight = _fitted(item, at[0], at[1], levels)
        if flight is None:
            odd.append(f"{item.category} {item.id} is too steep to walk and joins no storeys")
        else:
            found.append(flight)
    return tuple(found), tuple(odd)


def _fitted(item: Object, lower: int, upper: int, levels: tuple[Level, ...]) -> Flight | None:
    import shapely

    low, high = levels[lower], levels[upper]
    rooms = [[lv.rooms[r] for r in item.rooms if r in lv.rooms] for lv in (low, high)]
    space = shapely.union_all(rooms[0]).intersection(shapely.union_all(rooms[1]))
    rise = high.elevation - low.elevation
    center, turn = np.asarray(item.center[:2]), rotation2(yaw_of(item))
    axes = {"+x": turn[:, 0], "-x": -turn[:, 0], "+y": turn[:, 1], "-y": -turn[:, 1]}
    wish = item.attributes.get("up")
    choices = [axes[wish]] if isinstance(wish, str) and wish in axes else list(axes.values())
    half = item.ellipsoid.axes if item.ellipsoid else (0.6, 0.6, 1.0)
    best: tuple[float, Array, float, float] | None = None
    for ahead in choices:
        width = min(max(2 * min(half[0], half[1]), 0.9), 1.4)
        back, front = (_free(space, center, s * ahead, width) for s in (-1.0, 1.0))
        run = back + front - 2 * _LANDING
        if best is None or run > best[0] + 0.01:
            best = (run, ahead, back, width)
    assert best is not None
    run, ahead, back, width = best
    wanted = rise / math.tan(_SLOPE)
    if run <= 0 or math.atan2(rise, min(run, wanted)) > _STEEPEST:
        return None
    # The flight keeps to the object's place where there is more space than it needs.
    shift = min(max(back - _LANDING - wanted / 2, 0.0), max(run - wanted, 0.0))
    foot = center - ahead * (back - _LANDING - shift)
    head = foot + ahead * min(run, wanted)
    return Flight(
        item,
        lower,
        upper,
        np.array([*foot, low.elevation]),
        np.array([*head, high.elevation]),
        width,
    )


def _free(space: Any, start: Array, direction: Array, width: float) -> float:
    """How far a strip of ``width`` m reaches from ``start`` inside ``space``, m."""
    import shapely

    steps = np.arange(0.0, 30.0, 0.05)
    side = np.array([-direction[1], direction[0]]) * (width / 2 + 0.05)
    points = start + steps[:, None] * direction
    inside = np.all([shapely.contains_xy(space, points + s * side) for s in (-1, 0, 1)], axis=0)
    return float(steps[np.argmin(inside)]) if not inside.all() else float(steps[-1])


def build_flight(mesh: MeshBuilder, flight: Flight, levels: tuple[Level, ...], part: int) -> None:
    """Add the flight (steps for stairs, a slab for a ramp) and the sides of the hole above it."""
    foot, head = flight.foot, flight.head
    rise = float(head[2] - foot[2])
    if flight.object.category == "ramp":
        _slab(mesh, flight, part)
    else:
        count = max(round(rise / _STEP), 1)
        for i in range(count):
            strip = flight.strip(i / count, (i + 1) / count)
            top = float(foot[2] + rise * (i + 1) / count)
            mesh.prism(strip, max(top - 0.45, float(foot[2])), top - 1e-3 * (i == count - 1), part)
    lower = levels[flight.lower]
    ceiling = lower.elevation + min(
        lower.heights[r] for r in lower.rooms if r in flight.object.rooms
    )
    for start, end in edges(flight.hole):
        mesh.upright(end, start, ceiling, float(head[2]), part)


def _slab(mesh: MeshBuilder, flight: Flight, part: int) -> None:
    side = np.array([-flight.direction[1], flight.direction[0], 0.0]) * flight.width / 2
    a, b, up = flight.foot, flight.head, np.array([0.0, 0.0, 1.0])
    corners = [a - side, b - side, b + side, a + side]
    run = float(np.linalg.norm(b - a))
    uv = np.array([[0, 0], [run, 0], [run, flight.width], [0, flight.width]])
    mesh.quads([corners], uv, part)
    mesh.quads([[c - 0.15 * up for c in corners[::-1]]], uv[::-1], part)
    for i, j in ((0, 1), (2, 3)):
        p, q = corners[i], corners[j]
        mesh.quads([[p - 0.15 * up, q - 0.15 * up, q, p]], uv, part)
