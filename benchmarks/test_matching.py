"""Time of one match with the default policy, the index built before (`make bench`)."""

from __future__ import annotations

from typing import Any

import pytest

from situgraph.matching import PlanIndex
from situgraph.matching.matcher import match
from situgraph.plan.layouts import make_layout
from situgraph.plan.sampler import sample_online


@pytest.mark.parametrize(("seen", "planned"), [(6, 12), (10, 100)])
def test_random_layouts(benchmark: Any, seen: int, planned: int) -> None:
    prior = make_layout("random", planned, 0)
    index = PlanIndex(prior)
    sample = sample_online(prior, seen, 0)
    online = getattr(sample, "online", sample)
    result = benchmark(match, online, index)
    assert result.verdict == "unique"
