"""Objects as evidence in the search: as the brute force has it, whatever their order and frame."""

from __future__ import annotations

import math
import random

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from situgraph.experiments.oracle.answer import explained_at
from situgraph.experiments.oracle.definition import Definition
from situgraph.experiments.oracle.objects import most_object_evidence, object_evidence
from situgraph.experiments.oracle.problem import Problem
from situgraph.geometry.poses import Placement
from situgraph.matching import MatchingConfig, PlanIndex
from situgraph.matching.drafting import bound
from situgraph.matching.preparation import prepare
from situgraph.plan.layouts import make_layout
from situgraph.scenegraph.graph import Object, Plane, Room, SceneGraph
from situgraph.scenegraph.transform import transformed

PLAN = make_layout("random", 6, 4, object_density=0.4)
INDEX = PlanIndex(PLAN)
HERE = Placement()
APART = MatchingConfig(object_shared=0.0)
offsets = st.floats(-0.5, 0.5)


@st.composite
def sights(draw: st.DrawFn) -> SceneGraph:
    """What is seen of a plan's objects: off their places, on other walls, of fewer rooms, twice."""
    off = [draw(offsets), draw(offsets)] if draw(st.booleans()) else [0.0, 0.0]
    found = []
    for item in draw(st.lists(st.sampled_from(PLAN.objects), max_size=12)):
        x, y, z = item.center
        near = draw(st.sampled_from((0.0, 0.2, 1.0)))
        # Never one equally far from two objects: it could then be a sight of either.
        apart = 0.001 * math.sqrt(2 + len(found))
        center = (x + off[0] + near * draw(offsets) + apart, y + off[1] + near * draw(offsets), z)
        rooms, planes = list(item.rooms), list(item.planes)
        change = draw(st.integers(0, 7))
        if change == 0 and len(rooms) > 1:
            rooms = rooms[1:]
        elif change == 1:
            rooms.append(draw(st.sampled_from(PLAN.rooms)).id)
        elif change == 2:
            planes = [draw(st.sampled_from(PLAN.planes)).id]
        related = tuple(dict.fromkeys(rooms)), tuple(planes)
        found.append(Object(f"o{len(found)}", item.category, center, None, *related))
    return PLAN.replace(objects=tuple(found))


def evidence(
    online: SceneGraph,
    place: Placement = HERE,
    index: PlanIndex = INDEX,
    config: MatchingConfig | None = None,
) -> float:
    """What the search says of the objects at a placement."""
    inputs = prepare(online, index, "likelihood", config or MatchingConfig())
    if not inputs.weighs_objects:
        return 0.0
    x, y = Placement(place.x, place.y, 0.0, place.yaw).points(inputs.middle) - index.origin
    at = np.array([[place.yaw, x, y]])
    return float(inputs.evidence(np.zeros(1, dtype=np.int64), at)[0][0])


def written_out(online: SceneGraph) -> float:
    problem = Problem(online, PLAN, "likelihood", Definition())
    return object_evidence(problem, explained_at(problem, HERE))


@given(sights())
def test_the_search_weighs_objects_as_the_brute_force_does(online: SceneGraph) -> None:
    assert evidence(online) == pytest.approx(written_out(online), abs=1e-6)


@given(sights(), st.randoms(use_true_random=False))
def test_the_order_of_objects_rooms_and_planes_does_not_matter(
    online: SceneGraph, chance: random.Random
) -> None:
    objects = chance.sample(online.objects, len(online.objects))
    mixed = online.replace(
        objects=tuple(
            msgspec.structs.replace(
                o,
                rooms=tuple(chance.sample(o.rooms, len(o.rooms))),
                planes=tuple(chance.sample(o.planes, len(o.planes))),
            )
            for o in objects
        )
    )
    assert evidence(mixed) == pytest.approx(evidence(online), abs=1e-9)


