"""Shifts in height that map online storeys onto prior storeys.

Section 3 of ``docs/matching.md``.
"""

from __future__ import annotations

import numpy as np

from situgraph.matching.tables import Floats, Ints


def storey_shifts(online: Floats, prior: Floats, tolerance: float) -> tuple[Floats, Ints]:
    """Shifts (k,) in ascending order, and for each the prior storey of each online storey, or -1.

    Args:
        online: elevations of the online storeys that hold rooms, ascending and distinct, metres.
        prior: the same of the prior.
        tolerance: storeys this near in height are one, metres.
    """
    if len(online) == 1 and len(prior) == 1:  # the usual case, quickly
        return prior - online, np.zeros((1, 1), dtype=np.int64)
    if not len(online) or not len(prior):
        return np.zeros(0), np.zeros((0, len(online)), dtype=np.int64)
    heights = np.unique(prior[None, :] - online[:, None])
    groups: dict[tuple[int, ...], list[list[float]]] = {}
    for z in heights.tolist():
        gaps = np.abs(online[:, None] + z - prior[None, :])
        nearest = gaps.argmin(axis=1)
        reached = gaps[np.arange(len(online)), nearest] <= tolerance + 1e-9
        runs = groups.setdefault(tuple(np.where(reached, nearest, -1).tolist()), [])
        if runs and z - runs[-1][0] <= tolerance:
            runs[-1].append(z)
        else:
            runs.append([z])
    shifts = sorted((float(np.mean(run)), key) for key, runs in groups.items() for run in runs)
    return np.array([z for z, _ in shifts]), np.array([key for _, key in shifts], dtype=np.int64)
