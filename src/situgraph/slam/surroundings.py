"""The keyframes whose free space tells about the robot's surroundings."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from situgraph.geometry.poses import Array, rotation2
from situgraph.slam.config import RoomConfig
from situgraph.slam.freespace import outline
from situgraph.slam.keyframes import Keyframe


class Nearby(NamedTuple):
    """``outlines``: free areas, polygons (n, 2) in the map; ``places`` (m, 2) of the keyframes."""

    outlines: list[Array]
    places: Array


class Surroundings:
    """One keyframe a place: the last one, so that driving in circles costs no more."""

    def __init__(self, config: RoomConfig) -> None:
        """No keyframe yet."""
        self._config = config
        self._kept: dict[int, dict[tuple[int, int], Keyframe]] = {}
        self._places: dict[int, Array] = {}

    def add(self, keyframe: Keyframe, pose: Array) -> None:
        """A further keyframe at ``pose`` (4x4)."""
        cell = tuple(np.floor(pose[:2, 3] / self._config.every).astype(int).tolist())
        self._kept.setdefault(keyframe.storey, {})[cell] = keyframe
        self._places[keyframe.number] = pose[:2, 3]

    def near(self, storey: int, place: Array, pose_of: Callable[[int], Array]) -> Nearby:
        """The keyframes of a storey that may see what lies around ``place`` (2,)."""
        reach = self._config.window + self._config.free_range
        outlines, places = [], []
        for keyframe in self._kept.get(storey, {}).values():
            if np.abs(self._places[keyframe.number] - place).max() > reach:
                continue
            pose = pose_of(keyframe.number)
            level = pose[:2, :2] @ keyframe.view.level[:2, :2].T
            yaw = float(np.arctan2(level[1, 0], level[0, 0]))
            self._places[keyframe.number] = pose[:2, 3]
            places.append(pose[:2, 3])
            shape = outline(keyframe.view.reach, self._config)
            outlines.append(shape @ rotation2(yaw).T + pose[:2, 3])
        return Nearby(outlines, np.array(places).reshape(-1, 2))
