"""Rooms that are steady: a look near an earlier one finds what it would find without it."""

from __future__ import annotations

import math

import msgspec
import numpy as np
import pytest

from situgraph.matching import MatchingConfig, PlanIndex
from situgraph.matching.blocks import Block
from situgraph.matching.candidates import Known
from situgraph.matching.compiled import entry
from situgraph.matching.preparation import prepare
from situgraph.matching.records import record_at
from situgraph.matching.steady import is_steady
from situgraph.matching.tables import Case
from situgraph.matching.views import look, look_near
from situgraph.plan.layout_config import Kind
from situgraph.plan.layouts import make_layout
from situgraph.plan.sampler import sample_online
from situgraph.plan.sampler_config import REALISTIC

BENT = msgspec.structs.replace(
    REALISTIC, plane_yaw_sigma=math.radians(2.0), moved_walls=0.3, drift=0.0
)
CONFIG = MatchingConfig(rival_ratio=0.0, outside_prior=1e-300)
STEPS = 400


@entry
def walk(place, at):  # type: ignore[no-untyped-def]
    """Look at placements (k, 3), with what was found before and without.

    Returns how many rooms were steady, and the first look that was another, -1 for none.
    """
    case, steady = record_at(place, Case), 0
    one, two, seen = case.one, case.two, case.seen
    for k in range(len(at)):
        yaw, x, y = at[k, 0], at[k, 1], at[k, 2]
        c, s = math.cos(yaw), math.sin(yaw)
        for r in range(len(one.room)):
            cx, cy = seen.center[r, 0], seen.center[r, 1]
            steady += is_steady(case, r, 0, yaw, x + c * cx - s * cy, y + s * cx + c * cy)
        count = look_near(case, one, yaw, x, y, True)
        same = count == look(case, two, yaw, x, y, 0.0, 0.0)
        for r in range(len(one.room)):
            same = same and one.room[r] == two.room[r]
        for i in range(len(one.row)):
            same = same and one.row[i] == two.row[i] and one.state[i] == two.state[i]
            if two.row[i] >= 0:
                same = same and one.offset[i] == two.offset[i] and one.bend[i] == two.bend[i]
        if not same:
            return steady, k
    return steady, -1


@pytest.mark.parametrize("semantics", ["none", "containment"])
@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("kind", ["random", "modular", "grid"])
def test_what_was_found_near_by_changes_nothing(kind: Kind, seed: int, semantics: str) -> None:
    plan = make_layout(kind, 30, seed)
    online = sample_online(plan, 8, seed, BENT).online
    inputs = prepare(online, PlanIndex(plan), semantics, CONFIG)
    peaks = Known().find(inputs, inputs.aim).place
    rng = np.random.default_rng(seed)
    start = peaks[0, 1:4] if len(peaks) else np.array([0.0, *inputs.index.origin])
    size = 10 ** rng.uniform(-4, -1.3, STEPS)
    step = rng.normal(size=(STEPS, 3)) * np.stack([size / 20, size, size], axis=1)
    at = np.ascontiguousarray(start + step.cumsum(axis=0) * 0.3)
    sizes = inputs.tables.sizes(peaks=8, maps=True)
    case = Block(Case, sizes, **inputs.tables.given(inputs.aim))
    steady, differs = walk(case.place, at)
    assert differs == -1
    if len(peaks):
        assert steady > STEPS
