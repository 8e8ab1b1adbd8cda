"""Which planes of the map a keyframe sees: what was not seen before is one only in its line."""

from __future__ import annotations

import math

import numpy as np
import pytest

from situgraph.slam.association import associate
from situgraph.slam.config import MapConfig
from situgraph.slam.planemap import MapPlane
from situgraph.slam.sightings import Sighting

CONFIG = MapConfig()
LEVEL = np.array([2.0, 6.0, 0.0])  # of the keyframe: just past the door from one room to the next
SPREAD = np.diag([0.003**2, 0.006**2])


def plane(number: int, normal: tuple[float, float], offset: float) -> MapPlane:
    made = MapPlane(number, 0, np.array([*normal, 0.0, offset]))
    low, high = sorted((0.0, float(made.tangent @ (0.0, 5.0))))
    made.intervals = [(low, high)]
    return made


WEST, EAST = plane(0, (1.0, 0.0), 0.0), plane(1, (-1.0, 0.0), 4.0)


def piece(x: float, y: tuple[float, float]) -> Sighting:
    """A piece of wall along y, both in the map, as the keyframe sees it."""
    ends = np.array([[x, y[0]], [x, y[1]]]) - LEVEL[:2]
    angle = 0.0 if x < LEVEL[0] else math.pi
    return Sighting(angle, abs(x - LEVEL[0]), ends, SPREAD, 0.2, 1.9, 100, 0.01, 1.9)


@pytest.mark.parametrize(
    ("step", "start", "known"),
    [(0.0, 5.1, True), (0.02, 5.1, True), (0.068, 5.1, False), (0.068, 3.0, True)],
)
def test_the_wall_of_the_next_room_is_the_same_only_in_one_line(
    step: float, start: float, known: bool
) -> None:
    """What was seen before may be off by the errors of the keyframe; what was not may not."""
    seen = [piece(4.0, (1.0, 5.0)), piece(0.0, (1.0, 4.5)), piece(step, (start, 9.0))]
    found = associate(seen, LEVEL, [WEST, EAST], CONFIG)
    assert found.plane == [1, 0, 0 if known else None]
