"""Ways made pleasant to walk: straight where there is space, corners rounded."""

from __future__ import annotations

import itertools

import numpy as np

from situgraph.geometry.poses import Array
from situgraph.sim.floors import CELL, Floor

_SHORTCUT = 0.45  # m; where there is this much space the way is straightened


def straightened(way: Array, floor: Floor) -> Array:
    """The way with straight stretches where there is space to either side."""
    kept, i = [0], 0
    while i < len(way) - 1:
        j = len(way) - 1
        while j > i + 1:
            need = min(_SHORTCUT, float(floor.clear(way[i : j + 1]).min()))
            if float(floor.clear(line(way[i], way[j])).min()) >= need - 1e-9:
                break
            j = i + (j - i) // 2
        kept.append(max(j, i + 1))
        i = kept[-1]
    return np.concatenate([line(way[a], way[b]) for a, b in itertools.pairwise(kept)])


def smoothed(way: Array, floor: Floor, radius: float) -> Array:
    """Corners rounded as far as obstacles allow; the ends stay."""
    points = _resampled(way)
    for _ in range(150):
        new = points.copy()
        new[1:-1] = 0.5 * points[1:-1] + 0.25 * (points[:-2] + points[2:])
        worse = floor.clear(new) < np.minimum(floor.clear(points), radius) - 1e-9
        points = np.where(worse[:, None], points, new)
    return points


def _resampled(way: Array) -> Array:
    step = np.linalg.norm(np.diff(way, axis=0), axis=1)
    way = way[np.r_[True, step > 1e-9]]
    s = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(way, axis=0), axis=1))]
    at = np.linspace(0.0, s[-1], max(int(s[-1] / CELL) + 1, 2))
    return np.stack([np.interp(at, s, way[:, k]) for k in range(way.shape[1])], axis=1)


def line(a: Array, b: Array) -> Array:
    """Points (n, k) about a cell apart on the straight line from ``a`` (k,) to ``b`` (k,)."""
    count = max(int(np.linalg.norm(b - a) / CELL) + 1, 2)
    return np.linspace(a, b, count)
