"""What ``match`` promises, on small buildings made here."""

from __future__ import annotations

import json
import math

import pytest

from situgraph.errors import InputError
from situgraph.geometry.poses import Placement
from situgraph.matching import Matcher, MatchingConfig, PlanIndex, compiled, entries, matcher
from situgraph.matching.matcher import match
from situgraph.plan.layouts import make_layout
from situgraph.plan.sampler import sample_online
from situgraph.plan.sampler_config import REALISTIC
from situgraph.plan.six_rooms import six_rooms
from situgraph.scenegraph.graph import Plane, Room, SceneGraph
from situgraph.scenegraph.transform import transformed

RECTANGLES = [
    (0, 0, 4, 3),
    (4.2, 0, 5, 3),
    (0, 3.2, 4, 5.5),
    (4.2, 3.2, 2.5, 5.5),
    (6.9, 3.2, 3.3, 4.1),
]
MOTION = Placement(3.0, -7.0, 0.0, 0.7)


def building(rectangles: list[tuple[float, float, float, float]]) -> SceneGraph:
    """Rectangular rooms (x, y, width, depth)."""
    rooms, planes = [], []
    for k, (x, y, w, h) in enumerate(rectangles):
        faces = [((1.0, 0.0), -x), ((-1.0, 0.0), x + w), ((0.0, 1.0), -y), ((0.0, -1.0), y + h)]
        names = tuple(f"p{k}.{i}" for i in range(4))
        planes += [Plane(n, (*f, 0.0), d) for n, (f, d) in zip(names, faces)]
        rooms.append(Room(f"r{k}", (x + w / 2, y + h / 2, 1.3), names))
    return SceneGraph(rooms=tuple(rooms), planes=tuple(planes))


def near(one: Placement, two: Placement) -> bool:
    turned = math.remainder(one.yaw - two.yaw, 2 * math.pi)
    return math.hypot(one.x - two.x, one.y - two.y) < 0.05 and abs(turned) < 0.01


def test_a_moved_copy_is_unique_and_certified() -> None:
    prior = building(RECTANGLES)
    result = match(transformed(prior, MOTION), PlanIndex(prior))
    assert result.verdict == "unique"
    assert result.certified
    best = result.solutions[0]
    assert near(best.transform, MOTION.inverse())
    assert best.rooms == {r.id: r.id for r in prior.rooms}
    assert best.planes == {p.id: p.id for p in prior.planes}
    assert best.deviations == ()


def test_one_long_wall_moved_rather_than_three_short_ones() -> None:
    depths = (3.0, 4.0, 5.2)
    prior = building([(x, 0, w, d) for (x, w), d in zip([(0, 4), (4.2, 5), (9.4, 3.3)], depths)])
    # Every room has become 35 cm deeper: the wall along all of them, or each one's far wall.
    built = [(x, -0.35, w, d + 0.35) for (x, w), d in zip([(0, 4), (4.2, 5), (9.4, 3.3)], depths)]
    result = match(building(built), PlanIndex(prior), semantics="none")
    assert result.verdict == "unique"
    assert near(result.solutions[0].transform, Placement())
    assert {d.plane for d in result.solutions[0].deviations} == {"p0.2", "p1.2", "p2.2"}


def test_a_map_that_drift_has_bent_keeps_its_place() -> None:
    prior = make_layout("wings", 24, 80)
    sample = sample_online(prior, 10, 80, REALISTIC)  # 70 m walked
    result = match(sample.online, PlanIndex(prior), semantics="none")
    assert result.verdict == "unique"
    assert result.best is not None
    apart = math.dist(
        result.best.transform.points([[0.0, 0.0]])[0],
        sample.truth.placement.points([[0.0, 0.0]])[0],
    )
    assert apart < 0.5  # where the walk began, at the edge of the map
    rigid = PlanIndex(prior, MatchingConfig(map_bend=0.0))
    assert match(sample.online, rigid, semantics="none").verdict == "none"


def test_offsets_err_the_more_the_wider_the_map() -> None:
    config = MatchingConfig()
    sigmas = [config.sigma_of(spread) for spread in (0.0, 1.0, 5.0, 8.0, 11.0, 50.0)]
    assert sigmas[0] == config.plane_sigma
    assert sigmas == sorted(sigmas)
    assert sigmas[2] == math.ceil(1e3 * math.hypot(0.06, math.radians(2) / 50 * 25)) / 1e3
    assert sigmas[-1] == 0.087  # as if spread evenly over what fits
    assert MatchingConfig(plane_sigma=0.1).sigma_of(50.0) == 0.1


def test_a_mirror_image_is_never_unique() -> None:
    prior = building(RECTANGLES)
    mirrored = building([(-x - w, y, w, h) for x, y, w, h in RECTANGLES])
    assert not match(mirrored, prior).unique


