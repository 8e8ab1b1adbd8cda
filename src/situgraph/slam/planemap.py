"""The wall planes of the map: where they lie and which parts of them were seen."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

import numpy as np

from situgraph.geometry.poses import Array
from situgraph.slam.config import MapConfig

Interval = tuple[float, float]


@dataclass
class MapPlane:
    """A wall face. ``plane`` (4,) n, d in the map, n into the room; of one ``storey``.

    ``parts`` are the pieces that widened it: keyframe and ends (2, 3) in base, so that they move
    with the keyframes; ``seen_by`` all keyframes that saw it; ``intervals`` the covered
    stretches along ``tangent``, ascending. ``top``
    (m) is how high over the floor it was seen, ``visible`` how high it could have been seen.
    """

    number: int
    storey: int
    plane: Array
    parts: list[tuple[int, Array]] = field(default_factory=list)
    intervals: list[Interval] = field(default_factory=list)
    sightings: int = 0
    seen_by: set[int] = field(default_factory=set)
    top: float = 0.0
    visible: float = 0.0

    def __post_init__(self) -> None:
        """Work out the plan line."""
        self.set_plane(self.plane)

    def set_plane(self, plane: Array) -> None:
        """Take over new coefficients (4,) and the line in the plan that follows from them.

        ``normal`` (2,) is its unit normal, ``offset`` (m) its offset, ``tangent`` (2,) the unit
        direction along the wall.
        """
        size = math.hypot(plane[0], plane[1])
        self.plane = plane
        self.normal: Array = plane[:2] / size
        self.offset = float(plane[3] / size)
        self.tangent: Array = np.array([-self.normal[1], self.normal[0]])

    @property
    def length(self) -> float:
        """Metres that were seen."""
        return sum(b - a for a, b in self.intervals)

    def certain(self, config: MapConfig) -> bool:
        """Whether it is a wall: seen often or long, and as high as it could be seen."""
        often = self.sightings >= config.certain_sightings or self.length >= config.certain_length
        return often and self.top >= config.wall_share * self.visible

    def point(self, along: float) -> Array:
        """The point (2,) of the line at ``along`` metres."""
        out: Array = -self.offset * self.normal + along * self.tangent
        return out

    def ends(self) -> Array:
        """First and last point (2, 2) seen."""
        return np.array([self.point(self.intervals[0][0]), self.point(self.intervals[-1][1])])

    @property
    def low(self) -> Array:
        """The least coordinates (2,) of what was seen."""
        out: Array = self.ends().min(axis=0)
        return out

    @property
    def high(self) -> Array:
        """The greatest coordinates (2,) of what was seen."""
        out: Array = self.ends().max(axis=0)
        return out

    def distance_along(self, low: float, high: float) -> float:
        """Gap (m) between [low, high] along the wall and the nearest stretch, 0 where they meet."""
        return min((max(a - high, low - b, 0.0) for a, b in self.intervals), default=np.inf)

    def covers(self, low: float, high: float) -> bool:
        """Whether one stretch holds all of [low, high]."""
        return any(a <= low and high <= b for a, b in self.intervals)


def united(intervals: Iterable[Interval], gap: float) -> list[Interval]:
    """The union of ``intervals``, gaps up to ``gap`` closed, ascending."""
    out: list[Interval] = []
    for a, b in sorted(intervals):
        if out and a - out[-1][1] <= gap:
            out[-1] = (out[-1][0], max(out[-1][1], b))
        else:
            out.append((a, b))
    return out


class PlaneMap:
    """All wall planes, by number; numbers are never used twice."""

    def __init__(self, interval_gap: float) -> None:
        """No plane yet."""
        self._gap = interval_gap
        self._next = 0
        self.planes: dict[int, MapPlane] = {}

    def new(self, storey: int, plane: Array) -> MapPlane:
        """A further plane (4,)."""
        made = MapPlane(self._next, storey, np.asarray(plane, dtype=float))
        self._next += 1
        self.planes[made.number] = made
        return made

    def widen(
        self, number: int, keyframe: int, ends: Array, heights: tuple[float, float], pose: Array
    ) -> None:
        """The keyframe at ``pose`` saw the plane between ``ends`` (2, 3), given in base.

        ``heights`` (m): how high over the floor, and how high it could have been seen.
        """
        plane = self.planes[number]
        plane.sightings += 1
        plane.seen_by.add(keyframe)
        plane.top = max(plane.top, heights[0])
        plane.visible = max(plane.visible, heights[1])
        low, high = self._span(plane, ends, pose)
        if not plane.covers(low, high):
            plane.parts.append((keyframe, ends))
            plane.intervals = united([*plane.intervals, (low, high)], self._gap)

    def place(self, number: int, coefficients: Array, pose_of: Callable[[int], Array]) -> None:
        """Take over a new estimate (4,); stretches follow their keyframes."""
        plane = self.planes[number]
        plane.set_plane(coefficients)
        spans = [self._span(plane, ends, pose_of(k)) for k, ends in plane.parts]
        plane.intervals = united(spans, self._gap)

    def merge(self, keep: int, drop: int, pose_of: Callable[[int], Array]) -> None:
        """Plane ``drop`` is plane ``keep``."""
        kept, gone = self.planes[keep], self.planes.pop(drop)
        kept.parts += gone.parts
        kept.seen_by |= gone.seen_by
        kept.sightings += gone.sightings
        kept.top, kept.visible = max(kept.top, gone.top), max(kept.visible, gone.visible)
        self.place(keep, kept.plane, pose_of)

    def on(self, storey: int) -> list[MapPlane]:
        """The planes of a storey."""
        return [p for p in self.planes.values() if p.storey == storey]

    @staticmethod
    def _span(plane: MapPlane, ends: Array, pose: Array) -> Interval:
        xy = ends @ pose[:2, :3].T + pose[:2, 3]
        along = xy @ plane.tangent
        return float(along.min()), float(along.max())
