"""Known peaks, noted and found by their place: those near a point without going through all."""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math

from situgraph.matching.compiled import part
from situgraph.matching.slack import wrapped
from situgraph.matching.tables import PEAKS, WORK

LEAST_GAIN = 1e-3  # of L, for which another peak is climbed to
TIE = 1e-6  # of L, which rounding may decide
SAME_PEAK = 1e-4  # metres along both axes, radians
CELL = 4.0  # metres
BUCKETS = 256  # of cells, a power of two


@part
def forget_peaks(case):
    """Begin without any."""
    for b in range(BUCKETS):
        case.found.bucket[b] = 0


@part
def add_peak(case, at, height, rest):
    """Note a peak, unless it is known; where there is no room for it, it is only counted.

    ``rest`` is what the rooms say there that are not explained, NaN where that was not looked at.
    """
    peaks, count = case.found.peak, case.found.count
    if peak_at(case, at) >= 0:
        return
    if count[PEAKS] < len(peaks):
        k = count[PEAKS]
        for c in range(3):
            peaks[k, c] = at[c]
        peaks[k, 3] = height
        case.found.rest[k] = rest
        case.found.since[k] = 0
        _unsettle(case, k)
        enter_peak(case, k)
    count[PEAKS] += 1


@part
def peak_at(case, at):
    """The number of a known peak, -1 when it is not known."""
    peaks, close = case.found.peak, case.found.close
    for m in range(peaks_near(case, at[1], at[2], SAME_PEAK)):
        k = close[m]
        apart = abs(peaks[k, 1] - at[1]) + abs(peaks[k, 2] - at[2])
        if apart < SAME_PEAK and abs(wrapped(peaks[k, 0] - at[0])) < SAME_PEAK:
            return k
    return -1


@part
def _unsettle(case, k):
    """A new peak is not settled, nor is any longer one that is the same place and not higher."""
    peaks, settled, close = case.found.peak, case.found.settled, case.found.close
    settled[k, 0] = 0.0
    for m in range(peaks_near(case, peaks[k, 1], peaks[k, 2], case.limits.same_distance)):
        near = close[m]
        if peaks[k, 3] >= peaks[near, 3] - TIE and same_place(case, peaks[near], peaks[k]):
            settled[near, 0] = 0.0


@part
def same_place(case, one, two):
    """Whether two peaks (yaw, x, y, L) are the same placement."""
    apart = math.hypot(one[1] - two[1], one[2] - two[2])
    turned = abs(wrapped(one[0] - two[0]))
    return apart <= case.limits.same_distance and turned <= case.limits.same_yaw


@part
def is_highest(case, at, height):
    """Whether no known peak of the same place is as high."""
    peaks, close = case.found.peak, case.found.close
    for m in range(peaks_near(case, at[1], at[2], case.limits.same_distance)):
        k = close[m]
        if peaks[k, 3] >= height - LEAST_GAIN and same_place(case, peaks[k], at):
            return False
    return True


@part
def enter_peak(case, k):
    """Enter peak ``k``, whose place is known, into its cell."""
    found = case.found
    b = _bucket(math.floor(found.peak[k, 1] / CELL), math.floor(found.peak[k, 2] / CELL))
    found.linked[k] = found.bucket[b]
    found.bucket[b] = k + 1


@part
def peaks_near(case, x, y, reach):
    """How many peaks stand in ``found.close``, first come first: all within ``reach``, and more."""
    found, count, met = case.found, 0, 4
    peaks = min(found.count[PEAKS], len(found.peak))
    x0, x1 = math.floor((x - reach) / CELL), math.floor((x + reach) / CELL)
    y0, y1 = math.floor((y - reach) / CELL), math.floor((y + reach) / CELL)
    if (x1 - x0 + 1) * (y1 - y0 + 1) >= peaks:
        for k in range(peaks):
            found.close[k] = k
        found.count[WORK] += peaks // 4
        return peaks
    for i in range(x0, x1 + 1):
        for j in range(y0, y1 + 1):
            before, k = count, found.bucket[_bucket(i, j)] - 1
            while k >= 0:
                dx, dy = found.peak[k, 1] - x, found.peak[k, 2] - y
                inside = math.floor(found.peak[k, 1] / CELL) == i
                inside = inside and math.floor(found.peak[k, 2] / CELL) == j
                if inside and dx * dx + dy * dy <= reach * reach:
                    found.close[count] = k
                    count += 1
                k = found.linked[k] - 1
                met += 1
            met += _merge(found.close, before, count)
    found.count[WORK] += met
    return count


@part
def _merge(close, middle, count):
    """Bring numbers into order: those up to ``middle`` ascend, those from there on descend.

    Returns how many are passed.
    """
    for k in range((count - middle) // 2):
        one, two = middle + k, count - 1 - k
        close[one], close[two] = close[two], close[one]
    passed = 0
    for m in range(middle, count):
        k, at = close[m], m
        while at > 0 and close[at - 1] > k:
            close[at] = close[at - 1]
            at -= 1
        close[at] = k
        passed += m - at
    return passed


@part
def _bucket(i, j):
    return (i * 73856093 ^ j * 19349663) & (BUCKETS - 1)
