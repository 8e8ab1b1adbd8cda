"""Time of one match with the default policy, the index built before (`make bench`)."""

from __future__ import annotations

from typing import Any, Literal

import msgspec
import pytest

from situgraph.matching import PlanIndex
from situgraph.matching.matcher import match
from situgraph.plan.layouts import make_layout
from situgraph.plan.sampler import Sampler
from situgraph.plan.sampler_config import REALISTIC

SIZES = [(6, 12, "random"), (10, 100, "random"), (50, 500, "random")]
# Over 50 rooms the drift of a realistic sample bends the map until no rigid placement is left.
STEADY = msgspec.structs.replace(REALISTIC, drift=0.0)


@pytest.mark.parametrize(("seen", "planned", "kind"), SIZES)
def test_layouts(benchmark: Any, seen: int, planned: int, kind: Literal["random"]) -> None:
    prior = make_layout(kind, planned, 0)
    online = Sampler(prior, STEADY).sample(seen, 0).online
    result = benchmark(match, online, PlanIndex(prior))
    assert result.verdict == "unique"
