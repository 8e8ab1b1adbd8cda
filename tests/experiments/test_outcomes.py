"""Right, ambiguous, none, wrong; and which trials the printed model covers."""

from __future__ import annotations

import math

import msgspec
import pytest

from situgraph.experiments.certificate import ASTRAY, COVERED, congruent
from situgraph.experiments.outcomes import Judge, tally
from situgraph.geometry.poses import Placement
from situgraph.matching import MatchingConfig, PlanIndex, match
from situgraph.plan.layouts import make_layout
from situgraph.plan.sample_truth import OnlineSample
from situgraph.plan.sampler import sample_online
from situgraph.plan.sampler_config import SamplerConfig
from situgraph.scenegraph.mirror import mirrored
from situgraph.scenegraph.transform import transformed


def test_the_true_place_is_right_and_another_wrong() -> None:
    prior = make_layout("random", 12, 3)
    sample = sample_online(prior, 6, 3)
    result = match(sample.online, prior)
    judge = Judge(sample, prior, "likelihood")
    assert judge.outcome(result) == "right"
    assert judge.true_rank(result) == 0
    assert judge.admissible()
    aside, truth = Placement(x=1.0), sample.truth
    shifted = msgspec.structs.replace(
        truth,
        placement=truth.placement.compose(aside),
        start=truth.start.compose(aside),
        room_placements={r: p.compose(aside) for r, p in truth.room_placements.items()},
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


def test_both_walls_of_a_room_moved_leave_nothing_that_fits_across() -> None:
    """The two, moved towards each other, fit a place between: a wrong one, but no true one does."""
    prior = make_layout("grid", 9, 30346)
    sample = sample_online(prior, 1, 15173, COVERED)
    assert [abs(m.offset) > 0.15 for m in sample.truth.moved] == [True, True]
    result = match(sample.online, prior)
    assert result.unique
    assert not Judge(sample, prior, "likelihood").admissible(result)


def test_an_answer_is_judged_where_its_rooms_are() -> None:
    """Five rooms of seven are placed; drift has turned the other two, and the fit over all."""
    prior = make_layout("grid", 7, 12328)
    sample = sample_online(prior, 7, 6164, ASTRAY)
    result = match(sample.online, prior)
    judge = Judge(sample, prior, "likelihood")
    assert result.unique
    assert result.best is not None
    assert judge.rooms_right(result)
    assert not judge.is_true(result.best.transform)
    assert judge.is_aside(result)
    assert judge.outcome(result) == "right"
    assert judge.admissible(result)


def test_a_moved_wall_is_in_no_plan_and_tells_no_mirror_image_apart() -> None:
    building = make_layout("storeys", 12, 320)
    plan = PlanIndex(mirrored(building))
    sample = sample_online(building, 6, 160, COVERED)
    assert congruent(sample, building, plan)
    assert match(sample.online, building, semantics="none").best is not None
    other = sample_online(building, 6, 161, COVERED)
    assert not congruent(other, building, plan)


def test_matches_beyond_the_listed_solutions_are_not_needed() -> None:
    prior = make_layout("grid", 12, 0)
    sample = sample_online(prior, 2, 0)
    result = match(sample.online, prior, semantics="none", config=MatchingConfig(max_solutions=1))
    assert Judge(sample, prior, "none").outcome(result) == "ambiguous"


def test_tally_counts_each_outcome() -> None:
    rows = [{"outcome": name} for name in ("right", "right", "none")]
    assert tally(rows) == {"trials": 3, "right": 2, "ambiguous": 0, "none": 1, "wrong": 0}
