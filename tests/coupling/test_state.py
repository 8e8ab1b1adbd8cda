"""Located, doubted, confirmed, withdrawn: sequences of growing graphs, without SLAM."""

from __future__ import annotations

import math

import msgspec
import pytest
from tests.coupling.plans import PRIOR

from situgraph.coupling.state import Locator, unexplained
from situgraph.geometry.poses import Placement
from situgraph.matching import Matcher, MatchResult, PlanIndex
from situgraph.matching.bent_result import BentResult
from situgraph.plan.layouts import make_layout
from situgraph.plan.sample_prefix import first_rooms
from situgraph.plan.sampler import Sampler, sample_online
from situgraph.plan.sampler_config import PAPER_DETECTOR, REALISTIC, SamplerConfig
from situgraph.scenegraph.graph import SceneGraph
from situgraph.scenegraph.transform import transformed

NOISE = msgspec.structs.replace(
    REALISTIC,
    plane_offset_sigma=0.01,
    drift=0.0,
    false_rooms=0.0,
    missing_planes=0.0,
    moved_walls=0.0,
    detection=PAPER_DETECTOR,
)
HALF = (10.65, 5.275)  # the middle of the building, x and y


def growing(seed: int, config: SamplerConfig = NOISE, start: str | None = None) -> list[SceneGraph]:
    whole = Sampler(PRIOR, config).sample(6, seed, start)
    return [first_rooms(whole, PRIOR, k).online for k in range(1, 7)]


def follow(graphs: list[SceneGraph], locator: Locator) -> list[str]:
    for stamp, graph in enumerate(graphs):
        locator.update(graph, float(stamp))
    return [e.happening for e in locator.events]


@pytest.mark.parametrize("seed", range(4))
def test_a_good_match_is_adopted_once_and_kept(seed: int) -> None:
    locator = Locator(Matcher(PlanIndex(PRIOR)), PRIOR)
    assert locator.since is None
    assert follow(growing(seed), locator) == ["located"]
    assert locator.located
    assert locator.since == locator.events[0].stamp


class Misled:
    """Matches two rooms with the plan turned by half: what it finds looks right and is wrong."""

    def __init__(self) -> None:
        x, y = 2 * HALF[0], 2 * HALF[1]
        self._wrong = Matcher(PlanIndex(transformed(PRIOR, Placement(x, y, 0.0, math.pi))))
        self._right = Matcher(PlanIndex(PRIOR))

    def update(self, online: SceneGraph) -> MatchResult:
        return (self._wrong if len(online.rooms) < 3 else self._right).update(online)


@pytest.mark.parametrize("seed", range(4))
def test_a_wrong_first_match_is_withdrawn_and_recovered_from(seed: int) -> None:
    truth = Sampler(PRIOR, NOISE).sample(6, seed).truth.placement
    locator = Locator(Misled(), PRIOR)
    assert follow(growing(seed), locator) == ["located", "withdrawn", "located"]
    assert "another placement" in locator.events[1].reason
    assert locator.pairs is not None
    middle = truth.inverse().points((*HALF, 1.4))
    assert locator.pairs.placement.points(middle) == pytest.approx((*HALF, 1.4), abs=0.3)


def test_a_false_room_raises_doubt_but_does_not_throw_the_match_away() -> None:
    config = msgspec.structs.replace(NOISE, false_rooms=0.34)
    told = []
    for seed in range(4):
        locator = Locator(Matcher(PlanIndex(PRIOR)), PRIOR)
        follow(growing(seed, config), locator)
        assert locator.located
        told += [e for e in locator.events if e.rooms > 2]
    happened = [e.happening for e in told]
    assert "doubted" in happened
    assert "confirmed" in happened
    assert "withdrawn" not in happened


def test_another_building_is_withdrawn_from() -> None:
    """What was one room of the plan goes on as no plan does."""
    graphs = growing(0)
    locator = Locator(Matcher(PlanIndex(PRIOR)), PRIOR)
    locator.update(graphs[1], 0.0)
    assert locator.located
    stretched = tuple(msgspec.structs.replace(p, offset=1.7 * p.offset) for p in graphs[-1].planes)
    locator.update(graphs[-1].replace(planes=stretched), 1.0)
    assert not locator.located
    assert locator.events[-1].happening == "withdrawn"
    assert "explains" in locator.events[-1].reason


def test_rooms_that_are_none_of_the_plan_are_named() -> None:
    graph = growing(1)[-1]
    locator = Locator(Matcher(PlanIndex(PRIOR)), PRIOR)
    locator.update(graph, 0.0)
    assert locator.pairs is not None
    config = locator._config
    assert unexplained(graph, PRIOR, locator.pairs, config) == ()
    room = graph.rooms[0]
    far = tuple(
        msgspec.structs.replace(
            r,
            center=(r.center[0] + 300.0, r.center[1], r.center[2]),
            footprint=tuple((x + 300.0, y) for x, y in r.footprint or ()),
        )
        if r.id == room.id
        else r
        for r in graph.rooms
    )
    assert unexplained(graph.replace(rooms=far), PRIOR, locator.pairs, config) == (room.id,)


@pytest.mark.parametrize("seed", [0, 3, 4])
def test_a_map_that_bends_as_it_grows_stays_where_it_is(seed: int) -> None:
    prior = make_layout("random", 100, seed)
    sample = sample_online(prior, 30, seed, REALISTIC)
    entered = {room: k for k, room in enumerate(sample.truth.order)}
    rooms = sorted((r for r in sample.online.rooms if r.id in entered), key=lambda r: entered[r.id])
    locator = Locator(Matcher(PlanIndex(prior)), prior)
    bent = 0
    for seen in range(4, len(rooms) + 1, 2):
        online = sample.online.replace(rooms=tuple(rooms[:seen]))
        bent += isinstance(locator.update(online, float(seen)), BentResult)
        if locator.pairs is not None:
            assert all(sample.truth.rooms[r] == a for r, a in locator.pairs.rooms.items())
    assert bent >= 1
    assert locator.located
    assert "withdrawn" not in [event.happening for event in locator.events]