def test_a_square_room_has_four_placements() -> None:
    prior = building([(0, 0, 4, 4)])
    result = match(transformed(prior, MOTION), prior)
    assert result.verdict == "ambiguous"
    assert result.count == 4


def test_a_corridor_alone_fixes_nothing() -> None:
    whole = building([(0, 0, 9, 2)])
    corridor = whole.replace(rooms=(Room("c", (4.5, 1.0, 1.3), whole.rooms[0].planes[2:]),))
    assert match(corridor, whole).verdict == "none"


def test_two_crossing_corridors_fix_the_placement() -> None:
    prior = building([(0, 0, 12, 2), (3, 2.2, 1.5, 9)])
    one, two = prior.rooms
    seen = prior.replace(
        rooms=(Room("a", one.center, one.planes[2:]), Room("b", two.center, two.planes[:2]))
    )
    result = match(transformed(seen, MOTION), prior)
    assert any(near(s.transform, MOTION.inverse()) for s in result.solutions)


def test_corridors_that_are_in_no_plan_do_not_hide_the_rooms_beside_them() -> None:
    rooms = [(0, 0, 4, 3), (20, 0, 5, 3.6), (40, 0, 3.3, 4.1)]
    beside = [(0, 4, 9, 1.5), (20, 5, 9, 2.2), (40, 6, 9, 1.8)]
    planned = [(3, -20, 9, 1.2), (22, -30, 9, 2.4), (30, -40, 9, 1.7), (41, -50, 9, 2.9)]
    whole = building([*rooms, *beside, *planned])
    sides = [r if k < 3 else Room(r.id, r.center, r.planes[2:]) for k, r in enumerate(whole.rooms)]
    seen = whole.replace(rooms=tuple(sides))
    prior = seen.replace(rooms=(*sides[:3], *sides[6:]))
    result = match(transformed(seen, MOTION), prior)
    assert any(near(s.transform, MOTION.inverse()) for s in result.solutions)


def test_the_json_is_complete_and_strict() -> None:
    prior = building(RECTANGLES)
    found = match(transformed(prior, MOTION), prior).to_dict()
    again = json.loads(json.dumps(found, allow_nan=False))
    assert again["format"] == "situgraph/match"
    assert again["stats"]["model"].startswith("at least 4 of 5 rooms")
    assert set(again["solutions"][0]["transform"]) == {"x", "y", "z", "yaw"}
    assert again["stats"]["room_candidates"]["type"] == 25


def test_a_room_that_names_no_plane_is_refused() -> None:
    prior = building(RECTANGLES)
    broken = prior.replace(planes=prior.planes[1:])
    with pytest.raises(InputError, match=r"p0\.0"):
        match(broken, prior)


@pytest.mark.parametrize("rooms", [(), (Room("a", (0.0, 0.0, 1.4), ()),)])
def test_a_plan_without_walls_holds_nobody(rooms: tuple[Room, ...]) -> None:
    result = match(six_rooms(), SceneGraph(rooms=rooms))
    assert result.verdict == "none"
    assert result.probability_outside == 1.0
    assert result.to_dict()["solutions"] == []


def test_updates_are_matches_from_scratch() -> None:
    prior = building(RECTANGLES)
    online = transformed(prior, MOTION)
    matcher = Matcher(prior)
    for k in range(1, len(online.rooms) + 1):
        part = online.replace(rooms=online.rooms[:k])
        one, two = matcher.update(part), match(part, matcher.index)
        assert (one.verdict, one.count) == (two.verdict, two.count)
        assert [s.transform for s in one.solutions] == [s.transform for s in two.solutions]
    assert matcher.update(part) is one


@pytest.mark.parametrize("semantics", ["none", "containment", "likelihood"])
def test_an_object_more_is_a_match_from_scratch(semantics: str) -> None:
    plan = six_rooms()
    online = sample_online(plan, 2, 0, REALISTIC).online
    matcher = Matcher(plan, semantics=semantics)  # type: ignore[arg-type]
    for k in range(len(online.objects) + 1):
        part = online.replace(objects=online.objects[:k])
        one = matcher.update(part)
        two = match(part, matcher.index, semantics=semantics)  # type: ignore[arg-type]
        mine, theirs = one.to_dict(), two.to_dict()
        for found in (mine, theirs):
            del found["stats"]["seconds"]
        assert mine == theirs


def test_the_first_use_ever_says_that_it_compiles(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(compiled, "_FOLDER", None)
    monkeypatch.setattr(matcher, "run", compiled.entry(entries.run.py_func))
    prior = building(RECTANGLES)
    match(prior, prior)
    assert "compiling" in capsys.readouterr().err
