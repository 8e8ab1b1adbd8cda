"""Maps that drift has bent: parts that are placed by themselves, and what they add up to."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import situgraph as sg
from situgraph.experiments.certificate import COVERED
from situgraph.experiments.outcomes import Judge
from situgraph.geometry.poses import Placement, best_placement
from situgraph.matching import MatchingConfig, MatchResult, bent_result, matcher
from situgraph.matching.bent_result import BentResult
from situgraph.matching.bent_solution import BentSolution
from situgraph.matching.explanation import explain_pair
from situgraph.plan.layouts import make_layout
from situgraph.plan.sample_truth import OnlineSample
from situgraph.plan.sampler import sample_online
from situgraph.plan.sampler_config import REALISTIC, SamplerConfig
from situgraph.scenegraph.graph import SceneGraph
from situgraph.scenegraph.mirror import mirrored
from situgraph.scenegraph.transform import transformed
from situgraph.view.config import ViewConfig
from situgraph.view.floors import survey
from situgraph.view.overlay import lay_over
from situgraph.view.placed import placed
from situgraph.view.record import read_record

RIGID = MatchingConfig(part_rooms=0)
# Without any error but drift.
BENT = SamplerConfig(drift=math.radians(2.5) / 50)


def seen(kind: str, planned: int, rooms: int, seed: int) -> tuple[SceneGraph, OnlineSample]:
    prior = make_layout(kind, planned, seed)  # type: ignore[arg-type]
    return prior, sample_online(prior, rooms, seed, REALISTIC)


def share_right(sample: OnlineSample, rooms: dict[str, str]) -> float:
    return float(np.mean([sample.truth.rooms.get(r) == a for r, a in rooms.items()]))


@pytest.mark.parametrize("seed", [0, 2, 5])
@pytest.mark.parametrize(("planned", "rooms"), [(60, 20), (100, 30), (200, 50)])
def test_a_bent_map_is_placed_in_parts(planned: int, rooms: int, seed: int) -> None:
    prior, sample = seen("random", planned, rooms, seed)
    result = sg.match(sample.online, prior)
    assert result.verdict == "unique"
    assert result.certified
    best = result.best
    assert best is not None
    assert share_right(sample, best.rooms) == 1.0
    assert Judge(sample, prior, "likelihood").outcome(result) == "right"
    if isinstance(best, BentSolution):
        assert sg.match(sample.online, prior, config=RIGID).verdict == "none"
        for part in best.parts:
            assert len(part.rooms) >= 0.7 * 4


def test_some_of_them_are_too_bent_for_one_placement() -> None:
    bent = 0
    for seed in range(6):
        prior, sample = seen("random", 100, 30, seed)
        bent += isinstance(sg.match(sample.online, prior), BentResult)
    assert bent >= 4


@pytest.mark.parametrize("kind", ["random", "modular", "wings", "lshaped"])
@pytest.mark.parametrize("policy", ["none", "likelihood"])
def test_no_other_building_is_told(kind: str, policy: str) -> None:
    for seed in range(3):
        _, sample = seen(kind, 60, 20, 2 * seed)
        for prior in (
            make_layout(kind, 60, 2 * seed + 1),  # type: ignore[arg-type]
            mirrored(make_layout(kind, 60, 2 * seed)),  # type: ignore[arg-type]
        ):
            assert not sg.match(sample.online, prior, semantics=policy).unique  # type: ignore[arg-type]


def test_a_mirrored_plan_fits_worse_than_its_mirror_image() -> None:
    """The map is not too bent for its own plan; of the mirrored one two parts fit by chance."""
    building = make_layout("modular", 60, 170)
    sample = sample_online(building, 12, 85, COVERED)
    assert sg.match(sample.online, building, semantics="none").unique
    away = sg.match(sample.online, mirrored(building), semantics="none")
    assert away.verdict == "none"
    assert isinstance(away, BentResult)
    assert away.probability_mirrored > 0.99
    assert "parts of it" in away.reason
    assert "the plan is mirrored" in away.reason
    assert away.to_dict()["solutions"] == []


def test_a_mirror_image_that_was_not_searched_to_the_end_proves_nothing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    prior, sample = seen("random", 60, 20, 0)
    index = sg.PlanIndex(prior)
    assert isinstance(sg.match(sample.online, index), BentResult)
    assert sg.match(sample.online, index).certified
    image, solve = mirrored(sample.online), matcher._match_whole
    monkeypatch.setattr(bent_result, "mirrored", lambda graph: image)

    def cut_short(online: SceneGraph, *args: Any, **options: Any) -> MatchResult:
        result = solve(online, *args, **options)
        result.complete = result.complete and online is not image
        return result

    monkeypatch.setattr(matcher, "_match_whole", cut_short)
    result = sg.match(sample.online, index)
    assert result.verdict == "ambiguous"
    assert not result.certified
    assert "cut short" in result.reason


def test_a_building_that_maps_onto_itself_is_ambiguous() -> None:
    prior = make_layout("random", 60, 4, "global")
    sample = sample_online(prior, 24, 4, REALISTIC)
    result = sg.match(sample.online, prior, semantics="none")
    assert isinstance(result, BentResult)
    assert result.verdict == "ambiguous"
    assert any(share_right(sample, s.rooms) == 1.0 for s in result.solutions)
    assert any(share_right(sample, s.rooms) == 0.0 for s in result.solutions)


def test_the_parts_follow_the_bend() -> None:
    """Without noise each part lies where its rooms have it, and their rigid fit between them."""
    prior = make_layout("random", 100, 1)
    sample = sample_online(prior, 30, 1, BENT)
    best = sg.match(sample.online, prior).best
    assert isinstance(best, BentSolution)
    assert best.bend == pytest.approx(
        max(p.transform.yaw for p in best.parts) - min(p.transform.yaw for p in best.parts)
    )
    for part in best.parts:
        own = [sample.truth.room_placements[r] for r in part.rooms]
        yaws = [p.yaw for p in own]
        assert min(yaws) - 0.02 <= part.transform.yaw <= max(yaws) + 0.02
    center = np.mean([sample.online.room_by_id[r].center for r in best.rooms], axis=0)
    places = np.array([part.transform.points(center) for part in best.parts])
    middle = best.transform.points(center)
    assert np.all(places.min(axis=0) - 0.5 <= middle)
    assert np.all(middle <= places.max(axis=0) + 0.5)


@pytest.mark.parametrize("yaw", [1.0, -2.5])
def test_the_frame_makes_no_difference(yaw: float) -> None:
    prior, sample = seen("modular", 100, 30, 0)
    frame = Placement(40.0, -13.0, 0.0, yaw)
    one = sg.match(sample.online, prior)
    two = sg.match(transformed(sample.online, frame), prior)
    assert isinstance(one, BentResult)
    assert one.best is not None
    assert two.best is not None
    assert two.best.rooms == one.best.rooms
    back = two.best.transform.compose(frame)
    assert np.allclose(
        back.points((5.0, 5.0, 0.0)), one.best.transform.points((5.0, 5.0, 0.0)), atol=1e-4
    )


def test_an_update_gives_the_same() -> None:
    prior, sample = seen("random", 100, 30, 1)
    matcher = sg.Matcher(sg.PlanIndex(prior))
    result = None
    for rooms in (10, 20, 25, len(sample.online.rooms)):
        online = sample.online.replace(rooms=sample.online.rooms[:rooms])
        result = matcher.update(online)
        anew = sg.match(online, matcher.index)
        mine, theirs = result.to_dict(), anew.to_dict()
        for record in (mine, theirs):
            for changing in ("seconds", "hypotheses", "boxes", "steps"):
                record["stats"].pop(changing)
        assert mine == theirs
    assert isinstance(result, BentResult)


def test_what_the_answer_says() -> None:
    prior, sample = seen("random", 100, 30, 1)
    result = sg.match(sample.online, prior)
    record = json.loads(json.dumps(result.to_dict(), allow_nan=False))
    best = record["solutions"][0]
    assert record["stats"]["model"].startswith("at least 24 of 33 rooms")
    assert "bent" in record["reason"]
    assert f"{len(best['parts'])} parts" in record["reason"]
    assert record["count"] == len(record["solutions"]) == 1
    assert sorted(r for part in best["parts"] for r in part["rooms"]) == sorted(best["rooms"])
    for mapping in ("rooms", "planes", "objects"):
        assert len(set(best[mapping].values())) == len(best[mapping])
    # The picture has each room over its own of the plan.
    solution = read_record(record).solutions[0]
    graph = placed(sample.online, solution)
    off = [
        math.dist(graph.room_by_id[r].center[:2], prior.room_by_id[a].center[:2])
        for r, a in best["rooms"].items()
    ]
    assert max(off) < 0.6
    over = lay_over(survey(prior, ViewConfig()), sample.online, solution, ViewConfig())
    assert set(over.colors) == set(best["rooms"])


@given(
    st.lists(st.tuples(st.floats(-50, 50), st.floats(-50, 50)), min_size=1, max_size=12),
    st.floats(-3.1, 3.1),
    st.floats(-100, 100),
    st.floats(-100, 100),
)
def test_the_best_of_equal_placements_is_theirs(
    centers: list[tuple[float, float]], yaw: float, x: float, y: float
) -> None:
    place = Placement(x, y, 1.0, yaw)
    found = best_placement([place] * len(centers), np.array(centers), 1.0)
    assert abs(math.remainder(found.yaw - yaw, 2 * math.pi)) < 1e-9
    assert np.allclose((found.x, found.y, found.z), (x, y, 1.0), atol=1e-6)


def test_a_room_that_is_left_out_is_explained() -> None:
    prior, sample = seen("random", 100, 30, 4)
    result = sg.match(sample.online, prior)
    assert isinstance(result, BentResult)
    best = result.best
    assert best is not None
    left = [r for r in sample.truth.rooms if result.left_out(r)]
    assert left
    assert not set(left) & set(best.rooms)
    found = [explain_pair(result, r, sample.truth.rooms[r]) for r in left]
    assert any("fits nowhere beside the other parts" in e.sentence for e in found)
    for room, planned in best.rooms.items():
        assert explain_pair(result, room, planned).stage == "matched"


def test_none_says_that_parts_were_tried() -> None:
    _, sample = seen("random", 60, 20, 0)
    result = sg.match(sample.online, make_layout("random", 60, 1))
    assert result.verdict == "none"
    assert "nor do parts of the map by themselves" in result.reason


def test_small_maps_are_not_cut() -> None:
    assert not MatchingConfig().may_be_cut(11)
    assert MatchingConfig().may_be_cut(12)
    assert not RIGID.may_be_cut(100)
