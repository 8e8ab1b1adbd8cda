"""Candidates from peaks, and what they are worth."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from situgraph.matching import MatchingConfig
from situgraph.matching.posterior import judge

CONFIG = MatchingConfig()
# Few values, so that there are ties and peaks of one place.
peaks = st.lists(
    st.tuples(
        st.sampled_from([0.0, 3.0]),
        st.sampled_from([0.0, 0.1, 1.5, 2 * math.pi]),
        st.sampled_from([0.0, 0.2, 0.4, 9.0]),
        st.sampled_from([0.0, 0.2, 5.0]),
        st.sampled_from([-1.0, 0.0, 1e-11, 2.5]),
    ),
    max_size=40,
)


def best_first(place: np.ndarray) -> list[int]:
    """Rows by L, then by height, yaw, x, y; but for those that a better one is the same as."""
    z, yaw, x, y, total = place.T
    kept: list[int] = []
    for k in np.lexsort((y, x, yaw, z, -total.round(9))).tolist():
        turn = [abs(math.remainder(yaw[k] - yaw[m], 2 * math.pi)) for m in kept]
        same = [
            math.hypot(x[k] - x[m], y[k] - y[m]) <= CONFIG.same_distance
            and abs(z[k] - z[m]) <= CONFIG.same_height
            and turned <= CONFIG.same_yaw
            for m, turned in zip(kept, turn)
        ]
        if not any(same):
            kept.append(k)
    return kept


@given(peaks, st.floats(-5, 5))
def test_peaks_are_ranked_and_weighed(rows: list[tuple[float, ...]], outside: float) -> None:
    place = np.array(rows, dtype=float).reshape(-1, 5)
    found = judge(place, np.arange(len(place)), outside, -0.5, CONFIG)
    kept = best_first(place)
    assert found.shift.tolist() == kept
    assert found.candidate.tolist() == place[kept].tolist()
    weight = np.exp(place[kept, 4] + math.log(1 - CONFIG.outside_prior) - 0.5)
    total = weight.sum() + math.exp(outside)
    assert found.probability == pytest.approx(weight / total)
    assert found.outside == pytest.approx(math.exp(outside) / total)
    assert found.total == pytest.approx(math.log(total))
    if found.verdict != "none":
        assert found.solutions == (weight >= CONFIG.rival_ratio * weight[0]).sum()
    assert (found.verdict == "none") == (weight.sum() < math.exp(outside))
