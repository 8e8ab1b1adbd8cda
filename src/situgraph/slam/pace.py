"""Tells when scans are missing: by the rate at which they usually come."""

from __future__ import annotations

from collections import deque

import numpy as np

KEPT = 21  # intervals whose median is the usual one
LONGEST = 0.5  # s; slower logs (keyframes) have no rate
MISSING = 1.6  # times the usual interval


class Pace:
    """The intervals between scans."""

    def __init__(self) -> None:
        """No scan yet."""
        self._last: float | None = None
        self._intervals: deque[float] = deque(maxlen=KEPT)

    def gap(self, stamp: float) -> float | None:
        """Take in a scan's stamp (s); the seconds before it, where scans are missing there."""
        if self._last is None:
            self._last = stamp
            return None
        interval, self._last = stamp - self._last, stamp
        usual = float(np.median(self._intervals)) if self._intervals else interval
        self._intervals.append(interval)
        return interval if usual < LONGEST and interval > MISSING * usual else None
