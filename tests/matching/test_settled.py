"""Settled peaks: what leads to them again is not searched again, and nothing is lost by it."""

from __future__ import annotations

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.matching.updates import assert_as_from_scratch

from situgraph.experiments.oracle.comparison import compare
from situgraph.experiments.oracle.definition import Definition
from situgraph.experiments.oracle.problem import Problem
from situgraph.matching import Matcher, PlanIndex, match
from situgraph.matching.blocks import Block
from situgraph.matching.compiled import entry
from situgraph.matching.nearby import enter_peak, peaks_near
from situgraph.matching.preparation import prepare
from situgraph.matching.records import record_at
from situgraph.matching.tables import PEAKS, Case
from situgraph.plan.layouts import make_layout
from situgraph.plan.sampler import sample_online
from situgraph.plan.sampler_config import CLEAN, SamplerConfig

SLIGHT = msgspec.structs.replace(CLEAN, plane_offset_sigma=0.01, moved_walls=0.03)
PLAN = PlanIndex(make_layout("grid", 12, 0, "local"))
SEEN = sample_online(PLAN.prior, 3, 0, CLEAN).online


@entry
def count_near(place, x, y, reach):  # type: ignore[no-untyped-def]
    """Enter all peaks; how many are near, left in ``found.close``."""
    case = record_at(place, Case)
    for k in range(case.found.count[PEAKS]):
        enter_peak(case, k)
    return peaks_near(case, x, y, reach)


places = st.tuples(st.floats(-60, 60), st.floats(-60, 60))


@given(st.lists(places, max_size=60), places, st.floats(0, 30))
@settings(deadline=None)
def test_peaks_near_a_place(
    peaks: list[tuple[float, float]], at: tuple[float, float], reach: float
) -> None:
    inputs = prepare(SEEN, PLAN, "none", PLAN.config)
    sizes = inputs.tables.sizes(peaks=64, maps=True)
    case = Block(Case, sizes, **inputs.tables.given(inputs.aim))
    case.array("found.count")[PEAKS] = len(peaks)
    case.array("found.peak")[: len(peaks), 1:3] = np.reshape(peaks, (-1, 2))
    count = count_near(case.place, *at, reach)
    found = case.array("found.close")[:count].tolist()
    apart = np.hypot(*(np.reshape(peaks, (-1, 2)) - at).T)
    assert found == sorted(set(found))
    assert set(np.flatnonzero(apart < reach).tolist()) <= set(found)


def test_no_peak_of_equal_rooms_is_searched_twice() -> None:
    plan = make_layout("grid", 500, 0, "local")
    found = match(sample_online(plan, 50, 0, CLEAN).online, plan, semantics="none")
    assert found.complete
    assert found.candidates > 500
    assert 10 * found.stats["boxes"] < found.candidates < found.stats["hypotheses"] / 4


@pytest.mark.parametrize("errors", [CLEAN, SLIGHT])
@pytest.mark.parametrize("number", range(6))
def test_nothing_is_lost_among_equal_rooms(number: int, errors: SamplerConfig) -> None:
    plan = make_layout("grid", 16, number, "local")
    online = sample_online(plan, 3 + number, number, errors).online
    found = compare(online, plan, Problem(online, plan, "none", Definition()))
    assert found.missed == found.invented == 0


@pytest.mark.parametrize("errors", [CLEAN, SLIGHT])
def test_updates_among_equal_rooms(errors: SamplerConfig) -> None:
    plan = make_layout("grid", 40, 1, "local")
    online = sample_online(plan, 12, 1, errors).online
    matcher = Matcher(plan, semantics="none")
    for n in range(1, len(online.rooms) + 1):
        assert_as_from_scratch(matcher, online.replace(rooms=online.rooms[:n]))
