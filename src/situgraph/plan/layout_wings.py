"""Wings at odd angles around a hall with as many sides as it takes."""

from __future__ import annotations

import itertools
import math

import numpy as np

from situgraph.geometry.poses import Array, rotation2
from situgraph.plan.floor import Floor, from_outlines, joined
from situgraph.plan.layout_config import LayoutConfig

Rng = np.random.Generator

# Neighbouring wings leave this angle between them, so that their feet do not touch.
NARROWEST = math.radians(70.0)


def wings_floor(rooms: int, config: LayoutConfig, rng: Rng, symmetric: bool = False) -> Floor:
    """Two to four wings, each a row of rooms on both sides of a corridor, around a polygonal hall.

    The hall is the first room. ``symmetric`` floors map onto themselves by a half turn about the
    origin: wings come in opposite pairs, and an even number of rooms splits the hall in two.
    """
    halls = 2 if symmetric and rooms % 2 == 0 else 1
    share = _shares(rooms - halls, symmetric, rng)
    angles = _angles(len(share), symmetric, rng)
    depth = 4.0 * config.module
    half = depth + 0.5 * config.corridor_width
    gaps = np.diff(np.concatenate([angles, angles[:1] + 2.0 * math.pi]))
    reach = half / math.tan(0.5 * min(float(gaps.min()), 0.5 * math.pi)) * rng.uniform(1.02, 1.15)
    feet = [_foot(a, reach, half) for a in angles]
    hall = np.concatenate(feet if len(feet) > 1 else [*feet, -feet[0]])
    thickness = rng.uniform(config.thickness_min, config.thickness_max)
    if halls == 2:
        k = len(hall) // 2
        parts = [hall[: k + 1], np.concatenate([hall[k:], hall[:1]])]
    else:
        parts = [hall]
    floors = [from_outlines(parts, np.full(halls, thickness))]
    drawn: list[tuple[list[Array], Array]] = []
    for i, (count, angle) in enumerate(zip(share, angles, strict=False)):
        opposite = i - len(share) // 2
        if symmetric and opposite >= 0:
            outlines, thick = drawn[opposite]
        else:
            outlines = _wing(count, reach, depth, config, rng)
            thick = rng.uniform(config.thickness_min, config.thickness_max, count)
            drawn.append((outlines, thick))
        turn = rotation2(angle).T
        floors.append(from_outlines([o @ turn for o in outlines], thick))
    return joined(floors)


def _shares(rooms: int, symmetric: bool, rng: Rng) -> list[int]:
    """How many rooms each wing gets; none gets zero."""
    if rooms == 0:
        return []
    if symmetric:
        pairs = min(rooms // 2, int(rng.integers(1, 3)))
        half = rooms // 2
        first = [half] if pairs == 1 else [half - half // 2, half // 2]
        return first * 2
    wings = min(rooms, int(rng.integers(3, 5)))
    return [len(part) for part in np.array_split(np.arange(rooms), wings)]


def _angles(wings: int, symmetric: bool, rng: Rng) -> Array:
    """Directions of the wings, rising, never a multiple of a right angle apart but by chance."""
    if wings == 0:
        return np.zeros(1)
    if symmetric:
        half = wings // 2
        first = np.array([0.0, rng.uniform(NARROWEST, math.pi - NARROWEST)])[:half]
        return np.concatenate([first, first + math.pi])
    spare = 2.0 * math.pi - wings * NARROWEST
    weights = rng.dirichlet(np.full(wings, 2.0))
    gaps = NARROWEST + spare * weights
    return np.concatenate([[0.0], np.cumsum(gaps)[:-1]])


def _foot(angle: float, reach: float, half: float) -> Array:
    """The two corners of the hall where a wing of width ``2 * half`` begins."""
    return np.array([(reach, -half), (reach, half)]) @ rotation2(angle).T


def _wing(count: int, start: float, depth: float, config: LayoutConfig, rng: Rng) -> list[Array]:
    """``count`` outlines along +x from ``start``: a corridor, then rooms to its right and left."""
    half = 0.5 * config.corridor_width
    if count < 3:
        length = start + 0.5 * config.module * np.cumsum(rng.integers(6, 12, count))
        ends = np.concatenate([[start], length])
        width = half + depth
        return [_box(a, -width, b, width) for a, b in itertools.pairwise(ends)]
    right = (count - 1) // 2
    sides = []
    for number, low, high in (
        (right, -half - depth, -half),
        (count - 1 - right, half, half + depth),
    ):
        ends = start + 0.5 * config.module * np.cumsum(rng.integers(5, 10, number))
        starts = np.concatenate([[start], ends])[:-1]
        sides += [_box(a, low, b, high) for a, b in zip(starts, ends, strict=True)]
    far = max(float(s[:, 0].max()) for s in sides)
    return [_box(start, -half, far, half), *sides]


def _box(x0: float, y0: float, x1: float, y1: float) -> Array:
    return np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])
