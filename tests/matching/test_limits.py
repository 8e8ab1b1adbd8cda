"""Where a way meets a limit: told from the planes' offsets, it is where it would be found."""

from __future__ import annotations

import math

import msgspec
import numpy as np
import pytest

from situgraph.matching import MatchingConfig, PlanIndex
from situgraph.matching.blocks import Block
from situgraph.matching.candidates import Known
from situgraph.matching.compiled import entry
from situgraph.matching.limits import first_limit
from situgraph.matching.peaks import SMALLEST_STEP, _last_feasible, _same, arrive, feasible
from situgraph.matching.preparation import prepare
from situgraph.matching.records import record_at
from situgraph.matching.tables import Case
from situgraph.plan.layout_config import Kind
from situgraph.plan.layouts import make_layout
from situgraph.plan.sampler import sample_online
from situgraph.plan.sampler_config import REALISTIC

BENT = msgspec.structs.replace(
    REALISTIC, plane_yaw_sigma=math.radians(1.0), moved_walls=0.1, drift=0.0
)
CONFIG = MatchingConfig(rival_ratio=0.0, outside_prior=1e-300)


@entry
def last_by_bisection(place, at, goal, alike, out):  # type: ignore[no-untyped-def]
    """Shares of the way: the last feasible by bisection alone, then by ``_last_feasible``.

    And where the limit is told to be, and 1 where it is not behind what was found.
    """
    case = record_at(place, Case)
    if not feasible(case, case.one, at):
        return False
    tried = np.empty(3)
    low, high = 0.0, 1.0
    while high - low > SMALLEST_STEP:
        share = (low + high) / 2
        for k in range(3):
            tried[k] = at[k] + share * (goal[k] - at[k])
        if arrive(case, case.two, tried) and (not alike or _same(case.one, case.two)):
            low = share
        else:
            high = share
    out[0] = low
    found = _last_feasible(case, at, goal, alike, tried)
    out[1] = (tried[1] - at[1]) / (goal[1] - at[1]) if found else 0.0
    out[2] = first_limit(case, at, goal, alike)
    for k in range(3):
        tried[k] = at[k] + (out[1] + 2 * SMALLEST_STEP) * (goal[k] - at[k])
    on = arrive(case, case.two, tried) and (not alike or _same(case.one, case.two))
    out[3] = 1.0 if on and out[1] + 2 * SMALLEST_STEP < 1.0 else 0.0
    return True


@pytest.mark.parametrize("alike", [True, False])
@pytest.mark.parametrize("kind", ["random", "lshaped"])
def test_limits_are_met_where_they_are_told(kind: Kind, alike: bool) -> None:
    told, ways = 0, 0
    for seed in range(6):
        plan = make_layout(kind, 30, seed)
        online = sample_online(plan, 10, seed, BENT).online
        inputs = prepare(online, PlanIndex(plan), "none", CONFIG)
        peaks = Known().find(inputs, inputs.aim).place
        sizes = inputs.tables.sizes(peaks=8, maps=True)
        case = Block(Case, sizes, **inputs.tables.given(inputs.aim))
        rng = np.random.default_rng(seed)
        for _ in range(40):
            at = peaks[0, 1:4].copy()
            goal = at + rng.normal(size=3) * [0.005, 0.1, 0.1]
            out = np.zeros(4)
            if last_by_bisection(case.place, at, goal, alike, out):
                bisected, found, guessed, beyond = out.tolist()
                assert not beyond
                assert found >= bisected - 2 * SMALLEST_STEP  # there may be several
                ways += 1
                told += abs(guessed - bisected) < 2 * SMALLEST_STEP
    assert ways > 200
    assert told > 0.9 * ways
