"""Which wall was moved: one answer, or several that are told."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.coupling.plans import MAP, PRIOR, all_pairs, seen

from situgraph.coupling.config import CouplingConfig
from situgraph.coupling.lines import WallLines
from situgraph.coupling.located import locate
from situgraph.coupling.readings import Reading, doubt, readings, spread
from situgraph.coupling.state import Locator
from situgraph.geometry.poses import Placement
from situgraph.matching import Matcher, PlanIndex
from situgraph.scenegraph.graph import SceneGraph

CONFIG = CouplingConfig()
LINES = WallLines(PRIOR)
FIRST = PRIOR.rooms[0]


def part(graph: SceneGraph, *rooms: str, objects: bool = False) -> SceneGraph:
    """Only these rooms, their faces, and their objects if wanted."""
    kept = tuple(r for r in graph.rooms if r.id in rooms)
    names = {p for r in kept for p in r.planes}
    return graph.replace(
        rooms=kept,
        planes=tuple(p for p in graph.planes if p.id in names),
        objects=tuple(o for o in graph.objects if objects and set(o.rooms) & set(rooms)),
    )


def read(online: SceneGraph, placement: Placement = MAP) -> tuple[Reading, ...]:
    storeys = {s.id: s.id for s in online.storeys}
    return readings(online, PRIOR, placement, storeys, LINES, CONFIG)


def off(reading: Reading) -> float:
    middle = MAP.inverse().points(FIRST.center)
    return float(np.linalg.norm((reading.placement.points(middle) - MAP.points(middle))[:2]))


def test_a_building_as_planned_has_one_reading() -> None:
    for rooms in (["r1"], ["r1", "r2"], [r.id for r in PRIOR.rooms]):
        (only,) = read(part(seen(PRIOR, noise=0.02), *rooms))
        assert off(only) < 0.05
        assert only.moved == ()


@pytest.mark.parametrize("by", [0.2, 0.3, 0.4])
def test_one_wide_room_does_not_say_which_wall_was_moved(by: float) -> None:
    online = part(seen(PRIOR, {FIRST.planes[1]: -by}, noise=0.005), FIRST.id)
    found = read(online)
    assert len(found) == 2
    assert spread(found) == pytest.approx(by, abs=0.03)
    assert min(off(r) for r in found) < 0.02
    said = doubt(found, PRIOR)
    assert "2 readings" in said
    assert str(FIRST.name) in said


def test_objects_say_which_wall_was_moved() -> None:
    """Doors and windows of the walls that did not move stand where they were planned."""
    online = part(seen(PRIOR, {FIRST.planes[1]: -0.4}, noise=0.005), FIRST.id, objects=True)
    plain = part(online, FIRST.id)
    with_objects, without = read(online), read(plain)
    assert off(with_objects[0]) < 0.05
    assert len(without) == 2
    odds = [found[1].cost - found[0].cost for found in (with_objects, without) if len(found) > 1]
    assert len(odds) == 1 or odds[0] > odds[1] + 0.5


@pytest.mark.parametrize("start", [-0.3, 0.0, 0.3])
def test_a_wall_that_passes_many_rooms_is_outvoted_by_two(start: float) -> None:
    """All faces in one line with one wall moved alike; more faces than the walls across from it."""
    wall = LINES.of("p1")
    lines = {p for p in LINES.names if LINES.of(p) == wall}
    x = PRIOR.plane_by_id["p1"].normal[0]
    moved = {p: 0.3 * x * PRIOR.plane_by_id[p].normal[0] for p in sorted(lines)}
    online = seen(PRIOR, moved, noise=0.005).replace(objects=())
    move = MAP.inverse().vectors([start * x, 0.0, 0.0])
    rough = MAP.compose(Placement(*move.tolist(), 0.0))
    assert off(read(online, rough)[0]) < 0.03
    found = locate(online, PRIOR, all_pairs(online, rough), config=CONFIG)
    middle = MAP.inverse().points(FIRST.center)
    away = found.placement.points(middle) - MAP.points(middle)
    assert float(np.hypot(away[0], away[1])) < 0.03
    told = {d.prior for d in found.deviations if d.kind == "moved-wall"}
    assert told == lines


@settings(max_examples=25, deadline=None)
@given(
    x=st.floats(-50, 50), y=st.floats(-50, 50), yaw=st.floats(-math.pi, math.pi),
    seed=st.integers(0, 99),
)  # fmt: skip
def test_the_map_frame_does_not_matter(x: float, y: float, yaw: float, seed: int) -> None:
    frame = Placement(x, y, 0.5, yaw)
    shape = {FIRST.planes[1]: -0.3}
    one = read(part(seen(PRIOR, shape, 0.005, seed), FIRST.id))
    other = read(part(seen(PRIOR, shape, 0.005, seed, frame), FIRST.id), frame)
    assert [r.cost for r in other] == pytest.approx([r.cost for r in one], abs=1e-5)
    assert sorted(r.shift for r in other) == [
        pytest.approx(r, abs=1e-5) for r in sorted(r.shift for r in one)
    ]


def test_a_map_that_is_nowhere_has_the_reading_of_the_match() -> None:
    far = Placement(500.0, 0.0, 0.0, 0.0)
    assert [r.placement for r in read(seen(PRIOR), far)] == [far]
    assert len(read(SceneGraph(kind="online"))) == 1


def test_two_readings_are_doubted_and_told() -> None:
    online = seen(PRIOR, {FIRST.planes[1]: -0.3}, noise=0.005)
    locator = Locator(Matcher(PlanIndex(PRIOR)), PRIOR)
    locator.update(part(online, FIRST.id, objects=True), 1.0)
    locator.readings = read(part(online, FIRST.id))
    assert [e.happening for e in locator.events][:1] == ["located"]
    located = locate(part(online, FIRST.id), PRIOR, locator.pairs, found=locator.readings)
    assert len(located.to_dict()["readings"]) == 2


def test_faces_between_which_none_was_seen_are_one_wall() -> None:
    """Faces of a wall seen from two rooms, connected by those that the plan has between."""
    for name in LINES.names:
        for other in LINES.names:
            assert (LINES.of(name) == LINES.of(other)) == (other in _reached(name))


def _reached(start: str) -> set[str]:
    """By a plain search over pairs of faces, each pair looked at by its own geometry."""
    found, waiting = {start}, [start]
    while waiting:
        one = PRIOR.plane_by_id[waiting.pop()]
        for other in PRIOR.planes:
            if other.id not in found and _one_wall(one.id, other.id):
                found.add(other.id)
                waiting.append(other.id)
    return found


def _one_wall(a: str, b: str) -> bool:
    one, other = PRIOR.plane_by_id[a], PRIOR.plane_by_id[b]
    cosine = sum(x * y for x, y in zip(one.normal, other.normal))
    axis = 0 if abs(one.normal[0]) > 0.5 else 1
    (p, q), (r, s) = one.extent, other.extent
    first, second = sorted((p[1 - axis], q[1 - axis])), sorted((r[1 - axis], s[1 - axis]))
    common = min(first[1], second[1]) - max(first[0], second[0])
    before = (r[axis] - p[axis]) * one.normal[axis]
    if cosine > 0.9:
        return abs(before) < 0.03 and common > -1.0
    return cosine < -0.9 and -0.6 < before < 0.0 and common > 0.2
