"""The brute force's own evidence against numbers worked out by hand from docs/matching.md."""

from __future__ import annotations

import math

import msgspec
import pytest

from situgraph.experiments.oracle.answer import explained_at
from situgraph.experiments.oracle.comparison import compare
from situgraph.experiments.oracle.definition import Definition
from situgraph.experiments.oracle.explained import FIT, MISSING, MOVED, pair_up
from situgraph.experiments.oracle.grids import grid
from situgraph.experiments.oracle.likelihood import evidence, plan_area, wall_evidence
from situgraph.experiments.oracle.problem import Problem
from situgraph.experiments.oracle.verdict import answer
from situgraph.experiments.oracle.wall_lines import tied
from situgraph.geometry.poses import Placement
from situgraph.matching import PlanIndex, match
from situgraph.scenegraph.graph import Object, Plane, SceneGraph, Storey

HERE = Placement()
FITS = math.log(0.94 * 10 / (math.sqrt(2 * math.pi) * 0.06))
MOVES = math.log(0.03 * 10 / 0.8)
SEEN = math.log(0.9)
# The density of the difference of two faces against anywhere in 0.8 m.
TOGETHER = math.log(0.9 * 0.8 / 0.03 / (math.sqrt(4 * math.pi) * 0.06) + 0.1)


def wall(graph: SceneGraph, name: str, **changes: object) -> SceneGraph:
    """The graph with one plane changed."""
    fields = ("id", "normal", "offset", "extent", "virtual", "source", "attributes")
    planes = tuple(
        Plane(**{f: changes.get(f, getattr(p, f)) for f in fields}) if p.id == name else p
        for p in graph.planes
    )
    return graph.replace(planes=planes)


USUAL, RIGID = Definition(), Definition(map_bend=0.0)


def problem(
    online: SceneGraph,
    prior: SceneGraph,
    policy: str = "none",
    constants: Definition = USUAL,
) -> Problem:
    return Problem(online, prior, policy, constants)  # type: ignore[arg-type]


def states(online: SceneGraph, prior: SceneGraph) -> dict[str, str]:
    found = problem(online, prior)
    seen = explained_at(found, HERE)
    return {found.seen[pair.r].planes[p.i]: p.state for pair in seen.pairs for p in pair.planes}


def test_a_room_at_its_place_is_worth_four_fitting_walls() -> None:
    same = problem(grid(1, 1), grid(1, 1))
    assert wall_evidence(same, explained_at(same, HERE)) == pytest.approx(4 * FITS + SEEN)


@pytest.mark.parametrize(
    ("offset", "state"), [(0.149, FIT), (0.151, MOVED), (0.399, MOVED), (0.401, MISSING)]
)
def test_a_wall_fits_is_moved_or_is_missing_by_its_offset(offset: float, state: str) -> None:
    plan = wall(grid(1, 1), "w0-0", offset=offset)
    assert states(grid(1, 1), plan)["w0-0"] == state


def test_each_state_has_its_term() -> None:
    for offset, term in [
        (0.1, FITS - 0.1**2 / (2 * 0.06**2)),
        (0.3, MOVES),
        (3.0, math.log(0.03)),
    ]:
        case = problem(grid(1, 1), wall(grid(1, 1), "w0-0", offset=offset))
        total = wall_evidence(case, explained_at(case, HERE))
        assert total == pytest.approx(3 * FITS + term + SEEN)


def test_a_turned_wall_pays_for_its_angle_and_beyond_the_tolerance_is_missing() -> None:
    for degrees, term in [(4.0, FITS - 2.0), (6.0, math.log(0.03))]:
        angle = math.radians(degrees)
        normal = (math.cos(angle), math.sin(angle), 0.0)
        # Turned about the point of the wall that is nearest to the room's centre.
        plan = wall(grid(1, 1), "w0-0", normal=normal, offset=2 - (2 * normal[0] + 2.5 * normal[1]))
        case = problem(grid(1, 1), plan)
        total = wall_evidence(case, explained_at(case, HERE))
        assert total == pytest.approx(3 * FITS + term + SEEN)


def test_two_missing_walls_are_one_too_many() -> None:
    plan = wall(wall(grid(1, 1), "w0-0", offset=3.0), "s0-0", offset=3.0)
    assert not explained_at(problem(grid(1, 1), plan), HERE).pairs


def test_a_room_needs_two_fitting_walls_that_are_not_parallel() -> None:
    plan = wall(wall(grid(1, 1), "w0-0", offset=0.3), "e0-0", offset=4.3)
    assert not explained_at(problem(grid(1, 1), plan), HERE).pairs


