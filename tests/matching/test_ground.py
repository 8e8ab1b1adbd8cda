"""Maps of where rooms may lie, and plain rooms: they save work and never lose a placement."""

from __future__ import annotations

import math

import msgspec
import numpy as np
import pytest

from situgraph.experiments.oracle.comparison import compare
from situgraph.experiments.oracle.definition import Definition
from situgraph.experiments.oracle.problem import Problem
from situgraph.matching import MatchingConfig, PlanIndex, match
from situgraph.matching.blocks import Block
from situgraph.matching.compiled import entry
from situgraph.matching.entries import _shapes_alike
from situgraph.matching.ground import _lost
from situgraph.matching.maps import draw
from situgraph.matching.preparation import Inputs, prepare
from situgraph.matching.records import record_at
from situgraph.matching.tables import Case, Ints
from situgraph.plan.layout_config import Kind
from situgraph.plan.layouts import make_layout
from situgraph.plan.sampler import sample_online
from situgraph.plan.sampler_config import REALISTIC, SamplerConfig
from situgraph.scenegraph.graph import SceneGraph

EVERYTHING = MatchingConfig(rival_ratio=0.0, outside_prior=1e-300, max_solutions=1_000_000)
BENT = msgspec.structs.replace(
    REALISTIC,
    plane_yaw_sigma=math.radians(2.5),
    moved_walls=0.3,
    drift=math.radians(8.0) / 50.0,
)


def inputs_of(kind: Kind, planned: int, seen: int, seed: int, errors: SamplerConfig) -> Inputs:
    plan = make_layout(kind, planned, seed)
    online = sample_online(plan, seen, seed, errors).online
    return prepare(online, PlanIndex(plan), "none", EVERYTHING)


@entry
def lost_in_a_wide_box(place, box):  # type: ignore[no-untyped-def]
    """Whether the anchor counts as lost in a box wider than its map can tell, nothing marked."""
    case = record_at(place, Case)
    case.ground.known[0] = case.ground.drawn[0] = 1
    return _lost(case, box, 0, 0, 1.0, 0.0, -0.5)


def test_a_box_that_is_too_wide_for_the_map_loses_no_room() -> None:
    inputs = inputs_of("random", 12, 3, 0, REALISTIC)
    sizes = inputs.tables.sizes(peaks=8, maps=True)
    case = Block(Case, sizes, **inputs.tables.given(inputs.aim))
    box = np.zeros(10)
    box[8:] = inputs.seen.center[0]
    assert not lost_in_a_wide_box(case.place, box)


@entry
def draw_all(place):  # type: ignore[no-untyped-def]
    """Draw the maps of all rooms."""
    case = record_at(place, Case)
    _shapes_alike(case)
    for r in range(len(case.seen.storey)):
        draw(case, r)


def maps_of(inputs: Inputs, former: Ints | None = None, *, shared: bool = False) -> Block:
    sizes = inputs.tables.sizes(peaks=8, maps=True, shared=shared)
    given = inputs.tables.given(inputs.aim) | {"former": former}
    case = Block(Case, sizes, **given)
    draw_all(case.place)
    return case


@pytest.mark.parametrize("kind", ["random", "lshaped", "corridor", "wings"])
@pytest.mark.parametrize("errors", [REALISTIC, BENT])
def test_the_mirror_image_has_the_maps_that_it_would_have_by_itself(
    kind: Kind, errors: SamplerConfig
) -> None:
    for seed in range(4):
        inputs = inputs_of(kind, 60, 12, seed, errors)
        shared = maps_of(inputs, shared=True).array("ground.shared")
        assert kind == "wings" or shared[: len(inputs.kept)].any()
        image = inputs.mirrored()
        recalled, alone = maps_of(image, shared), maps_of(image)
        assert (recalled.array("ground.marks") == alone.array("ground.marks")).all()


def test_the_boxes_of_one_pair_of_rooms_do_not_narrow_each_other() -> None:
    plan = make_layout("modular", 30, 856)
    online = sample_online(plan, 3, 856, BENT).online
    found = compare(online, plan, Problem(online, plan, "none", Definition()))
    assert found.missed == found.invented == 0


def skewed(plan: SceneGraph, turn: float) -> SceneGraph:
    """The walls turned a little, about the middle of the plan, so that no room is plain."""
    middle = np.mean([r.center for r in plan.rooms], axis=0)
    planes = []
    for k, plane in enumerate(plan.planes):
        x, y, z = plane.normal
        by = turn if k % 2 else -turn
        normal = (x - by * y, y + by * x, z)
        offset = plane.offset + float(np.dot(plane.normal, middle) - np.dot(normal, middle))
        planes.append(msgspec.structs.replace(plane, normal=normal, offset=offset))
    return plan.replace(planes=tuple(planes))


@pytest.mark.parametrize("kind", ["random", "modular", "grid", "corridor"])
def test_rooms_that_are_plain_are_matched_as_any_others(kind: Kind) -> None:
    for seed in range(5):
        plan = make_layout(kind, 12, seed)
        online = sample_online(plan, 1 + seed, seed, REALISTIC).online
        plain, others = PlanIndex(plan), PlanIndex(skewed(plan, 2e-6))
        assert not np.isnan(plain.table.plain[:, 0]).all()
        assert np.isnan(others.table.plain[:, 0]).all()
        one = match(online, plain, semantics="none", config=EVERYTHING)
        two = match(online, others, semantics="none", config=EVERYTHING)
        assert (one.verdict, one.candidates) == (two.verdict, two.candidates)
        for mine, theirs in zip(one.solutions, two.solutions):
            assert mine.probability == pytest.approx(theirs.probability, abs=0.01)
