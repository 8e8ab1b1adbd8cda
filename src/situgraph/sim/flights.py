"""Stairs and ramps that join storeys: straight flights of a slope a walking robot can climb."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from situgraph.geometry.poses import Array, rotation2
from situgraph.scenegraph.graph import Object, SceneGraph
from situgraph.sim.levels import Level
from situgraph.sim.mesh import MeshBuilder, edges
from situgraph.sim.openings import yaw_of

CATEGORIES = frozenset({"stair", "stairs", "ramp"})

_SLOPE = math.radians(32.0)  # of a comfortable stair
_STEEPEST = math.radians(48.0)
_LANDING = 0.75  # m, free floor at the foot and at the head
_ASIDE = 1.5  # m; a flight may stand this far beside its place in the plan
_DOORWAY = 0.7  # m; and keeps this far off doors
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
    def approach(self) -> Any:
        """The plan view of the flight and its landings: what has to be free of furniture."""
        run = float(np.linalg.norm((self.head - self.foot)[:2]))
        return self.strip(-_LANDING / run, 1.0 + _LANDING / run)

    @property
    def low_part(self) -> Any:
        """What stands in the way on the lower floor."""
        return self.strip(0.0, 1.0)


def flights_of(
    plan: SceneGraph, levels: tuple[Level, ...]
) -> tuple[tuple[Flight, ...], tuple[str, ...]]:
    """The flights between neighbouring levels, and sentences about those that do not fit.

    A flight stands for each object of category stairs or ramp whose rooms are on two levels, near
    the object's centre. It goes up along one of the object's own axes, where there is most space;
    the attribute ``up`` (``+x``, ``-x``, ``+y``, ``-y``) says otherwise.
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
    """The flight along the axis with the most space, beside a wall so that one can pass it."""
    low, high = levels[lower], levels[upper]
    rooms, body = _space(item, low, high)
    rise = high.elevation - low.elevation
    center, turn = np.asarray(item.center[:2]), rotation2(yaw_of(item))
    axes = {"+x": turn[:, 0], "-x": -turn[:, 0], "+y": turn[:, 1], "-y": -turn[:, 1]}
    wish = item.attributes.get("up")
    choices = [axes[wish]] if isinstance(wish, str) and wish in axes else list(axes.values())
    half = item.ellipsoid.axes if item.ellipsoid else (0.6, 0.6, 1.0)
    width = min(max(2 * min(half[0], half[1]), 0.9), 1.2)
    wanted = rise / math.tan(_SLOPE)
    best: tuple[float, float, Array, Array] | None = None
    for ahead in choices:
        side = np.array([-ahead[1], ahead[0]])
        for aside in np.arange(-_ASIDE, _ASIDE + 0.01, 0.1):
            at = center + aside * side
            back, front = (_room_for(rooms, body, at, s * ahead, width) for s in (-1.0, 1.0))
            run = min(back + front, wanted)
            lane = max(_free(rooms, at + k * side * width / 2, k * side, 0.0) for k in (-1.0, 1.0))
            # First a gentle slope, then a lane to walk past it.
            if best is None or (round(run, 1), lane) > best[:2]:
                middle = np.clip(0.0, run / 2 - back, front - run / 2)
                best = (round(run, 1), lane, at + float(middle) * ahead, ahead)
    assert best is not None
    run, _, at, ahead = best
    if run <= 0 or math.atan2(rise, run) > _STEEPEST:
        return None
    foot, head = at - ahead * run / 2, at + ahead * run / 2
    ends = (np.array([*foot, low.elevation]), np.array([*head, high.elevation]))
    return Flight(item, lower, upper, *ends, width)


def _room_for(rooms: Any, body: Any, at: Array, direction: Array, width: float) -> float:
    """How far a flight can reach from ``at``: clear of doors, with a landing before the wall."""
    landing = _free(rooms, at, direction, width) - _LANDING
    return max(min(landing, _free(body, at, direction, width)), 0.0)


def _space(item: Object, low: Level, high: Level) -> tuple[Any, Any]:
    """The plan view common to its rooms on both levels, and what of it is clear of doors."""
    import shapely

    rooms, lanes = [], []
    for level in (low, high):
        rooms.append(shapely.union_all([level.rooms[r] for r in item.rooms if r in level.rooms]))
        for o in level.openings:
            if o.object.category == "door":
                reach = o.across * (o.depth / 2 + _DOORWAY)
                line = shapely.LineString([o.middle - reach, o.middle + reach])
                lanes.append(line.buffer(o.width / 2, cap_style="flat"))
    common = rooms[0].intersection(rooms[1])
    return common, common.difference(shapely.union_all(lanes))


def _free(space: Any, start: Array, direction: Array, width: float) -> float:
    """How far a strip of ``width`` m reaches from ``start`` inside ``space``, m."""
    import shapely

    steps = np.arange(0.0, 30.0, 0.05)
    half = max(width / 2 - 0.02, 0.0)
    side = np.array([-direction[1], direction[0]]) * half
    points = start + (steps[:, None] + 0.01) * direction
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
