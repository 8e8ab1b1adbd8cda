"""What must not matter: how things are listed, how the building's frame is turned."""

from __future__ import annotations

import math
from itertools import permutations

import msgspec
import numpy as np
import pytest

from situgraph import Matcher, SceneGraph, match
from situgraph.geometry.poses import Placement
from situgraph.matching.area import area_of
from situgraph.matching.index import PlanIndex
from situgraph.plan.layouts import make_layout
from situgraph.plan.sampler import sample_online
from situgraph.scenegraph.graph import Object, Plane, Room
from situgraph.scenegraph.transform import transformed


def box(name: str, west: float, south: float, east: float, north: float) -> SceneGraph:
    """A rectangular room, its planes named west, east, south, north."""
    sides = {
        "west": ((1.0, 0.0, 0.0), -west),
        "east": ((-1.0, 0.0, 0.0), east),
        "south": ((0.0, 1.0, 0.0), -south),
        "north": ((0.0, -1.0, 0.0), north),
    }
    planes = tuple(Plane(f"{name}.{side}", *face) for side, face in sides.items())
    middle = ((west + east) / 2, (south + north) / 2, 1.4)
    return SceneGraph(rooms=(Room(name, middle, tuple(p.id for p in planes)),), planes=planes)


def together(*parts: SceneGraph, objects: tuple[Object, ...] = ()) -> SceneGraph:
    rooms = tuple(r for part in parts for r in part.rooms)
    return SceneGraph(
        rooms=rooms, planes=tuple(p for part in parts for p in part.planes), objects=objects
    )


def seen(graph: SceneGraph, *names: str, long_walls_of: tuple[str, ...] = ()) -> SceneGraph:
    """Some rooms of a plan, and of corridors only the long walls."""
    rooms = [graph.room_by_id[name] for name in names]
    kept = {
        room.id: tuple(
            p for p in room.planes
            if room.id not in long_walls_of or p.endswith(("south", "north"))
        )
        for room in rooms
    }  # fmt: skip
    held = {p for planes in kept.values() for p in planes}
    return graph.replace(
        rooms=tuple(msgspec.structs.replace(r, planes=kept[r.id]) for r in rooms),
        planes=tuple(p for p in graph.planes if p.id in held),
        objects=tuple(o for o in graph.objects if set(o.rooms) & set(names)),
    )


def two_sections(order: str) -> SceneGraph:
    """Two sections of a corridor in one line, and walls that half a turn leaves as they are.

    What hangs on the walls it does not leave: extinguishers are 0.6 m off.
    """
    rooms = {
        "A": box("A", 0, 4.2, 5, 8.2),
        "B": box("B", 15, -2.2, 20, 1.8),
        "C": box("C", 0, 2, 9.9, 4),
        "D": box("D", 10.1, 2, 20, 4),
    }
    hung = [
        Object(f"d{x}", "extinguisher", (x, 2.0, 1.0), rooms=("D",)) for x in (12.0, 15.0, 18.0)
    ]
    hung += [Object(f"c{x}", "extinguisher", (x, 4.0, 1.0), rooms=("C",)) for x in (7.4, 4.4, 1.4)]
    return together(*(rooms[name] for name in order), objects=tuple(hung))


@pytest.mark.parametrize("order", ["ABCD", "ABDC", "DCBA"])
def test_a_corridor_is_the_section_it_was_seen_in(order: str) -> None:
    plan = two_sections(order)
    result = match(seen(plan, "B", "D", long_walls_of=("D",)), plan)
    assert result.best is not None
    assert result.best.rooms == {"B": "B", "D": "D"}
    assert abs(result.best.transform.yaw) < 0.01
    assert len(result.best.objects) == 3


def test_both_sections_are_told_from_each_other_in_any_order() -> None:
    plan = two_sections("ABCD")
    for order in permutations("ACD"):
        online = seen(plan, *order, long_walls_of=("C", "D"))
        result = match(online, plan)
        assert result.best is not None
        assert result.best.rooms == {name: name for name in order}


@pytest.mark.parametrize("seed", range(6))
def test_the_order_of_rooms_does_not_matter(seed: int) -> None:
    plan = make_layout("corridor", 12, seed)
    online = sample_online(plan, 4, seed).online
    told = [
        match(online.replace(rooms=online.rooms[::way]), plan.replace(rooms=plan.rooms[::way]))
        for way in (1, -1)
    ]
    assert told[0].verdict == told[1].verdict
    assert told[0].probability_outside == pytest.approx(told[1].probability_outside, rel=1e-6)
    assert [dict(sorted(s.rooms.items())) for s in told[0].solutions[:1]] == [
        dict(sorted(s.rooms.items())) for s in told[1].solutions[:1]
    ]


@pytest.mark.parametrize("yaw", [0.2, 0.785, 2.0])
def test_a_plan_is_as_large_however_its_frame_is_turned(yaw: float) -> None:
    plan = make_layout("random", 14, 3)
    turned = transformed(plan, Placement(400.0, -70.0, 0.0, yaw))
    one, other = PlanIndex(plan), PlanIndex(turned)
    assert other.area == pytest.approx(one.area, rel=1e-9)
    online = sample_online(plan, 3, 3).online
    assert match(online, other).probability_outside == pytest.approx(
        match(online, one).probability_outside, rel=1e-6
    )


def test_the_area_is_that_of_the_smallest_rectangle() -> None:
    rng = np.random.default_rng(0)
    for count in (1, 2, 3, 40):
        points = rng.uniform(0, 30, (count, 2))
        least = math.inf
        for angle in np.linspace(0, np.pi / 2, 9001):
            c, s = math.cos(angle), math.sin(angle)
            sides = np.ptp(points @ np.array([[c, -s], [s, c]]), axis=0) + 2 * 5.0
            least = min(least, float(np.prod(sides)))
        assert area_of(points, np.zeros(count), 5.0) == pytest.approx(least, rel=1e-3)
    row = np.array([[0.0, 0.0], [3.0, 4.0], [6.0, 8.0]])
    assert area_of(row, np.zeros(3), 5.0) == pytest.approx(20.0 * 10.0)
    assert area_of(row, np.array([0.0, 3.0, 3.0]), 5.0) == pytest.approx(10.0**2 + 15.0 * 10.0)


def test_an_update_sees_that_other_categories_can_be_found() -> None:
    plan = make_layout("random", 10, 1)
    online = sample_online(plan, 3, 1).online
    matcher = Matcher(plan)
    for able in (("window",), ("window", "door"), None, ("window",)):
        now = online.replace(modelled_categories=able)
        assert matcher.update(now).probability_outside == match(now, plan).probability_outside
