"""How large a plan is, however its frame is turned."""

from __future__ import annotations

import numpy as np

from situgraph.matching.tables import Floats


def area_of(center: Floats, height: Floats, margin: float) -> float:
    """Where a robot may be, in square metres: for each storey the smallest rectangle, grown.

    Args:
        center: (M, 2) of the rooms, metres.
        height: (M,) of their storeys.
        margin: by which the rectangle of the centres is grown on each side, metres.
    """
    storeys = [_rectangle(center[height == z], margin) for z in np.unique(height)]
    return sum(storeys) or (2 * margin) ** 2


def _rectangle(points: Floats, margin: float) -> float:
    """The area of the smallest rectangle around points (n, 2): it lies along a side of the hull."""
    hull = _hull(points)
    side = np.roll(hull, -1, axis=0) - hull
    length = np.hypot(side[:, 0], side[:, 1])
    along = side[length > 0] / length[length > 0, None]
    if not len(along):
        return (2 * margin) ** 2
    across = along[:, ::-1] * (-1.0, 1.0)
    wide, tall = (np.ptp(hull @ axis.T, axis=0) + 2 * margin for axis in (along, across))
    return float((wide * tall).min())


def _hull(points: Floats) -> Floats:
    """The corners of the convex hull, counterclockwise (Andrew's monotone chain)."""
    order = np.unique(_outer(points), axis=0)
    corners: list[tuple[float, float]] = []
    for half in (order, order[::-1]):
        begin = len(corners)
        for x, y in half.tolist():
            while len(corners) >= begin + 2 and not _turns_left(corners[-2], corners[-1], (x, y)):
                corners.pop()
            corners.append((x, y))
        corners.pop()
    return np.array(corners or order.tolist())


def _outer(points: Floats) -> Floats:
    """Those that are not inside of the polygon of the farthest ones in eight directions."""
    angle = np.arange(8) * (np.pi / 4)
    far = points[np.argmax(points @ np.array([np.cos(angle), np.sin(angle)]), axis=0)]
    side = np.roll(far, -1, axis=0) - far
    real = (side != 0).any(axis=1)
    side, away = side[real], points[:, None] - far[real]
    inside = side[:, 0] * away[..., 1] - side[:, 1] * away[..., 0] > 0
    kept: Floats = points[~inside.all(axis=1)] if real.any() else points[:1]
    return kept


def _turns_left(
    one: tuple[float, float], two: tuple[float, float], then: tuple[float, float]
) -> bool:
    return (two[0] - one[0]) * (then[1] - one[1]) > (two[1] - one[1]) * (then[0] - one[0])
