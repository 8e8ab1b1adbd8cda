"""Rooms over time: found, widened, split and merged, with ids that stay.

Each look divides the surroundings of the robot anew. A region that passes every test is a room; a
region that does not leaves a reason. A room that was found before keeps its id when the new one
covers most of it, and stays as it was where a look shows less than an earlier one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from situgraph.geometry.poses import Array
from situgraph.slam.config import RoomConfig
from situgraph.slam.footprints import Footprint, Side, footprint
from situgraph.slam.planemap import MapPlane
from situgraph.slam.raster import Mask
from situgraph.slam.regions import Plan, look


class Reason(NamedTuple):
    """Why free space at ``place`` (m) was not made a room: a stable ``code`` and a sentence."""

    code: str
    sentence: str
    place: tuple[float, float]


@dataclass
class MapRoom:
    """A room of the map: its number, storey and outline; ``shape`` is the same as a polygon."""

    number: int
    storey: int
    footprint: Footprint
    shape: Any
    entered: bool

    @property
    def planes(self) -> tuple[int, ...]:
        """Numbers of the planes around it."""
        return self.footprint.planes

    @property
    def corridor(self) -> bool:
        """Whether it is known by its two long sides only."""
        return len(self.planes) == 2


class RoomBook:
    """All rooms, by number; numbers are never used twice."""

    def __init__(self, config: RoomConfig) -> None:
        """No room yet."""
        self._config = config
        self._next = 0
        self._reasons: dict[tuple[int, int, int], Reason] = {}
        self.rooms: dict[int, MapRoom] = {}

    @property
    def reasons(self) -> tuple[Reason, ...]:
        """Why the remaining free space is no room, by place."""
        return tuple(self._reasons[k] for k in sorted(self._reasons))

    def update(
        self,
        storey: int,
        place: Array,
        outlines: Sequence[Array],
        visited: Array,
        planes: Sequence[MapPlane],
    ) -> bool:
        """Look around the robot again; returns whether anything about the rooms changed.

        Args:
            storey: the one the robot is on.
            place: (2,) of the robot.
            outlines: free areas seen nearby, polygons (n, 2).
            visited: (n, 2) places where the robot was.
            planes: the walls of the storey.
        """
        half = self._config.window
        plan = look(place, half, outlines, planes, self._config)
        while self._home_is_cut(plan, place) and half < self._config.widest_window:
            half *= 1.5
            plan = look(place, half, outlines, planes, self._config)
        self._forget_reasons(storey, place, half)
        found: list[tuple[Footprint, Any, bool]] = []
        for region, cut in zip(plan.regions, plan.cut):
            outcome = self._judge(plan, region, cut, visited)
            if isinstance(outcome, Reason):
                x, y = outcome.place
                self._reasons[(storey, round(x), round(y))] = outcome
            else:
                found.append(outcome)
        return self._settle(storey, found)

    def follow(self, planes: dict[int, MapPlane]) -> None:
        """Outlines follow their planes, which the graph may have moved; drops none."""
        for room in self.rooms.values():
            moved = _follow(room.footprint, planes)
            if moved is not None:
                room.footprint, room.shape = moved

    def rename_plane(self, keep: int, drop: int) -> None:
        """Plane ``drop`` is now plane ``keep``."""
        for room in self.rooms.values():
            sides = tuple(
                s._replace(plane=keep) if s.plane == drop else s for s in room.footprint.sides
            )
            room.footprint = room.footprint._replace(sides=sides)

    def _home_is_cut(self, plan: Plan, place: Array) -> bool:
        return any(
            cut and bool(plan.raster.look(region, place[None])[0])
            for region, cut in zip(plan.regions, plan.cut)
        )

    def _forget_reasons(self, storey: int, place: Array, half: float) -> None:
        for key in list(self._reasons):
            if key[0] == storey and np.abs(np.array(key[1:]) - place).max() <= half:
                del self._reasons[key]

    def _judge(
        self, plan: Plan, region: Mask, cut: bool, visited: Array
    ) -> Reason | tuple[Footprint, Any, bool]:
        import shapely

        c = self._config
        middle = plan.raster.centres(region).mean(axis=0)
        at = (float(middle[0]), float(middle[1]))
        name = f"room candidate at ({at[0]:.1f}, {at[1]:.1f})"
        if cut:
            return Reason("room-cut", f"{name}: goes on beyond {c.widest_window:g} m", at)
        outline = footprint(region, plan.raster, plan.planes, plan.doorways, c)
        if outline is None:
            return Reason("room-without-walls", f"{name}: no wall bounds it", at)
        seen = sum(s.seen for s in outline.sides)
        count = len(outline.planes)
        walls = f"only {count} plane{'s' * (count != 1)}, seen {seen:.1f} m of wall"
        if count < 2:
            return Reason("room-one-wall", f"{name}: {walls}", at)
        shape = shapely.Polygon(outline.corners)
        width = _width(shape)
        if outline.area < c.least_area or width < c.least_width:
            return Reason("room-small", f"{name}: {outline.area:.1f} m2, {width:.1f} m wide", at)
        inner = shape.buffer(-c.entered_margin)
        entered = bool(shapely.contains_xy(inner, visited).any()) if len(visited) else False
        needed = c.least_closed if entered else c.least_closed_unentered
        if outline.closed < needed:
            how = "" if entered else "not entered and "
            return Reason(
                "room-open",
                f"{name}: {how}{outline.closed:.0%} of its outline is wall, {count} planes, "
                f"needed {needed:.0%}",
                at,
            )
        return outline, shape, entered

    def _settle(self, storey: int, found: list[tuple[Footprint, Any, bool]]) -> bool:
        """Give the rooms found their numbers; drop old ones that others now cover."""
        old = [r for r in self.rooms.values() if r.storey == storey]
        overlaps = sorted(
            (
                (-room.shape.intersection(shape).area, room.number, i)
                for room in old
                for i, (_, shape, _) in enumerate(found)
                if room.shape.intersects(shape)
            ),
        )
        number_of: dict[int, int] = {}
        for area, number, i in overlaps:
            smaller = min(self.rooms[number].shape.area, found[i][1].area)
            if number in number_of.values() or i in number_of or -area < 0.5 * smaller:
                continue
            number_of[i] = number
        changed = False
        for i, (outline, shape, entered) in enumerate(found):
            if i not in number_of:
                number_of[i], self._next = self._next, self._next + 1
                new = MapRoom(number_of[i], storey, outline, shape, entered)
                self.rooms[new.number] = new
                changed = True
                continue
            room = self.rooms[number_of[i]]
            changed |= room.planes != outline.planes
            room.footprint, room.shape = outline, shape
            room.entered |= entered
        for room in old:
            if room.number in number_of.values():
                continue
            covered = sum(room.shape.intersection(s).area for _, s, _ in found)
            if covered > 0.5 * room.shape.area:
                del self.rooms[room.number]
                changed = True
        return changed


def _width(shape: Any) -> float:
    """The shorter side (m) of the smallest rectangle around a polygon."""
    corners = np.asarray(shape.minimum_rotated_rectangle.exterior.coords)
    return float(np.linalg.norm(np.diff(corners[:3], axis=0), axis=1).min())


def _follow(outline: Footprint, planes: dict[int, MapPlane]) -> tuple[Footprint, Any] | None:
    """The outline with its sides on the planes' present lines; None where it would fold."""
    import shapely

    lines = []
    for side in outline.sides:
        plane = planes.get(side.plane) if side.plane is not None else None
        lines.append(side.line if plane is None else np.array([*plane.normal, plane.offset]))
    corners = []
    for before, after in zip([lines[-1], *lines[:-1]], lines):
        matrix = np.array([before[:2], after[:2]])
        if abs(np.linalg.det(matrix)) < 0.1:
            return None
        corners.append(np.linalg.solve(matrix, -np.array([before[2], after[2]])))
    shape = shapely.Polygon(corners)
    if not shape.is_valid or abs(shape.area - outline.area) > 0.2 * outline.area:
        return None
    sides: list[Side] = []
    for side, line, a, b in zip(outline.sides, lines, corners, [*corners[1:], corners[0]]):
        along = np.array([-line[1], line[0]])
        low, high = sorted((float(along @ a), float(along @ b)))
        sides.append(side._replace(line=line, low=low, high=high))
    centre = shape.centroid
    moved = Footprint(
        np.array(corners), tuple(sides), float(shape.area), (float(centre.x), float(centre.y))
    )
    return moved, shape
