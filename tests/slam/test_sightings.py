"""Pieces of wall in one scan: what stands near a wall's line is not of the wall."""

from __future__ import annotations

import numpy as np
import pytest

from situgraph.slam.config import PlaneConfig
from situgraph.slam.sightings import Sighting, sightings

NOISE = 0.01  # m


def standing(a: tuple[float, float], b: tuple[float, float], seed: int) -> tuple[np.ndarray, ...]:
    """Points (n, 3) of an upright face from ``a`` to ``b``, one in 0.1 m, and where they face.

    The sensor is at the origin.
    """
    rng = np.random.default_rng(seed)
    start, along = np.array(a), np.subtract(b, a)
    length = float(np.linalg.norm(along))
    s, z = (v.ravel() for v in np.meshgrid(np.arange(0.05, length, 0.1), np.arange(0.2, 1.9, 0.1)))
    normal = np.array([-along[1], along[0]]) / length
    normal *= -np.sign(normal @ start)
    xy = start + s[:, None] * along / length + rng.normal(0.0, NOISE, (s.size, 1)) * normal
    angles = np.arctan2(normal[1], normal[0]) + rng.normal(0.0, 0.05, s.size)
    return np.column_stack([xy, z]), angles


def longest(*faces: tuple[tuple[float, float], tuple[float, float]]) -> Sighting:
    parts = [standing(a, b, seed) for seed, (a, b) in enumerate(faces)]
    points, angles = (np.concatenate(v) for v in zip(*parts))
    return sightings(points, angles, PlaneConfig())[0]


WALL = ((1.5, 0.0), (1.5, 4.2))


def test_a_wall_alone_is_one_piece() -> None:
    found = longest(WALL)
    assert found.length == pytest.approx(4.1, abs=0.05)
    assert found.offset == pytest.approx(1.5, abs=0.004)


# The leaf of a door beside the wall's end: it hangs before the wall's face and swings towards it.
@pytest.mark.parametrize("tip", [1.56, 1.51, 1.46, 1.43])
def test_an_open_leaf_past_the_end_of_a_wall_is_not_of_the_wall(tip: float) -> None:
    jamb, leaf = ((1.36, -0.3), (1.36, -0.05)), ((1.36, -0.4), (tip, -1.3))
    found = longest(WALL, jamb, leaf)
    assert sorted(found.ends[:, 1].tolist()) == pytest.approx([0.05, 4.15], abs=0.08)
    assert np.abs(found.ends[:, 0] - 1.5).max() < 0.01
