"""A small picture of the plan: what is free, what is wall."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from situgraph.geometry.poses import Array

Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class Raster:
    """Square cells of edge ``cell`` (m); cell (0, 0) has its corner at ``origin`` (2,)."""

    origin: tuple[float, float]
    cell: float
    rows: int
    columns: int

    @staticmethod
    def around(low: Array, high: Array, cell: float) -> Raster:
        """A raster that holds the box from ``low`` to ``high`` (2,); it snaps to whole cells."""
        first = np.floor(np.asarray(low) / cell).astype(int)
        last = np.ceil(np.asarray(high) / cell).astype(int)
        columns, rows = (max(int(v), 1) for v in last - first)
        return Raster((float(first[0] * cell), float(first[1] * cell)), cell, rows, columns)

    def cells(self, points: Array) -> NDArray[np.intp]:
        """Row and column (n, 2) of points (n, 2); may lie outside."""
        rc: NDArray[np.intp] = np.floor((points - self.origin) / self.cell).astype(np.intp)[:, ::-1]
        return rc

    def centres(self, mask: Mask) -> Array:
        """Middles (n, 2) of the marked cells."""
        rows, columns = np.nonzero(mask)
        middles = np.column_stack([columns, rows]).astype(np.float64) + 0.5
        return middles * self.cell + np.asarray(self.origin, dtype=np.float64)

    def look(self, mask: Mask, points: Array) -> NDArray[np.bool_]:
        """Whether each point (n, 2) lies on a marked cell; outside it does not."""
        rc = self.cells(points)
        inside = (rc >= 0).all(axis=1) & (rc[:, 0] < self.rows) & (rc[:, 1] < self.columns)
        out = np.zeros(len(points), dtype=bool)
        out[inside] = mask[rc[inside, 0], rc[inside, 1]]
        return out

    def count_polygons(self, polygons: Iterable[Array]) -> NDArray[np.uint16]:
        """In how many of the polygons (m, 2) each cell lies."""
        from PIL import Image, ImageDraw

        count = np.zeros((self.rows, self.columns), dtype=np.uint16)
        for polygon in polygons:
            at = (polygon - self.origin) / self.cell - 0.5
            low = np.maximum(np.floor(at.min(axis=0)).astype(int), 0)
            high = np.minimum(np.ceil(at.max(axis=0)).astype(int) + 1, (self.columns, self.rows))
            if (high <= low).any():
                continue
            picture = Image.new("1", (int(high[0] - low[0]), int(high[1] - low[1])))
            ImageDraw.Draw(picture).polygon([tuple(p) for p in (at - low).tolist()], fill=1)
            count[low[1] : high[1], low[0] : high[0]] += np.asarray(picture)
        return count

    def draw_lines(self, lines: Iterable[Array]) -> Mask:
        """Cells that the segments (2, 2) touch, connected so that no diagonal step leaks."""
        mask = np.zeros((self.rows, self.columns), dtype=bool)
        for a, b in lines:
            steps = max(int(np.ceil(np.linalg.norm(b - a) / (0.25 * self.cell))), 1)
            points = a + (b - a) * (np.arange(steps + 1) / steps)[:, None]
            rc = self.cells(points)
            inside = (rc >= 0).all(axis=1) & (rc[:, 0] < self.rows) & (rc[:, 1] < self.columns)
            mask[rc[inside, 0], rc[inside, 1]] = True
        return mask
