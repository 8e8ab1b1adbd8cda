"""A graph that grows: each update gives exactly what a match from scratch gives."""

from __future__ import annotations

import math
import re
from typing import Any

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from situgraph.experiments.oracle.cases import ERRORS, draw
from situgraph.matching import Matcher, MatchingConfig, MatchResult, PlanIndex, match
from situgraph.matching.preparation import Inputs
from situgraph.plan.layouts import make_layout
from situgraph.plan.sampler import sample_online
from situgraph.plan.sampler_config import REALISTIC
from situgraph.scenegraph.graph import SceneGraph

MOST = 40  # candidates that are compared


def told(result: MatchResult) -> list[Any]:
    """What a match says, but for how many hypotheses it took."""
    rank = range(min(result.candidates, MOST))
    candidates = [c.to_dict() for k in rank if (c := result.candidate(k)) is not None]
    sums = (result.verdict, result.count, result.candidates, result.complete)
    reason = re.sub(r" \(\d+ tried\)", "", result.reason)
    shares = (result.probability_outside, result.probability_mirrored)
    return [candidates, sums, reason, shares, result.stats["room_candidates"]]


def grown(online: SceneGraph, order: list[int], steps: list[int]) -> list[SceneGraph]:
    """The graph with its first rooms of an order, more with each step."""
    counts = np.minimum(np.cumsum(steps), len(order))
    return [online.replace(rooms=tuple(online.rooms[k] for k in order[:n])) for n in counts]


def check(matcher: Matcher, states: list[SceneGraph]) -> None:
    for state in states:
        found = matcher.update(state)
        again = match(state, matcher.index, semantics=matcher.semantics, config=matcher.config)
        assert told(found) == told(again)


@given(st.integers(0, 10**6), st.data())
@settings(max_examples=50, deadline=None)
def test_rooms_in_any_order(number: int, data: st.DataObject) -> None:
    case = draw(number)
    prior, sample = case.graphs()
    order = data.draw(st.permutations(range(len(sample.online.rooms))))
    steps = data.draw(st.lists(st.sampled_from([1, 1, 1, 2, 3]), min_size=6, max_size=6))
    check(Matcher(prior, semantics=case.policy), grown(sample.online, order, steps))


@pytest.mark.parametrize(
    ("kind", "symmetry", "errors"),
    [
        ("random", "none", "rough"),
        ("grid", "local", "noisy"),
        ("corridor", "global", "realistic"),
        ("storeys", "local", "realistic"),
    ],
)
def test_longer_walks(kind: Any, symmetry: Any, errors: str) -> None:
    prior = make_layout(kind, 40, 3, symmetry)
    online = sample_online(prior, 12, 3, ERRORS[errors]).online
    rooms = len(online.rooms)
    check(Matcher(prior), grown(online, list(range(rooms)), [1] * rooms))


def test_a_long_search() -> None:
    """How much was searched must not decide what is found: an update searches less."""
    prior = make_layout("grid", 500, 2, "local")
    online = sample_online(prior, 12, 2, ERRORS["rough"]).online
    check(Matcher(prior), grown(online, list(range(4)), [1] * 4))


def test_rooms_that_change_or_go_are_matched_anew() -> None:
    prior = make_layout("random", 30, 1)
    online = sample_online(prior, 8, 1, REALISTIC).online
    moved = msgspec.structs.replace(online.planes[0], offset=online.planes[0].offset + 0.05)
    other = online.replace(planes=(moved, *online.planes[1:]))
    states = [online, other, other.replace(rooms=other.rooms[2:]), online.replace(rooms=())]
    check(Matcher(prior), [online.replace(rooms=online.rooms[:5]), *states, online])


def test_a_search_that_was_cut_short_is_no_start() -> None:
    prior = make_layout("grid", 30, 1, "local")
    online = sample_online(prior, 8, 1, REALISTIC).online
    config = MatchingConfig(max_boxes=20)
    matcher = Matcher(PlanIndex(prior), config=config)
    states = grown(online, list(range(len(online.rooms))), [1] * len(online.rooms))
    check(matcher, states)
    assert not match(states[1], matcher.index, config=config).complete


