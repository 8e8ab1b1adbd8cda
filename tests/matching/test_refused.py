"""What a program may hand over and a file could not hold, and answers cut to a few solutions."""

from __future__ import annotations

import math
from collections.abc import Callable

import msgspec
import numpy as np
import pytest

from situgraph import Matcher, PlanIndex, SceneGraph, load, match, save
from situgraph.errors import InputError
from situgraph.matching import MatchingConfig
from situgraph.matching.explanation import explain_pair
from situgraph.plan.layouts import make_layout
from situgraph.scenegraph.graph import Plane, Room

PLAN = make_layout("random", 6, 0)


def not_finite(graph: SceneGraph) -> SceneGraph:
    bad = msgspec.structs.replace(graph.planes[2], offset=math.nan)
    return graph.replace(planes=(*graph.planes[:2], bad, *graph.planes[3:]))


def no_place(graph: SceneGraph) -> SceneGraph:
    bad = msgspec.structs.replace(graph.rooms[0], center=(0.0, math.inf, 0.0))
    return graph.replace(rooms=(bad, *graph.rooms[1:]))


def plane_twice(graph: SceneGraph) -> SceneGraph:
    return graph.replace(planes=(*graph.planes, graph.planes[0]))


def room_twice(graph: SceneGraph) -> SceneGraph:
    return graph.replace(rooms=(*graph.rooms, graph.rooms[0]))


@pytest.mark.parametrize("spoil", [not_finite, no_place, plane_twice, room_twice])
def test_a_graph_that_is_none_is_refused(spoil: Callable[[SceneGraph], SceneGraph]) -> None:
    with pytest.raises(InputError, match=r"not finite|there twice"):
        match(spoil(PLAN), PLAN)
    with pytest.raises(InputError, match=r"not finite|there twice"):
        PlanIndex(spoil(PLAN))


@pytest.mark.parametrize("policy", ["Likelihood", "", "geometric"])
def test_a_policy_that_does_not_exist_is_refused(policy: str) -> None:
    with pytest.raises(InputError, match="none, containment, likelihood"):
        match(PLAN, PLAN, semantics=policy)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="none, containment, likelihood"):
        Matcher(PLAN, semantics=policy)  # type: ignore[arg-type]


def test_numbers_of_numpy_are_saved(tmp_path) -> None:  # type: ignore[no-untyped-def]
    planes = tuple(
        msgspec.structs.replace(p, normal=tuple(np.array(p.normal)), offset=np.float64(p.offset))
        for p in PLAN.planes
    )
    save(PLAN.replace(planes=planes), tmp_path / "plan.json")
    assert load(tmp_path / "plan.json").planes == PLAN.planes


def grid(columns: int, rows: int) -> SceneGraph:
    """Equal rooms, 4 m by 4 m."""
    listed, planes = [], []
    for x in range(columns):
        for y in range(rows):
            name, west, south = f"{x}-{y}", 4.2 * x, 4.2 * y
            faces = ((1.0, 0.0, -west), (-1.0, 0.0, west + 4), (0.0, 1.0, -south))
            faces += ((0.0, -1.0, south + 4),)  # type: ignore[assignment]
            ids = tuple(f"{name}.{k}" for k in range(4))
            planes += [Plane(i, (a, b, 0.0), d) for i, (a, b, d) in zip(ids, faces)]
            listed.append(Room(name, (west + 2, south + 2, 1.3), ids))
    return SceneGraph(rooms=tuple(listed), planes=tuple(planes))


@pytest.mark.parametrize("most", [1, 3])
def test_a_list_that_is_cut_is_still_told_of(most: int) -> None:
    plan = grid(4, 4)
    online = plan.replace(rooms=plan.rooms[:2])
    whole = match(online, plan)
    cut = match(online, plan, config=MatchingConfig(max_solutions=most))
    told = cut.to_dict()
    assert told["truncated"]
    assert (told["count"], len(told["solutions"])) == (whole.count, most)
    assert told["reason"] == whole.reason
    for room in plan.rooms:
        assert explain_pair(cut, "0-0", room.id) == explain_pair(whole, "0-0", room.id)


def test_parallel_walls_alone_place_nothing_and_it_is_said() -> None:
    plan = grid(2, 1)
    corridors = plan.replace(
        rooms=tuple(msgspec.structs.replace(r, planes=r.planes[:2]) for r in plan.rooms)
    )
    result = match(corridors, plan)
    assert result.verdict == "none"
    assert "unconstrained" in result.reason


def test_no_object_is_advised_where_objects_are_no_evidence() -> None:
    plan = make_layout("grid", 9, 0)
    online = plan.replace(rooms=plan.rooms[:1])
    assert {a.kind for a in match(online, plan, semantics="none").advice} <= {"wall", "room"}
