"""Numbers as they go into the graph: no noise in the last digits, no negative zeros.

A micrometre is far below what a building model means, and the same on every machine.
"""

from __future__ import annotations

from collections.abc import Iterable

METRE_DIGITS = 6
DIRECTION_DIGITS = 9  # a unit normal stays one to 1e-9


def metres(value: float) -> float:
    """A length or coordinate to the micrometre."""
    return round(float(value), METRE_DIGITS) + 0.0


def point2(values: Iterable[float]) -> tuple[float, float]:
    """A plan-view point to the micrometre."""
    x, y = values
    return metres(x), metres(y)


def point3(values: Iterable[float]) -> tuple[float, float, float]:
    """A point, or three lengths, to the micrometre."""
    x, y, z = values
    return metres(x), metres(y), metres(z)


def horizontal(values: Iterable[float]) -> tuple[float, float, float]:
    """A horizontal unit vector of the plan as one in space."""
    x, y = (round(float(v), DIRECTION_DIGITS) + 0.0 for v in values)
    return x, y, 0.0
