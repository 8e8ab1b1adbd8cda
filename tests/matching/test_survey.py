"""All around a new peak is searched once: the groups to come find it no more, nothing is lost."""

from __future__ import annotations

import msgspec
import pytest
from tests.matching.updates import assert_as_from_scratch

from situgraph.experiments.oracle.comparison import compare
from situgraph.experiments.oracle.definition import Definition
from situgraph.experiments.oracle.problem import Problem
from situgraph.matching import Matcher, match
from situgraph.plan.layouts import make_layout
from situgraph.plan.sampler import sample_online
from situgraph.plan.sampler_config import REALISTIC

STEADY = msgspec.structs.replace(REALISTIC, drift=0.0)


def test_the_true_place_is_not_searched_for_each_group() -> None:
    plan = make_layout("random", 500, 0)
    found = match(sample_online(plan, 50, 0, STEADY).online, plan)
    assert found.verdict == "unique"
    assert found.stats["boxes"] < 25  # of 16 groups, each with four boxes there


@pytest.mark.parametrize("kind", ["grid", "wings", "lshaped"])
def test_nothing_is_lost(kind: str) -> None:
    plan = make_layout(kind, 18, 0, "local")  # type: ignore[arg-type]
    online = sample_online(plan, 14, 0, STEADY).online
    found = compare(online, plan, Problem(online, plan, "none", Definition()))
    assert found.missed == found.invented == 0


@pytest.mark.parametrize("kind", ["grid", "corridor"])
def test_updates(kind: str) -> None:
    plan = make_layout(kind, 60, 1, "local")  # type: ignore[arg-type]
    online = sample_online(plan, 24, 1, STEADY).online
    matcher = Matcher(plan, semantics="none")
    for n in (8, 14, 16, 20, 21, 24):
        assert_as_from_scratch(matcher, online.replace(rooms=online.rooms[:n]))
