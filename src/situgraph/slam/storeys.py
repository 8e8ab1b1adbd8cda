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
        self.current = BETWEEN
        self.storeys: list[MapStorey] = []

    @property
    def standing(self) -> float:
        """Usual height (m) of base over the floor."""
        return float(np.median(self._standing)) if self._standing else self._config.standing

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
        self._recent.append(foot)
        if not self.storeys:
            self.storeys.append(MapStorey(0, foot))
            self.current = 0
        elif self._off(foot):
            self.current = self._landed()
        if self.current != BETWEEN:
            self.storeys[self.current].keyframes += 1
        return self.current

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
