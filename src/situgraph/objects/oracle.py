"""A detector that looks at the simulator's truth, with stated errors: for evaluation only.

Its results are always reported under the name ``oracle``. Each error is drawn from the frame's
stamp and the seed, so a run can be repeated in any order.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Annotated

import msgspec
import numpy as np
from msgspec import Meta
from numpy.typing import NDArray
from scipy import ndimage

from situgraph.objects.detections import Detection

Rate = Annotated[float, Meta(ge=0, le=1)]


class OracleConfig(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The noise model: rates per frame and instance."""

    miss: Rate = 0.1
    confusion: Rate = 0.01
    false_positive: Rate = 0.02
    min_area: Annotated[int, Meta(ge=1, description="smaller masks are missed (px)")] = 300
    far: Annotated[float, Meta(gt=0, description="range from which misses grow (m)")] = 4.0
    far_miss: Rate = 0.6
    grazing: Annotated[float, Meta(gt=0, description="width/height under which misses grow")] = 0.12
    grazing_miss: Rate = 0.5
    erosion: Annotated[int, Meta(ge=0, description="most pixels a mask shrinks or grows")] = 3


Truth = Callable[[float], tuple[NDArray[np.integer], NDArray[np.floating] | None]]


class OracleDetector:
    """Turns true object-id images into detections with the errors of ``config``.

    ``truth(stamp)`` gives the id image (h, w), 0 for none, and the true depth (h, w) or None;
    ``categories_by_id`` the category of each id.
    """

    def __init__(
        self,
        truth: Truth,
        categories_by_id: Mapping[int, str],
        config: OracleConfig | None = None,
        seed: int = 0,
    ) -> None:
        """Keep the source of truth; nothing is read before the first frame."""
        self.name = "oracle"
        self._truth = truth
        self._by_id = dict(categories_by_id)
        self.config = config or OracleConfig()
        self._seed = seed

    @property
    def categories(self) -> frozenset[str]:
        """All categories of the world."""
        return frozenset(self._by_id.values())

    def detect(self, rgb: NDArray[np.uint8], stamp: float) -> Sequence[Detection]:
        """The instances truly in the frame of ``stamp``, less and more the modelled errors."""
        ids, depth = self._truth(stamp)
        rng = np.random.default_rng([self._seed, round(stamp * 1e6) & 0x7FFFFFFFFFFF])
        found = []
        for key in np.unique(ids):
            category = self._by_id.get(int(key))
            if category is None:
                continue
            mask = ids == key
            draw, change, size = rng.random(), rng.random(), rng.integers(-1, 2)
            if draw < self._miss_rate(mask, depth):
                continue
            if change < self.config.confusion:
                category = self._other(category, rng)
            found.append(Detection(self._reshaped(mask, int(size), rng), category, 0.9))
        if self._by_id and rng.random() < self.config.false_positive:
            found.append(self._false(ids.shape, rng))
        return found

    def _miss_rate(self, mask: NDArray[np.bool_], depth: NDArray[np.floating] | None) -> float:
        """Chance to miss an instance: small, far and grazing views are missed more often."""
        c = self.config
        if int(mask.sum()) < c.min_area:
            return 1.0
        rate = c.miss
        rows, columns = mask.any(axis=1), mask.any(axis=0)
        if columns.sum() < c.grazing * rows.sum():
            rate = max(rate, c.grazing_miss)
        if depth is not None:
            seen = depth[mask]
            seen = seen[seen > 0]
            if len(seen) and float(np.median(seen)) > c.far:
                rate = max(rate, c.far_miss)
        return rate

    def _reshaped(
        self, mask: NDArray[np.bool_], sign: int, rng: np.random.Generator
    ) -> NDArray[np.bool_]:
        steps = int(rng.integers(0, self.config.erosion + 1))
        if sign == 0 or steps == 0:
            return mask
        change = ndimage.binary_dilation if sign > 0 else ndimage.binary_erosion
        out: NDArray[np.bool_] = change(mask, iterations=steps)
        return out

    def _other(self, category: str, rng: np.random.Generator) -> str:
        others = sorted(self.categories - {category})
        return others[int(rng.integers(len(others)))] if others else category

    def _false(self, shape: tuple[int, ...], rng: np.random.Generator) -> Detection:
        h, w = shape
        size = rng.integers(40, 120, 2)
        top, left = rng.integers(0, max(1, h - size[0])), rng.integers(0, max(1, w - size[1]))
        mask = np.zeros((h, w), dtype=bool)
        mask[top : top + size[0], left : left + size[1]] = True
        names = sorted(self.categories)
        return Detection(mask, names[int(rng.integers(len(names)))], 0.5)