def test_rooms_of_parallel_planes() -> None:
    """They anchor nothing, and what they leave open a later room can fix."""
    prior = make_layout("random", 20, 5)
    online = sample_online(prior, 8, 5, ERRORS["noisy"]).online
    angle = {p.id: math.atan2(p.normal[1], p.normal[0]) for p in online.planes}
    rooms = []
    for k, room in enumerate(online.rooms):
        first = angle[room.planes[0]] if room.planes else 0.0
        along = [p for p in room.planes if abs(math.sin(angle[p] - first)) < 0.3]
        rooms.append(msgspec.structs.replace(room, planes=tuple(along)) if k % 3 else room)
    partly = online.replace(rooms=tuple(rooms))
    for order in (list(range(len(rooms))), list(range(len(rooms)))[::-1]):
        check(Matcher(prior, semantics="none"), grown(partly, order, [1] * len(rooms)))


@pytest.mark.parametrize("seed", range(4))
def test_rooms_in_another_order_with_each_update(seed: int) -> None:
    """What is known of a room goes with it, wherever it is listed."""
    prior = make_layout("random", 40, seed)
    online = sample_online(prior, 12, seed, ERRORS["noisy"]).online
    rng = np.random.default_rng(seed)
    states = []
    for n in range(2, 12):
        order = rng.permutation(n) if n % 3 else np.roll(np.arange(n), 1)
        states.append(online.replace(rooms=tuple(online.rooms[k] for k in order)))
    check(Matcher(prior), states)


@pytest.mark.parametrize("kind", ["random", "storeys"])
def test_planes_and_objects_come_with_their_rooms(kind: Any) -> None:
    prior = make_layout(kind, 40, 4)
    online = sample_online(prior, 20, 4, REALISTIC).online
    check(Matcher(prior), [so_far(online, n) for n in range(1, 20)])


def so_far(online: SceneGraph, rooms: int) -> SceneGraph:
    """What had been seen of a graph when it had so many rooms."""
    seen = online.rooms[:rooms]
    names = {room.id for room in seen}
    planes = {plane for room in seen for plane in room.planes}
    return online.replace(
        rooms=seen,
        planes=tuple(p for p in online.planes if p.id in planes),
        objects=tuple(o for o in online.objects if names.intersection(o.rooms)),
    )


@pytest.mark.parametrize("kind", ["random", "storeys"])
def test_a_map_that_moves_and_then_grows(kind: Any) -> None:
    prior = make_layout(kind, 30, 2)
    online = sample_online(prior, 14, 2, REALISTIC).online
    states = [online.replace(rooms=online.rooms[:n]) for n in (4, 6, 8, 10, 11, 12, 13)]
    for k in (1, 2):  # by a millimetre
        states[k] = moved(states[k], 0.001 * k)
    check(Matcher(prior), states)


def moved(online: SceneGraph, along: float) -> SceneGraph:
    """The graph, so far along x."""
    return online.replace(
        rooms=tuple(
            msgspec.structs.replace(r, center=(r.center[0] + along, *r.center[1:]))
            for r in online.rooms
        ),
        planes=tuple(
            msgspec.structs.replace(p, offset=p.offset - along * p.normal[0]) for p in online.planes
        ),
    )


def test_the_mirror_image_is_seldom_searched(monkeypatch: pytest.MonkeyPatch) -> None:
    """That nothing can be there is known of the rooms before, until more could be unexplained."""
    searched = []

    def mirrored(inputs: Inputs) -> Inputs:
        searched.append(inputs.count)
        return image_of(inputs)

    image_of = Inputs.mirrored
    monkeypatch.setattr(Inputs, "mirrored", mirrored)
    prior = make_layout("random", 100, 0)
    online = sample_online(prior, 24, 0, ERRORS["noisy"]).online
    matcher = Matcher(prior)
    verdicts = [matcher.update(s).verdict for s in grown(online, list(range(24)), [1] * 24)]
    assert verdicts[4:] == ["unique"] * 20
    assert len(searched) < 12


def test_an_update_tries_little() -> None:
    prior = make_layout("random", 100, 0)
    online = sample_online(prior, 10, 0, REALISTIC).online
    matcher = Matcher(prior)
    tried, anew = 0, 0
    for state in grown(online, list(range(len(online.rooms))), [1] * len(online.rooms)):
        found, again = matcher.update(state), match(state, matcher.index)
        if len(state.rooms) > 3:
            tried, anew = tried + found.stats["hypotheses"], anew + again.stats["hypotheses"]
    assert tried < anew / 2
