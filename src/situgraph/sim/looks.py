"""Paints and lamps by seed: what every part of the world looks like."""

from __future__ import annotations

import colorsys
from dataclasses import dataclass

import numpy as np

from situgraph.sim.textures import LAYERS

Color = tuple[float, float, float]


@dataclass(frozen=True)
class Material:
    """One look: texture ``layer`` tinted by ``color`` (linear 0..1), ``scale`` m a tile.

    ``gloss`` 0..1 is the strength of highlights, ``reflectivity`` 0..1 what a LiDAR gets back.
    ``pane``: window glass, which shows the outside.
    """

    layer: int
    color: Color
    scale: float
    gloss: float
    reflectivity: float
    pane: bool = False


class Looks:
    """Draws materials for kinds of parts; the same seed draws the same ones in the same order."""

    def __init__(self, seed: int) -> None:
        self._rng = np.random.default_rng([seed, 7001])
        self._frame = self._wood_or_paint()
        self._leaf = [self._wood_or_paint() for _ in range(3)]
        self._sash = self._wood_or_paint()

    def draw(self, kind: str) -> Material:
        """A look for a ``wall``, ``floor``, ``ceiling``, ``leaf``, ... or any category."""
        rng = self._rng
        if kind in {"wall", "facade"}:
            layer = int(rng.choice([0, 0, 1, 2, 6, 8, 9]))
            tint = self._tint(0.55, 0.97, 0.25)
            return Material(layer, tint, float(rng.uniform(0.8, 2.5)), 0.02, 0.6)
        if kind in {"floor", "ground"}:
            layer = int(rng.choice([1, 3, 4, 5, 7, 10]))
            return Material(
                layer, self._tint(0.25, 0.75, 0.45), float(rng.uniform(0.8, 2.4)), 0.1, 0.4
            )
        if kind == "ceiling":
            layer = int(rng.choice([0, 1, 3]))
            return Material(
                layer, self._tint(0.8, 1.0, 0.06), float(rng.uniform(0.6, 1.2)), 0.0, 0.7
            )
        if kind == "glass":
            return Material(0, (0.9, 0.95, 1.0), 1.0, 0.8, 0.1, pane=True)
        if kind == "door frame":
            return self._frame
        if kind == "window frame":
            return self._sash
        if kind == "leaf":
            return self._leaf[int(rng.integers(len(self._leaf)))]
        if kind == "handle":
            return Material(0, (0.6, 0.6, 0.62), 1.0, 0.9, 0.5)
        if kind == "picture":
            layer = int(rng.integers(LAYERS))
            return Material(
                layer, self._tint(0.15, 0.95, 0.9), float(rng.uniform(0.3, 1.5)), 0.3, 0.5
            )
        if kind == "extinguisher":
            return Material(0, (0.75, 0.06, 0.05), 1.0, 0.5, 0.5)
        if kind in {"radiator", "sink", "toilet", "bathtub"}:
            return Material(0, self._tint(0.85, 1.0, 0.05), 1.0, 0.4, 0.7)
        layer = int(rng.choice([0, 4, 5, 7]))
        return Material(layer, self._tint(0.15, 0.9, 0.7), float(rng.uniform(0.5, 1.5)), 0.15, 0.5)

    def light(self) -> Color:
        """The colour and power of a lamp, from warm to cold."""
        warm, power = self._rng.uniform(0.0, 1.0), self._rng.uniform(0.6, 1.25)
        return (power, power * (0.82 + 0.18 * warm), power * (0.62 + 0.42 * warm))

    def _tint(self, low: float, high: float, saturation: float) -> Color:
        rng = self._rng
        hue = float(rng.choice([0.08, 0.12, 0.55, rng.random()])) + float(rng.normal(0, 0.02))
        rgb = colorsys.hsv_to_rgb(
            hue % 1.0, float(rng.random()) * saturation, float(rng.uniform(low, high))
        )
        return rgb

    def _wood_or_paint(self) -> Material:
        rng = self._rng
        if rng.random() < 0.5:
            color = colorsys.hsv_to_rgb(
                float(rng.uniform(0.05, 0.11)),
                float(rng.uniform(0.3, 0.7)),
                float(rng.uniform(0.3, 0.85)),
            )
            return Material(5, color, float(rng.uniform(0.6, 1.6)), 0.25, 0.5)
        return Material(0, self._tint(0.2, 1.0, 0.6), 1.0, 0.3, 0.6)