def test_a_shared_wall_counts_once() -> None:
    online = grid(1, 2)
    rooms = [online.rooms[0], online.rooms[1]]
    # One long southern wall bounds both rooms.
    rooms[1] = msgspec.structs.replace(
        rooms[1], planes=tuple("s0-0" if p == "s0-1" else p for p in rooms[1].planes)
    )
    shared = online.replace(rooms=tuple(rooms))
    case = problem(shared, grid(1, 2), constants=RIGID)
    assert wall_evidence(case, explained_at(case, HERE)) == pytest.approx(7 * FITS + 2 * SEEN)


@pytest.mark.parametrize(
    ("one", "two", "spared"),
    [
        (("e0-0", 4.3), ("w0-1", -4.5), TOGETHER),  # the wall between both rooms
        (("e0-0", 4.3), ("w0-1", -3.9), 0.0),  # its faces moved opposite ways
        (("w0-0", 0.3), ("w0-1", -3.9), 0.0),  # two walls
    ],
)
def test_a_wall_moves_as_one(one: tuple[str, float], two: tuple[str, float], spared: float) -> None:
    plan = wall(wall(grid(1, 2), one[0], offset=one[1]), two[0], offset=two[1])
    case = problem(grid(1, 2), plan, constants=RIGID)
    total = wall_evidence(case, explained_at(case, HERE))
    assert total == pytest.approx(6 * FITS + 2 * MOVES + spared + 2 * SEEN)


def test_offsets_err_the_more_the_wider_the_map() -> None:
    # Two rooms, their centres 4.2 m apart: 2.1 m each from the middle.
    bent = math.radians(2) / 50 * 2.1**2
    assert problem(grid(1, 1), grid(1, 1)).sigma == 0.06
    assert problem(grid(1, 2), grid(1, 2)).sigma == math.ceil(1e3 * math.hypot(0.06, bent)) / 1e3
    assert problem(grid(1, 9), grid(1, 9)).sigma == 0.087  # as if spread evenly over what fits
    assert problem(grid(1, 9), grid(1, 9), constants=RIGID).sigma == 0.06


def test_rooms_are_paired_for_number_first_and_score_after() -> None:
    assert pair_up({(0, 0): 5.0, (0, 1): -3.0, (1, 0): -3.0}, 2, 2) == [(0, 1), (1, 0)]
    assert pair_up({(0, 0): 1.0, (0, 1): 2.0, (1, 0): 2.0, (1, 1): 2.0}, 2, 2) == [(0, 1), (1, 0)]
    assert pair_up({(0, 1): 1.0, (0, 0): 1.0}, 1, 2) == [(0, 0)]


def test_the_area_is_that_of_each_storeys_centres_grown_by_five_metres() -> None:
    one = problem(grid(1, 1), grid(2, 2))
    assert plan_area(one) == pytest.approx((4.2 + 10) * (5.2 + 10))


def test_a_tilted_wall_is_cut_at_the_height_of_its_room() -> None:
    lean = math.radians(2)
    normal = (math.cos(lean), 0.0, math.sin(lean))
    online = wall(grid(1, 1), "w0-0", normal=normal, offset=-9.0 * math.sin(lean))
    high = tuple(msgspec.structs.replace(r, center=(2.0, 2.5, 9.0)) for r in online.rooms)
    online = online.replace(rooms=high)
    assert states(online, grid(1, 1))["w0-0"] == FIT


def test_storeys_agree_by_one_shift_for_all() -> None:
    def stacked(heights: tuple[float, ...]) -> SceneGraph:
        graph = grid(1, len(heights))
        rooms = tuple(msgspec.structs.replace(r, storey=f"s{i}") for i, r in enumerate(graph.rooms))
        storeys = tuple(Storey(f"s{i}", None, h) for i, h in enumerate(heights))
        return graph.replace(rooms=rooms, storeys=storeys)

    found = answer(problem(stacked((0.0, 3.0)), stacked((5.0, 8.0))))
    assert {round(c.motion.z, 6) for c in found.candidates} == {5.0}
    assert not answer(problem(stacked((0.0, 3.0)), stacked((5.0, 9.0)))).candidates


def with_objects(graph: SceneGraph, *objects: tuple[str, float, float, str]) -> SceneGraph:
    return graph.replace(
        objects=tuple(
            Object(
                f"o{i}", category, (x, y, 1.0), rooms=("r0-0",), planes=(plane,) if plane else ()
            )
            for i, (category, x, y, plane) in enumerate(objects)
        )
    )


def object_gain(online: SceneGraph, prior: SceneGraph) -> float:
    case = problem(online, prior, "likelihood")
    seen = explained_at(case, HERE)
    return evidence(case, seen) - wall_evidence(case, seen)


