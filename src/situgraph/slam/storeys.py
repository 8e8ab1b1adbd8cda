"""Storeys from the height of the robot: level again after a climb means another storey."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np

from situgraph.slam.config import StoreyConfig

BETWEEN = -1  # on stairs or a ramp


@dataclass
class MapStorey:
    """A storey: number, height of its floor in the map (m), keyframes on it."""

    number: int
    elevation: float
    keyframes: int = 0


class Storeys:
    """Tells on which storey the robot is, and when it is on the way between two."""

    def __init__(self, config: StoreyConfig) -> None:
        """No storey yet."""
        self._config = config
        self._recent: deque[float] = deque(maxlen=config.level_keyframes)
        self._standing: list[float] = []  # height of base over the floor, first keyframes
        self._first: list[float] = []  # heights of base until that is settled
        self.current = BETWEEN
        self.storeys: list[MapStorey] = []

    @property
    def settled(self) -> bool:
        """Whether enough keyframes saw the floor to know how high base stands over it."""
        return len(self._standing) >= self._config.standing_least

    @property
    def standing(self) -> float:
        """Usual height (m) of base over the floor: the largest one that keyframes agree on.

        What is taken for the floor where the floor is out of view (tables, sills) lies above it;
        now and then the ground outside is seen through a window, below it.
        """
        if not self.settled:
            return self._config.standing
        seen = np.array(self._standing)
        agree = (np.abs(seen[:, None] - seen) < self._config.level_range / 2).sum(axis=1)
        most = float(
            seen[agree >= max(2.0, self._config.standing_share * len(seen))].max(initial=0.0)
        )
        near = seen[np.abs(seen - most) < self._config.level_range / 2]
        return float(np.median(near)) if len(near) else float(np.median(seen))

    def at(self, height: float, floor: float | None) -> int:
        """The storey of a keyframe, or BETWEEN.

        Args:
            height: z of base in the map (m), as predicted.
            floor: z of the floor relative to base (m) as the scan shows it, None if it does not.
        """
        c = self._config
        if floor is not None and len(self._standing) < c.standing_keyframes:
            self._standing.append(-floor)
        foot = height - self.standing
        if not self.settled and len(self.storeys) <= 1:
            self._first.append(height)
        self._recent.append(foot)
        if not self.storeys:
            self.storeys.append(MapStorey(0, foot))
            self.current = 0
        elif self._first and len(self.storeys) == 1 and self._level(height):
            self.storeys[0].elevation = float(np.median(self._first)) - self.standing
            if self.settled:
                self._first.clear()
        elif self._off(foot):
            self.current = self._landed()
        if self.current != BETWEEN:
            self.storeys[self.current].keyframes += 1
        return self.current

    def _level(self, height: float) -> bool:
        """Whether the robot is as high as in the beginning, before it knew the floor."""
        return abs(height - float(np.median(self._first))) < self._config.slack

    def _off(self, foot: float) -> bool:
        return (
            self.current == BETWEEN
            or abs(foot - self.storeys[self.current].elevation) > self._config.slack
        )

    def _landed(self) -> int:
        """The storey under a robot that stays level, BETWEEN while it does not."""
        c = self._config
        recent = np.array(self._recent)
        if len(recent) < c.level_keyframes or np.ptp(recent) > c.level_range:
            return BETWEEN
        foot = float(np.median(recent))
        nearest = min(self.storeys, key=lambda s: abs(s.elevation - foot))
        if abs(nearest.elevation - foot) < c.least_height:
            return nearest.number
        self.storeys.append(MapStorey(len(self.storeys), foot))
        return len(self.storeys) - 1
