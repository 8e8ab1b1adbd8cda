"""From rooms to visit in order to places to look around from, and the ways between them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from situgraph.errors import InputError
from situgraph.geometry.poses import Array
from situgraph.sim.config import RobotConfig
from situgraph.sim.flights import Flight
from situgraph.sim.floors import CELL, Floor
from situgraph.sim.paths import line, smoothed, straightened
from situgraph.sim.world import World

_LEG_IN = 0.45  # m; a flight is entered and left this far off its ends


@dataclass(frozen=True, eq=False)
class Leg:
    """A way (n, 3) on the floor (m, building frame) and how far to turn at its end (radians)."""

    path: Array
    look: float


class Ground:
    """All storeys of a world as floors to walk on."""

    def __init__(self, world: World, config: RobotConfig) -> None:
        self.world = world
        self.config = config
        self.floors = tuple(Floor(world, i, config) for i in range(len(world.levels)))
        self._level: Mapping[str, int] = {
            room: i for i, level in enumerate(world.levels) for room in level.rooms
        }

    def level_of(self, room: str) -> int:
        """The number of the level that ``room`` is on.

        Raises:
            InputError: there is no such room in the world.
        """
        if room not in self._level:
            raise InputError(
                self.world.graph.name or "plan",
                f"no room {room!r} to visit",
                f"rooms are {', '.join(list(self._level)[:20])}",
            )
        return self._level[room]

    def viewpoints(self, room: str) -> list[Array]:
        """Places (2,) in ``room`` from which its walls are seen from near, the best one first."""
        floor, shape = (
            self.floors[self.level_of(room)],
            self.world.levels[self.level_of(room)].rooms[room],
        )
        cells = np.argwhere(floor.main & floor.inside(shape))
        xy = floor.corner + CELL * cells[:, ::-1]
        if len(xy) == 0:
            return []
        room_for = floor.clear(xy)
        # The middle of the room and other places with space, thinned to what a look needs.
        xy = xy[room_for >= min(0.6, 0.8 * float(room_for.max()))]
        xy = xy[np.unique(np.rint(xy / 0.4), axis=0, return_index=True)[1]]
        seen = _visible(xy, shape, self.config.look_radius)
        comfort = floor.clear(xy) * 1e-3 * seen.shape[1]
        chosen: list[int] = []
        left = np.ones(seen.shape[1], dtype=bool)
        while left.any() and len(chosen) < 40:
            gain = seen[:, left].sum(axis=1)
            best = int(np.argmax(gain + comfort))
            if chosen and gain[best] < max(2, 0.08 * seen.shape[1]):
                break
            chosen.append(best)
            left &= ~seen[best]
        return [xy[i] for i in chosen]

    def way(self, a: tuple[int, Array], b: tuple[int, Array]) -> Array | None:
        """The way (n, 3) between places (level, point), over flights if need be; None: none."""
        flights = self._flights(a[0], b[0])
        if flights is None:
            return None
        parts, level, at = [], a[0], a[1]
        for flight in flights:
            up = flight.lower == level
            near, far = (flight.foot, flight.head) if up else (flight.head, flight.foot)
            step = flight.direction * (_LEG_IN if up else -_LEG_IN)
            walked = self._smoothed(level, at, near[:2] - step)
            if walked is None:
                return None
            parts += [walked, line(near, far)]
            level, at = (flight.upper if up else flight.lower), far[:2] + step
        walked = self._smoothed(level, at, b[1])
        return None if walked is None else np.concatenate([*parts, walked])

    def _smoothed(self, level: int, start: Array, goal: Array) -> Array | None:
        floor = self.floors[level]
        cells = floor.way(start, goal)
        if cells is None:
            return None
        way = np.vstack([start, cells[1:-1], goal]) if len(cells) > 2 else np.vstack([start, goal])
        way = smoothed(straightened(way, floor), floor, self.config.radius)
        height = np.full((len(way), 1), self.world.levels[level].elevation)
        return np.concatenate([way, height], axis=1)

    def _flights(self, start: int, goal: int) -> list[Flight] | None:
        """The fewest flights from one level to another."""
        ways: dict[int, list[Flight]] = {start: []}
        queue = [start]
        while queue:
            here = queue.pop(0)
            for flight in self.world.flights:
                for a, b in ((flight.lower, flight.upper), (flight.upper, flight.lower)):
                    if a == here and b not in ways:
                        ways[b] = [*ways[here], flight]
                        queue.append(b)
        return ways.get(goal)


def plan_route(
    ground: Ground, rooms: Sequence[str], rng: np.random.Generator
) -> tuple[list[Leg], tuple[str, ...]]:
    """The legs of a drive through ``rooms`` in order, and sentences about rooms passed over.

    With no ``rooms``, all that can be reached from the first storey's first room are visited, the
    nearest next.

    Raises:
        InputError: a room asked for does not exist or cannot be reached.
    """
    asked = bool(rooms)
    names = list(rooms) or [r for level in ground.world.levels for r in level.rooms]
    views = {
        room: [(ground.level_of(room), p) for p in ground.viewpoints(room)]
        for room in dict.fromkeys(names)
    }
    first = next((r for r in names if views[r]), None)
    if first is None:
        raise InputError(ground.world.graph.name or "plan", "no room has space for the robot", "")
    order = names if asked else _nearest_first(ground, first, views)
    here = views[first][0]
    legs = [_stand(ground, here, _turn(ground.config, rng))]
    missing: list[str] = []
    for number, room in enumerate(order):
        stops = _ordered(here, views[room])
        if number == 0:
            stops = [s for s in stops if s is not here]
        ways = 0
        for stop in stops:
            path = ground.way(here, stop)
            if path is None:
                continue
            legs.append(Leg(path, _turn(ground.config, rng)))
            here, ways = stop, ways + 1
        if ways == 0 and number > 0:
            if asked:
                plan = ground.world.graph.name or "plan"
                raise InputError(plan, f"room {room} cannot be reached", "leave it out")
            missing.append(room)
    missing += [r for r in names if r not in order]
    return legs, (f"cannot be reached: {', '.join(missing)}",) if missing else ()


def _turn(config: RobotConfig, rng: np.random.Generator) -> float:
    return config.look_turn * (1.0 if rng.random() < 0.5 else -1.0)


def _stand(ground: Ground, at: tuple[int, Array], look: float) -> Leg:
    height = ground.world.levels[at[0]].elevation
    return Leg(np.array([[*at[1], height], [*at[1], height]]), look)


def _nearest_first(
    ground: Ground, first: str, views: Mapping[str, list[tuple[int, Array]]]
) -> list[str]:
    """Rooms in the order of the shortest way on, from ``first``; unreachable ones left out."""
    order, left = [first], [r for r in views if r != first and views[r]]
    while left:
        here = views[order[-1]][0]
        away = _distances(ground, here)
        ways = [away(views[r][0]) for r in left]
        best = int(np.argmin(ways))
        if not np.isfinite(ways[best]):
            break
        order.append(left.pop(best))
    return order


def _distances(ground: Ground, here: tuple[int, Array]) -> Callable[[tuple[int, Array]], float]:
    """How far places are from ``here``; a storey is finished before the next."""
    field = ground.floors[here[0]].distances(here[1])

    def away(place: tuple[int, Array]) -> float:
        if place[0] == here[0]:
            return float(field[ground.floors[here[0]].cell(place[1])])
        return np.inf if ground.way(here, place) is None else 1e6 * abs(place[0] - here[0])

    return away


def _ordered(here: tuple[int, Array], stops: list[tuple[int, Array]]) -> list[tuple[int, Array]]:
    """Stops of one room, the nearest next."""
    left, order, at = list(stops), [], here[1]
    while left:
        best = min(range(len(left)), key=lambda i: float(np.linalg.norm(left[i][1] - at)))
        order.append(left.pop(best))
        at = order[-1][1]
    return order


def _visible(places: Array, shape: Any, radius: float) -> NDArray[np.bool_]:
    """Which points along the walls (k of them) each place (n, 2) sees from within ``radius`` m."""
    import shapely

    count = max(int(shape.exterior.length / 0.5) if hasattr(shape, "exterior") else 8, 4)
    marks = [shape.boundary.interpolate(f, normalized=True) for f in np.arange(count) / count]
    targets = np.array([m.coords[0] for m in marks])
    ends = np.stack(np.broadcast_arrays(places[:, None], targets[None]), axis=2)
    lines = shapely.linestrings(ends.reshape(-1, 2, 2))
    roomy = shape.buffer(0.05)
    shapely.prepare(roomy)
    inside = shapely.covers(roomy, lines).reshape(len(places), count)
    near = np.linalg.norm(places[:, None] - targets[None], axis=2) <= radius
    return np.asarray(inside & near)