@given(sights(), st.floats(-3.0, 3.0), st.floats(-30, 30), st.floats(-30, 30))
def test_the_frames_do_not_matter(online: SceneGraph, yaw: float, x: float, y: float) -> None:
    frame = Placement(x, y, 0.0, yaw)
    moved = evidence(transformed(online, frame.inverse()), frame)
    assert moved == pytest.approx(evidence(online), abs=1e-6)
    assert evidence(
        transformed(online, frame), HERE, PlanIndex(transformed(PLAN, frame))
    ) == pytest.approx(evidence(online), abs=1e-6)


@given(sights())
def test_an_object_alone_on_its_wall_says_what_it_said(online: SceneGraph) -> None:
    one = online.replace(objects=online.objects[:1])
    assert evidence(one) == evidence(one, config=APART)
    # In the middle of their rooms, on no wall.
    loose = online.replace(
        objects=tuple(msgspec.structs.replace(o, planes=()) for o in online.objects)
    )
    assert evidence(loose) == evidence(loose, config=APART)


@given(sights())
def test_nothing_exceeds_the_most_there_can_be(online: SceneGraph) -> None:
    walls, both = (
        bound(inputs.draft.place, inputs.limits.slots.place, 0.0)[0]
        for inputs in (prepare(online, INDEX, s, MatchingConfig()) for s in ("none", "likelihood"))
    )
    most = both - walls
    problem = Problem(online, PLAN, "likelihood", Definition())
    assert most == pytest.approx(most_object_evidence(problem))
    assert evidence(online) <= most + 1e-9


def one_wall(*along: float) -> SceneGraph:
    """A room with windows along its southern wall."""
    planes = (
        Plane("s", (0.0, 1.0, 0.0), 3.0),
        Plane("e", (-1.0, 0.0, 0.0), 6.0),
        Plane("n", (0.0, -1.0, 0.0), 3.0),
        Plane("w", (1.0, 0.0, 0.0), 6.0),
    )
    room = Room("a", (0.0, 0.0, 1.4), ("s", "e", "n", "w"))
    windows = tuple(window(f"w{k}", x) for k, x in enumerate(along))
    return SceneGraph(rooms=(room,), planes=planes, objects=windows)


def window(name: str, along: float, across: float = 0.0) -> Object:
    return Object(name, "window", (along, across - 3.0, 1.5), None, ("a",), ("s",))


def gained(off: tuple[float, ...]) -> float:
    """What windows of one wall say together, beyond what they say one by one."""
    places = (-4.0, -1.5, 1.5, 4.0)[: len(off)]
    plan = PlanIndex(one_wall(*places))
    seen = one_wall(*(p + d for p, d in zip(places, off)))
    return evidence(seen, index=plan) - evidence(seen, index=plan, config=APART)


def test_distances_along_a_wall_tell_more_than_places() -> None:
    assert gained((0.3, 0.3, 0.3)) > gained((0.0, 0.0, 0.0)) > 0
    assert gained((0.3, -0.3, 0.3)) < 0
    assert gained((0.3, -0.3, 0.3)) == pytest.approx(gained((-0.3, 0.3, -0.3)))


def test_an_object_of_the_tail_spoils_nothing_for_the_others() -> None:
    assert gained((0.3, 0.3, 0.3, -0.99)) == pytest.approx(gained((0.3, 0.3, 0.3)), abs=0.05)
    assert abs(gained((0.3, 0.99, -0.99))) < 0.05


def test_together_they_are_a_density_whose_marginal_is_that_of_one() -> None:
    """The sum over all places of the second window, given where the first one is."""
    plan, step, total = one_wall(-1.5, 1.5), 0.1, 0.0
    index = PlanIndex(plan)
    for x in np.arange(-1.45, 1.5, step):
        for y in np.arange(-1.45, 1.5, step):
            square = x * x + y * y
            bell = 0.9 * math.exp(-8 * square) * 8 / math.pi
            alone = bell + (0.1 / math.pi if square <= 1 else 0.0)
            seen = plan.replace(objects=(window("w0", -1.2), window("w1", 1.5 + x, y)))
            together = evidence(seen, index=index) - evidence(seen, index=index, config=APART)
            total += alone * math.exp(together) * step**2
    assert total == pytest.approx(1.0, abs=0.01)
