"""A solution of a match in a few words."""

from __future__ import annotations

import math

import numpy as np

from situgraph.geometry.poses import wrap_angle
from situgraph.scenegraph.graph import SceneGraph
from situgraph.view.lettering import metres, percent
from situgraph.view.record import Solution


def figures(solution: Solution, rooms: int) -> str:
    """One line: rooms explained, probability, fit, moved walls."""
    parts = [f"{len(solution.rooms)} of {rooms} rooms explained"]
    if solution.probability is not None:
        parts.append(f"probability {percent(solution.probability)}")
    if solution.rms is not None:
        parts.append(f"residual {metres(solution.rms)} rms")
    if solution.objects:
        parts.append(f"{len(solution.objects)} objects agree")
    if solution.deviations:
        parts.append(f"{len(solution.deviations)} wall{'s' * (len(solution.deviations) > 1)} moved")
    return "  ·  ".join(parts)


def difference(best: Solution, other: Solution, online: SceneGraph) -> str:
    """What sets a rival apart from the best solution, in a few words."""
    parts = []
    turn = math.degrees(abs(float(wrap_angle(other.transform.yaw - best.transform.yaw))))
    if turn > 1.0:
        parts.append(f"turned {turn:.0f}°")
    centers = np.array([r.center for r in online.rooms], dtype=float).reshape(-1, 3)
    if len(centers):
        step = other.transform.points(centers).mean(axis=0) - best.transform.points(centers).mean(
            axis=0
        )
        if np.linalg.norm(step[:2]) > 0.3:
            parts.append(f"{np.linalg.norm(step[:2]):.1f} m away")
        if abs(step[2]) > 0.8:
            parts.append("other storey")
    elsewhere = sum(1 for r, a in best.rooms.items() if other.rooms.get(r) != a)
    if elsewhere:
        parts.append(f"{elsewhere} of {len(best.rooms)} rooms elsewhere")
    for count, reference, what in (
        (len(other.rooms), len(best.rooms), "rooms"),
        (len(other.objects), len(best.objects), "objects"),
        (len(other.deviations), len(best.deviations), "moved walls"),
    ):
        if count != reference:
            parts.append(f"{count} {what} (not {reference})")
    return ", ".join(parts) or "the same but for residuals"
