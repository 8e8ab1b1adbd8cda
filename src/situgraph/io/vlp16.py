"""When and where the beams of a VLP-16 fire.

Velodyne VLP-16 user manual: elevations -15 to 15 deg in steps of 2; the beams fire in an
interleaved order, 2.304 us apart, a cycle every 55.296 us, 1808 cycles in a turn of 0.1 s. The
head turns clockwise seen from above.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from situgraph.io.recording import Scan

Float32 = NDArray[np.float32]
Index = NDArray[np.int64]

RINGS = 16
CYCLE = 55.296e-6  # s, a firing of all beams
SHOT = 2.304e-6  # s, from one beam to the next
# The rings in the order they fire: bottom, first above the horizon, second from the bottom, ...
ORDER = np.array([0, 8, 1, 9, 2, 10, 3, 11, 4, 12, 5, 13, 6, 14, 7, 15])


@dataclass(frozen=True, eq=False)
class Pattern:
    """Where each beam of a turn points and when: rows are rings from the lowest, columns cycles.

    ``times`` (16, c) float32, seconds relative to the turn's end; ``directions`` (16, c, 3)
    float32 unit vectors in the lidar frame; ``order`` (16 c,) flat indices in firing order.
    """

    times: Float32
    directions: Float32
    order: NDArray[np.int64]

    @property
    def columns(self) -> int:
        """Firing cycles in a turn."""
        return int(self.times.shape[1])

    def points(self, steps: NDArray[np.uint16], step: float) -> Float32:
        """Points (16, c, 3) float32 of ranges given as multiples (16, c) of ``step`` metres."""
        ranges = (steps * np.float64(step)).astype(np.float32)
        return np.asarray(ranges[..., None] * self.directions)

    def rows_and_columns(self, scan: Scan) -> tuple[Index, Index] | None:
        """Rings and cycles (n,) of a scan's points; None where its times are not the pattern's."""
        if scan.times is None or scan.rings is None or (scan.rings >= RINGS).any():
            return None
        row = scan.rings.astype(np.int64)
        late = scan.times - self.times[row, 0]
        column = np.rint(late.astype(np.float64) / CYCLE).astype(np.int64)
        column = np.clip(column, 0, self.columns - 1)
        return (row, column) if np.array_equal(self.times[row, column], scan.times) else None


def vlp16(rate: float) -> Pattern:
    """The pattern at ``rate`` turns a second."""
    columns = int(1.0 / rate / CYCLE)
    slot = np.empty(RINGS)
    slot[ORDER] = np.arange(RINGS)
    after = np.arange(columns)[None, :] * CYCLE + slot[:, None] * SHOT
    azimuth = -2.0 * np.pi * rate * after
    elevation = np.deg2rad(-15.0 + 2.0 * np.arange(RINGS))[:, None]
    directions = np.stack(
        [
            np.cos(elevation) * np.cos(azimuth),
            np.cos(elevation) * np.sin(azimuth),
            np.broadcast_to(np.sin(elevation), azimuth.shape),
        ],
        axis=-1,
    )
    times = (after - 1.0 / rate).astype(np.float32)
    order = np.argsort(after, axis=None, kind="stable")
    return Pattern(times, directions.astype(np.float32), order)
