"""Rooms with many planes, and searches that are cut short."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from situgraph.geometry.poses import Placement
from situgraph.matching import MatchingConfig, PlanIndex, calls
from situgraph.matching.matcher import match
from situgraph.scenegraph.graph import Plane, Room, SceneGraph
from situgraph.scenegraph.transform import transformed

MOTION = Placement(3.0, -7.0, 0.0, 0.7)
TEETH = 12


def comb(teeth: int = TEETH) -> SceneGraph:
    """A hall with niches of several widths along one side, and a small room beside it."""
    xs = list(itertools.accumulate([0.8 + 0.1 * (k * 7 % 5) for k in range(2 * teeth)], initial=0))
    end = xs[-1]
    faces = [((0.0, 1.0), 0.0), ((1.0, 0.0), 0.0), ((-1.0, 0.0), end)]
    for k in range(2 * teeth):
        faces.append(((0.0, -1.0), 6.0 + 1.5 * (k % 2)))
        if k:
            faces.append(((1.0, 0.0) if k % 2 else (-1.0, 0.0), -xs[k] if k % 2 else xs[k]))
    room = [((1.0, 0.0), 4.2), ((-1.0, 0.0), -0.2), ((0.0, 1.0), 0.0), ((0.0, -1.0), 3.0)]
    planes, names = [], []
    for group, made in (("h", faces), ("r", room)):
        names.append(tuple(f"{group}{k}" for k in range(len(made))))
        planes += [Plane(n, (*f, 0.0), d) for n, (f, d) in zip(names[-1], made)]
    rooms = (Room("hall", (end / 2, 3.0, 1.3), names[0]), Room("room", (-2.2, 1.5, 1.3), names[1]))
    return SceneGraph(rooms=rooms, planes=tuple(planes))


def noisy(graph: SceneGraph) -> SceneGraph:
    rng = np.random.default_rng(0)
    return graph.replace(
        planes=tuple(
            Plane(p.id, p.normal, p.offset + float(rng.normal(0, 0.03))) for p in graph.planes
        )
    )


@pytest.mark.parametrize("rooms", [1, 2])
def test_a_room_of_fifty_planes_is_found(rooms: int) -> None:
    prior = comb()
    seen = noisy(transformed(prior.replace(rooms=prior.rooms[:rooms]), MOTION))
    result = match(seen, PlanIndex(prior), semantics="none")
    assert result.complete
    best, truth = result.solutions[0], MOTION.inverse()
    assert math.hypot(best.transform.x - truth.x, best.transform.y - truth.y) < 0.2
    assert best.rooms["hall"] == "hall"
    assert len(best.planes) >= len(seen.rooms[0].planes) - 2


def test_a_small_room_is_looked_for_in_the_whole_of_a_hall_of_two_hundred_walls() -> None:
    prior = comb(50)
    room = prior.rooms[1]
    seen = noisy(transformed(prior.replace(rooms=(room,)), MOTION))
    config = MatchingConfig(rival_ratio=0.0)
    result = match(seen, PlanIndex(prior, config), semantics="none")
    assert result.complete
    assert {s.rooms["room"] for s in result.solutions} == {"room", "hall"}


def test_a_room_of_few_planes_with_many_counterparts_is_assigned_all_the_same() -> None:
    faces = [((1.0, 0.0), 0.01 * k) for k in range(60)] + [((0.0, 1.0), 0.0), ((0.0, -1.0), 3.0)]
    narrow = [faces[k] for k in (0, 9, 18, 27, 36, 45, 60, 61)]
    seen, prior = (
        SceneGraph(
            rooms=(Room("hall", (1.0, 1.5, 1.3), tuple(f"h{k}" for k in range(len(made)))),),
            planes=tuple(Plane(f"h{k}", (*f, 0.0), d) for k, (f, d) in enumerate(made)),
        )
        for made in (narrow, faces)
    )
    result = match(seen, PlanIndex(prior), semantics="none")
    assert result.complete
    assert result.best is not None
    assert len(set(result.best.planes.values())) == len(narrow)


@pytest.mark.parametrize("limit", ["max_boxes", "max_work"])
def test_a_search_cut_short_is_never_unique_and_says_so(limit: str) -> None:
    prior = comb()
    config = MatchingConfig(**{limit: 1})
    result = match(transformed(prior, MOTION), PlanIndex(prior, config), semantics="none")
    assert not result.complete
    assert not result.unique
    assert not result.certified
    assert "cut short" in result.reason


@pytest.mark.parametrize("limit", [20_000, 100_000, 200_000])
def test_a_search_ends_soon_after_its_last_step(limit: int) -> None:
    prior = comb()
    seen = noisy(transformed(prior.replace(rooms=prior.rooms[:1]), MOTION))
    config = MatchingConfig(max_work=limit)
    result = match(seen, PlanIndex(prior, config), semantics="none")
    assert not result.complete
    assert limit < result.stats["steps"] < limit + 100_000  # one climb in the hall


def test_a_search_that_lacks_room_has_no_more_steps_for_it(monkeypatch: pytest.MonkeyPatch) -> None:
    prior = comb()
    seen = noisy(transformed(prior.replace(rooms=prior.rooms[1:]), MOTION))
    config = MatchingConfig(rival_ratio=0.0)
    begun_again = match(seen, prior, semantics="none", config=config)
    monkeypatch.setattr(calls, "ROOM", 1_000)
    enough = match(seen, prior, semantics="none", config=config)
    assert begun_again.candidates == enough.candidates
    assert begun_again.stats["steps"] > enough.stats["steps"]
