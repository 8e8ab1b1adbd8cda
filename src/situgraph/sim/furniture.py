"""Simple solid shapes for things by their category's name; any other name becomes a box."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from situgraph.geometry.poses import Array, rotation2
from situgraph.scenegraph.graph import Object
from situgraph.sim.mesh import MeshBuilder
from situgraph.sim.openings import yaw_of

# Half sizes (x, y, z) in metres where the plan gives none; x runs along the wall.
_SIZES: dict[str, tuple[float, float, float]] = {
    "column": (0.2, 0.2, 1.4),
    "radiator": (0.5, 0.06, 0.3),
    "sink": (0.3, 0.22, 0.12),
    "toilet": (0.2, 0.32, 0.4),
    "extinguisher": (0.09, 0.09, 0.28),
    "cabinet": (0.5, 0.25, 0.9),
    "shelf": (0.5, 0.18, 0.95),
    "table": (0.7, 0.4, 0.375),
    "desk": (0.7, 0.4, 0.375),
    "chair": (0.23, 0.24, 0.43),
    "sofa": (0.9, 0.42, 0.4),
    "bed": (0.5, 1.0, 0.3),
}
_USUAL = (0.35, 0.3, 0.5)
_LEG = 0.025  # m, half the thickness of a table leg
_STEP = 0.18  # m, height of a stair's step

Put = Callable[[tuple[float, float, float], tuple[float, float, float]], None]


class Solid:
    """Where an object stands: ``center`` (3,), half sizes (3,), ``yaw`` of its x axis (radians)."""

    def __init__(self, item: Object, floor: float, ceiling: float) -> None:
        half = item.ellipsoid.axes if item.ellipsoid else _SIZES.get(item.category, _USUAL)
        self.half: Array = np.maximum(np.asarray(half, dtype=float), 0.01)
        self.yaw = yaw_of(item)
        center = np.asarray(item.center, dtype=float)
        low, high = center[2] - self.half[2], center[2] + self.half[2]
        if item.category == "column" and np.isfinite(ceiling - floor):
            low, high = floor, ceiling
        low, high = max(low, floor), min(high, ceiling - 0.01)
        if high - low < 0.02:
            low, high = floor, floor + 2 * float(self.half[2])
        self.half[2] = (high - low) / 2
        self.center: Array = np.array([center[0], center[1], (low + high) / 2])

    @property
    def low(self) -> float:
        """Height of its underside, m."""
        return float(self.center[2] - self.half[2])

    def footprint(self) -> Array:
        """Corners (4, 2) of its plan view."""
        corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * self.half[:2]
        return np.asarray(corners @ rotation2(self.yaw).T + self.center[:2])


def build(mesh: MeshBuilder, category: str, solid: Solid, part: int) -> None:
    """Add the shape of ``category`` that fills ``solid``."""
    hx, hy, hz = (float(v) for v in solid.half)

    def put(at: tuple[float, float, float], half: tuple[float, float, float]) -> None:
        """Add a box given in fractions of the solid's half sizes."""
        shift = np.array(at) * solid.half
        shift[:2] = rotation2(solid.yaw) @ shift[:2]
        mesh.box(solid.center + shift, np.array(half) * solid.half, solid.yaw, part)

    if category in {"column", "extinguisher"} and abs(hx - hy) < 0.02:
        mesh.cylinder(solid.center, hx, hz, part)
    elif category in {"table", "desk"}:
        _table(put, hx, hy, hz)
    elif category == "chair":
        _chair(put, hx, hy)
    elif category == "radiator":
        _fins(put, hx)
    elif category == "shelf":
        _shelf(put)
    elif category in {"stair", "stairs"}:
        _steps(put, hx, hy, hz)
    elif category == "sofa":
        put((0, 0, -0.45), (1, 1, 0.55))
        put((0, 0.8, 0.55), (1, 0.2, 0.45))
        put((-0.93, 0, 0.2), (0.07, 1, 0.3))
        put((0.93, 0, 0.2), (0.07, 1, 0.3))
    elif category == "toilet":
        put((0, -0.25, -0.5), (1, 0.75, 0.5))
        put((0, 0.75, 0), (1, 0.25, 1))
    elif category == "bed":
        put((0, 0, -0.3), (1, 1, 0.7))
        put((0, 0.97, 0.5), (1, 0.03, 0.5))
    else:
        put((0, 0, 0), (1, 1, 1))


def _table(put: Put, hx: float, hy: float, hz: float) -> None:
    top = min(0.03 / hz, 0.5)
    put((0, 0, 1 - top), (1, 1, top))
    lx, ly = min(_LEG / hx, 0.5), min(_LEG / hy, 0.5)
    for sx in (-1, 1):
        for sy in (-1, 1):
            put((sx * (1 - lx), sy * (1 - ly), -top), (lx, ly, 1 - top))


def _chair(put: Put, hx: float, hy: float) -> None:
    put((0, 0, 0.05), (1, 1, 0.05))
    put((0, 0.92, 0.55), (1, 0.08, 0.45))
    lx, ly = min(_LEG / hx, 0.5), min(_LEG / hy, 0.5)
    for sx in (-1, 1):
        for sy in (-1, 1):
            put((sx * (1 - lx), sy * (1 - ly), -0.5), (lx, ly, 0.5))


def _fins(put: Put, hx: float) -> None:
    put((0, 0, 0), (1, 0.4, 0.96))
    count = max(int(hx / 0.05), 1)
    for i in range(count):
        put(((2 * i + 1) / count - 1, 0, 0), (0.5 / count, 1, 1))


def _steps(put: Put, hx: float, hy: float, hz: float) -> None:
    """Steps up the longer side; where a plan says no more, up its own axis."""
    count = max(round(2 * hz / _STEP), 1)
    for i in range(count):
        along, up = (2 * i + 1) / count - 1, (i + 1) / count
        if hx >= hy:
            put((along, 0, up - 1), (1 / count, 1, up))
        else:
            put((0, along, up - 1), (1, 1 / count, up))


def _shelf(put: Put) -> None:
    put((-0.97, 0, 0), (0.03, 1, 1))
    put((0.97, 0, 0), (0.03, 1, 1))
    put((0, 0.95, 0), (0.94, 0.05, 1))
    for i in range(5):
        put((0, 0, -0.98 + i * 0.49), (0.94, 1, 0.02))
