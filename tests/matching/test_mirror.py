"""The hypothesis that the plan is mirrored: it ends what is wrongly unique, and nothing else."""

from __future__ import annotations

import numpy as np
import pytest

from situgraph.experiments.certificate import congruent
from situgraph.matching import MatchingConfig, PlanIndex, match
from situgraph.matching.candidates import Known
from situgraph.matching.mirror import aim_at
from situgraph.matching.preparation import prepare
from situgraph.plan.layout_config import Kind
from situgraph.plan.layouts import make_layout
from situgraph.plan.sampler import sample_online
from situgraph.plan.sampler_config import CLEAN, REALISTIC, SamplerConfig
from situgraph.plan.six_rooms import six_rooms
from situgraph.scenegraph.mirror import mirrored

WITHOUT = MatchingConfig(mirror_prior=0.0)


@pytest.mark.parametrize("semantics", ["none", "likelihood"])
@pytest.mark.parametrize("errors", [CLEAN, REALISTIC])
@pytest.mark.parametrize(("kind", "least"), [("random", 20), ("modular", 18)])
def test_what_is_unique_and_right_stays_so(
    kind: Kind, least: int, errors: SamplerConfig, semantics: str
) -> None:
    unique = 0
    for seed in range(20):
        prior = make_layout(kind, 12, seed)
        online = sample_online(prior, 6, seed, errors).online
        unique += match(online, prior, semantics=semantics).unique  # type: ignore[arg-type]
    assert unique >= least


@pytest.mark.parametrize("semantics", ["none", "likelihood"])
def test_part_of_a_mirrored_building_is_not_unique(semantics: str) -> None:
    before = 0
    for seed in range(20):
        building = make_layout("modular", 12, seed)
        index = PlanIndex(mirrored(building))
        sample = sample_online(building, 3, seed, REALISTIC)
        if semantics == "none" and congruent(sample, building, index):
            continue
        online = sample.online
        before += match(online, index, semantics=semantics, config=WITHOUT).unique  # type: ignore[arg-type]
        assert not match(online, index, semantics=semantics).unique  # type: ignore[arg-type]
    assert before > 0  # else this shows nothing


def test_one_room_of_the_demo_building_is_enough_when_objects_are_seen() -> None:
    building = six_rooms()
    online = sample_online(building, 1, 0, CLEAN).online
    assert match(online, building).unique


def test_a_mirror_image_that_fits_better_is_named() -> None:
    building = make_layout("modular", 12, 3)
    index = PlanIndex(mirrored(building))
    for seed in range(40):
        online = sample_online(building, 4, seed, REALISTIC).online
        result = match(online, index)
        if result.probability_mirrored > 0.5:
            assert "mirror" in result.reason
            assert result.probability_mirrored <= result.probability_outside
            return
    pytest.fail("no sample fits the mirrored plan at all")


@pytest.mark.parametrize("semantics", ["none", "likelihood"])
@pytest.mark.parametrize("rooms", [3, 6])
def test_the_bound_leaves_out_no_mirror_image_that_fits_well_enough(
    rooms: int, semantics: str
) -> None:
    reached = 0
    for seed in range(20):
        building = make_layout("modular", 12, seed)
        index = PlanIndex(mirrored(building) if seed % 2 else building)
        online = sample_online(building, rooms, seed, REALISTIC).online
        image = prepare(online, index, semantics, MatchingConfig()).mirrored()
        every = Known().find(image, image.aim).place[:, 4]
        for below in (0.5, 5.0, 20.0):
            least = float(every.max(initial=-100.0)) - below
            some = Known().find(image, aim_at(image, least)).place[:, 4]
            reached += len(every) > 0
            assert some.max(initial=-100.0) >= every.max(initial=-100.0) - 0.1  # peaks differ a bit
    assert reached > 0


def test_objects_of_the_mirror_image_say_what_those_of_a_mirrored_graph_say() -> None:
    building = make_layout("modular", 12, 3)
    online = sample_online(building, 6, 3, REALISTIC).online
    index = PlanIndex(mirrored(building))
    image = prepare(online, index, "likelihood", MatchingConfig()).mirrored()
    graph = prepare(mirrored(online), index, "likelihood", MatchingConfig())
    found = Known().find(graph, graph.aim).place
    assert len(found)
    at, shift = found[:, 1:4], np.zeros(len(found), dtype=np.int64)
    assert image.evidence(shift, at)[0] == pytest.approx(graph.evidence(shift, at)[0])
    assert image.evidence(shift, at)[1].tolist() == graph.evidence(shift, at)[1].tolist()
    # As the search has weighed them.
    peaks = Known().find(image, image.aim)
    value, _ = image.evidence(peaks.shift, peaks.place[:, 1:4])
    assert peaks.place[:, 4] - peaks.walls == pytest.approx(value)
