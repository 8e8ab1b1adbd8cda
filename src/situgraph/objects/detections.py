"""What a detector returns and what a camera frame is to the objects stage."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Detection:
    """One instance in an image: ``mask`` (h, w) bool, canonical ``category``, ``score`` in 0..1."""

    mask: NDArray[np.bool_]
    category: str
    score: float


@runtime_checkable
class Detector(Protocol):
    """Finds instances in a colour image; ``name`` is what results are reported under."""

    @property
    def name(self) -> str:
        """The name that results are reported under."""
        ...

    @property
    def categories(self) -> frozenset[str]:
        """The categories it can find; others are no evidence."""
        ...

    def detect(self, rgb: NDArray[np.uint8], stamp: float) -> Sequence[Detection]:
        """The instances in an image (h, w, 3) uint8; ``stamp`` (s) tells which frame it is."""
        ...


@dataclass(frozen=True)
class Camera:
    """Pinhole intrinsics in pixels: u = fx x / z + cx, v = fy y / z + cy."""

    fx: float
    fy: float
    cx: float
    cy: float