def near(distance: float) -> float:
    bell = 0.9 * math.exp(-(distance**2) / (2 * 0.25**2)) / (2 * math.pi * 0.25**2)
    return math.log(20 * (bell + (0.1 / math.pi if distance <= 1 else 0.0)))


def unseen(missed: int, found: int, miss: float = 0.08) -> float:
    def chance(u: float) -> float:
        return (1 - u + u * miss) ** missed * (u * (1 - miss)) ** found

    whole = 0.7 * chance(1.0) + 0.3 * (chance(0.0) + chance(0.5)) / 2
    return math.log(whole) - found * math.log(1 - miss)


def test_an_object_at_its_place_on_its_wall() -> None:
    plan = with_objects(grid(1, 1), ("door", 1.0, 0.0, "s0-0"))
    gain = math.log(0.92) + math.log(0.95) + near(0.0) + unseen(0, 1)
    assert object_gain(plan, plan) == pytest.approx(gain)


def test_an_object_on_another_wall_or_aside() -> None:
    plan = with_objects(grid(1, 1), ("door", 1.0, 0.0, "s0-0"))
    seen = with_objects(grid(1, 1), ("door", 1.4, 0.0, "w0-0"))
    gain = math.log(0.92) + math.log(0.05) + near(0.4) + unseen(0, 1)
    assert object_gain(seen, plan) == pytest.approx(gain)


def test_a_missed_and_a_false_object() -> None:
    two = with_objects(grid(1, 1), ("door", 1.0, 0.0, ""), ("door", 3.0, 0.0, ""))
    one = with_objects(grid(1, 1), ("door", 1.0, 0.0, ""))
    gain = math.log(0.92) + near(0.0) + unseen(1, 1)
    assert object_gain(one, two) == pytest.approx(gain)
    plan = with_objects(grid(1, 1), ("door", 1.0, 0.0, ""))
    seen = with_objects(grid(1, 1), ("door", 3.9, 4.9, ""))
    assert object_gain(seen, plan) == pytest.approx(math.log(0.04) + unseen(1, 0))


def test_a_graph_without_any_object_says_nothing() -> None:
    assert object_gain(grid(1, 1), with_objects(grid(1, 1), ("door", 1.0, 0.0, ""))) == 0.0


def test_a_second_sight_of_one_object() -> None:
    plan = with_objects(grid(1, 1), ("door", 1.0, 0.0, ""))
    seen = with_objects(grid(1, 1), ("door", 1.0, 0.0, ""), ("door", 1.2, 0.0, ""))
    gain = math.log(0.92) + near(0.0) + math.log(0.03) + near(0.2) + unseen(0, 1)
    assert object_gain(seen, plan) == pytest.approx(gain)


def test_a_rare_category_tells_more_and_one_not_modelled_nothing() -> None:
    plan = with_objects(
        grid(1, 1), ("door", 1.0, 0.0, ""), ("door", 3.0, 0.0, ""), ("sink", 2.0, 2.0, "")
    )
    seen = with_objects(grid(1, 1), ("sink", 2.0, 2.0, ""), ("lamp", 1.0, 1.0, ""))
    gain = math.log(0.92 / (1 / 3)) + near(0.0) + unseen(2, 1)
    assert object_gain(seen, plan) == pytest.approx(gain)


def between(rooms: tuple[str, ...], x: float = 4.1) -> SceneGraph:
    """Two rooms with a door in the wall between them, related to these."""
    planes = tuple({"r0-0": "e0-0", "r0-1": "w0-1"}[r] for r in rooms)
    return grid(1, 2).replace(objects=(Object("d", "door", (x, 2.0, 1.0), None, rooms, planes),))


@pytest.mark.parametrize(
    ("seen", "planned", "chance"),
    [
        (("r0-0", "r0-1"), ("r0-0", "r0-1"), 0.95 * 0.9),
        (("r0-1",), ("r0-0", "r0-1"), 0.95 * 0.1),
        (("r0-0", "r0-1"), ("r0-1",), 0.05),
        (("r0-0",), ("r0-0",), 1.0),
    ],
)
def test_a_door_joins_the_rooms_its_counterpart_joins(
    seen: tuple[str, ...], planned: tuple[str, ...], chance: float
) -> None:
    gain = math.log(0.92) + math.log(0.95) + near(0.0) + math.log(chance) + unseen(0, 1)
    assert object_gain(between(seen), between(planned)) == pytest.approx(gain)


def test_a_door_to_a_room_that_is_not_matched_joins_nothing() -> None:
    plan = between(("r0-0", "r0-1"))
    alone = plan.replace(
        rooms=plan.rooms[:1],
        objects=(Object("d", "door", (4.1, 2.0, 1.0), None, ("r0-0",), ("e0-0",)),),
    )
    gain = math.log(0.92) + math.log(0.95) + near(0.0) + unseen(0, 1)
    assert object_gain(alone, plan) == pytest.approx(gain)


