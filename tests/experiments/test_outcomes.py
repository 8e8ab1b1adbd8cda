"""Right, ambiguous, none, wrong; and which trials the printed model covers."""

from __future__ import annotations

import math

import msgspec
import pytest

from situgraph.experiments.outcomes import Judge, tally
from situgraph.geometry.poses import Placement
from situgraph.matching import MatchingConfig, match
from situgraph.plan.layouts import make_layout
from situgraph.plan.sample_truth import OnlineSample
from situgraph.plan.sampler import sample_online
from situgraph.plan.sampler_config import SamplerConfig
from situgraph.scenegraph.transform import transformed


def test_the_true_place_is_right_and_another_wrong() -> None:
    prior = make_layout("random", 12, 3)
    sample = sample_online(prior, 6, 3)
    result = match(sample.online, prior)
    judge = Judge(sample, prior, "likelihood")
    assert judge.outcome(result) == "right"
    assert judge.true_rank(result) == 0
    assert judge.admissible()
    shifted = msgspec.structs.replace(
        sample.truth, placement=sample.truth.placement.compose(Placement(x=1.0))
    )
    other = Judge(OnlineSample(sample.online, shifted), prior, "likelihood")
    assert other.outcome(result) == "wrong"
    assert other.true_rank(result) is None


def test_places_are_compared_at_the_mean_room_centre() -> None:
    prior = make_layout("random", 6, 1)
    sample = sample_online(prior, 3, 1)
    judge = Judge(sample, prior, "none")
    assert judge.is_true(sample.truth.placement)
    assert not judge.is_true(Placement(x=0.4).compose(sample.truth.placement))
    # Far from the origin a small turn moves everything; about the rooms it moves nothing.
    away = Placement(x=500.0)
    far = OnlineSample(
        transformed(sample.online, away),
        msgspec.structs.replace(
            sample.truth, placement=sample.truth.placement.compose(away.inverse())
        ),
    )
    middle = Judge(far, prior, "none")
    turned = far.truth.placement.compose(Placement(yaw=math.radians(1)))
    assert not middle.is_true(turned)


def test_symmetry_is_ambiguous_and_foreign_plans_are_none() -> None:
    prior = make_layout("random", 8, 5, "global")
    sample = sample_online(prior, 8, 5)
    assert Judge(sample, prior, "none").outcome(match(sample.online, prior, semantics="none")) == (
        "ambiguous"
    )
    other = make_layout("random", 8, 6)
    assert Judge(sample, other, "none").outcome(match(sample.online, other)) == "none"


@pytest.mark.parametrize(("moved", "admissible"), [(0.3, True), (0.8, False)])
def test_walls_moved_beyond_the_model_make_a_trial_inadmissible(
    moved: float, admissible: bool
) -> None:
    prior = make_layout("random", 12, 2)
    errors = SamplerConfig(moved_walls=0.4, moved_min=moved, moved_max=moved)
    judged = [
        Judge(sample_online(prior, 6, seed, errors), prior, "none").admissible()
        for seed in range(6)
    ]
    # Sizes of rooms are kept where all four walls move by chance alike; mostly they do not.
    assert (sum(judged) >= 4) if admissible else (sum(judged) <= 2)


def test_matches_beyond_the_listed_solutions_are_not_needed() -> None:
    prior = make_layout("grid", 12, 0)
    sample = sample_online(prior, 2, 0)
    result = match(sample.online, prior, semantics="none", config=MatchingConfig(max_solutions=1))
    assert Judge(sample, prior, "none").outcome(result) == "ambiguous"


def test_tally_counts_each_outcome() -> None:
    rows = [{"outcome": name} for name in ("right", "right", "none")]
    assert tally(rows) == {"trials": 3, "right": 2, "ambiguous": 0, "none": 1, "wrong": 0}