def test_two_objects_of_a_wall_that_are_off_alike() -> None:
    plan = with_objects(grid(1, 1), ("door", 1.0, 0.0, "s0-0"), ("door", 3.0, 0.0, "s0-0"))
    seen = with_objects(grid(1, 1), ("door", 1.1, 0.0, "s0-0"), ("door", 3.1, 0.0, "s0-0"))
    alone = 2 * (math.log(0.92) + math.log(0.95) + near(0.1)) + unseen(0, 2)
    # Sum and difference over the root of two are independent, of variance 1.2 and 0.8 sigma^2.
    ratio = math.exp(0.02 / (2 * 0.0625) - 0.02 / (2 * 0.075)) / (1.2 * 0.8)
    bell = 0.9 * math.exp(-0.08) / (2 * math.pi * 0.0625)
    together = math.log(1 + (bell / (bell + 0.1 / math.pi)) ** 2 * (ratio - 1))
    assert together == pytest.approx(0.0656, abs=1e-4)
    assert object_gain(seen, plan) == pytest.approx(alone + together)


def test_objects_of_a_wall_that_are_off_unlike_cost_no_more_than_the_tail() -> None:
    plan = with_objects(grid(1, 1), ("door", 1.0, 0.0, "s0-0"), ("door", 3.0, 0.0, "s0-0"))
    seen = with_objects(grid(1, 1), ("door", 0.4, 0.0, "s0-0"), ("door", 3.6, 0.0, "s0-0"))
    alone = 2 * (math.log(0.92) + math.log(0.95) + near(0.6)) + unseen(0, 2)
    cost = alone - object_gain(seen, plan)
    bell = 0.9 * math.exp(-2.88) / (2 * math.pi * 0.0625)
    assert 0 < cost < -math.log(1 - (bell / (bell + 0.1 / math.pi)) ** 2)


def test_containment_lets_a_room_with_an_object_too_many_go() -> None:
    plan = with_objects(grid(1, 1), ("door", 1.0, 0.0, "s0-0"))
    twice = with_objects(grid(1, 1), ("door", 1.0, 0.0, "s0-0"), ("door", 3.0, 0.0, "s0-0"))
    assert not explained_at(problem(twice, plan, "containment"), HERE).pairs
    assert explained_at(problem(plan, plan, "containment"), HERE).pairs
    elsewhere = with_objects(grid(1, 1), ("door", 0.0, 2.0, "w0-0"))
    # The wall with the door has no counterpart; that one missing wall is forgiven.
    (pair,) = explained_at(problem(elsewhere, plan, "containment"), HERE).pairs
    assert [p.state for p in pair.planes].count(MISSING) == 1


@pytest.mark.parametrize(("rows", "columns", "ties"), [(1, 1, 0), (1, 2, 2), (2, 2, 6)])
def test_rooms_that_stand_wall_to_wall_tie_each_other(rows: int, columns: int, ties: int) -> None:
    assert tied(problem(grid(rows, columns), grid(3, 3))) == ties


def test_rooms_apart_from_each_other_are_not_tied() -> None:
    online = grid(2, 2)
    apart = online.replace(rooms=(online.rooms[0],))
    assert tied(problem(apart, grid(3, 3))) == 0


def test_the_matcher_gives_outside_the_weight_that_the_brute_force_gives_it() -> None:
    for rows, columns in [(1, 2), (2, 2)]:
        online, prior = grid(rows, columns), grid(3, 4)
        own = answer(problem(online, prior))
        told = match(online, PlanIndex(prior), semantics="none")
        assert told.probability_outside == pytest.approx(own.probability_outside, rel=1e-3)


def test_a_room_that_stands_elsewhere_may_be_like_the_plans_all_the_same() -> None:
    plan = grid(1, 4)
    astray = plan.rooms[3]
    seen = plan.replace(
        rooms=(*plan.rooms[:3], msgspec.structs.replace(astray, center=(15.6, 5.5, 1.4))),
        planes=tuple(
            msgspec.structs.replace(p, offset=p.offset - p.normal[0] - 3.0 * p.normal[1])
            if p.id in astray.planes
            else p
            for p in plan.planes
        ),
    )
    own = problem(seen, plan)
    there = explained_at(own, HERE)
    assert len(there.pairs) == 3
    alike = math.log(1 + 0.05 * (10 / 0.3) ** 2)
    expected = 12 * own.terms.fit + 3 * SEEN + math.log(0.1) + alike
    assert evidence(own, there) == pytest.approx(expected)
    assert compare(seen, plan, own).agrees
