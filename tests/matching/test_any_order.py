"""Peaks that only some orders of the planes once led to: the answer is the same in all of them."""

from __future__ import annotations

import itertools
import math

import msgspec
import pytest

from situgraph.matching import PlanIndex, match
from situgraph.scenegraph.graph import Plane, Room, SceneGraph

# A room: its centre, then for each wall the direction of the normal in degrees, and the offset.
Rooms = dict[str, tuple[tuple[float, float], tuple[tuple[float, float], ...]]]

TRAPEZOID: Rooms = {"a": ((1.8, 1.925), ((94.764, 0), (180, 3.6), (-80.538, 3.3537), (0, 0)))}
THREE: Rooms = {
    "a": ((1.65, 1.65), ((90, 0), (180, 3.3), (-90, 3.3), (0, 0))),
    "b": ((5.0, 1.5), ((90, 0), (180, 6.5), (-90, 3.0), (0, -3.5))),
    "c": ((8.35, 1.8), ((100.305, 1.1985), (180, 10.0), (-90, 3.3), (0, -6.7))),
}
TWO: Rooms = {
    "a": ((2.0, 2.0), ((94.289, 0), (180, 4.0), (-85.711, 3.6896), (0, 0))),
    "b": ((6.2, 1.725), ((90, 0), (180, 8.2), (-85.711, 2.9766), (0, -4.2))),
}
CASES: dict[str, tuple[Rooms, Rooms]] = {  # the plan, and what was seen with walls moved
    "one room, two walls moved": (
        TRAPEZOID,
        {"a": ((1.8, 1.925), ((94.764, -0.0411), (180, 3.8143), (-80.538, 3.3922), (0, -0.3321)))},
    ),
    "one room, one wall moved": (
        TRAPEZOID,
        {"a": ((1.8, 1.925), ((94.764, -0.0137), (180, 3.4564), (-80.538, 3.3347), (0, 0.0384)))},
    ),
    "two of three rooms": (
        THREE,
        {
            "a": ((1.65, 1.65), ((90, -0.001), (180, 3.3407), (-90, 3.3805), (0, 0.0373))),
            "c": ((8.35, 1.8), ((100.305, 0.9089), (180, 9.9971), (-90, 3.3427), (0, -6.246))),
        },
    ),
    "one of two rooms": (
        TWO,
        {"b": ((6.2, 1.725), ((90, -0.0691), (180, 8.2264), (-85.711, 2.9759), (0, -4.1686)))},
    ),
}


def graph(rooms: Rooms) -> SceneGraph:
    planes = tuple(
        Plane(f"{name}{k}", (math.cos(math.radians(a)), math.sin(math.radians(a)), 0.0), offset)
        for name, (_, walls) in rooms.items()
        for k, (a, offset) in enumerate(walls)
    )
    made = tuple(
        Room(name, (*center, 1.4), tuple(f"{name}{k}" for k in range(len(walls))))
        for name, (center, walls) in rooms.items()
    )
    return SceneGraph(rooms=made, planes=planes)


def reordered(seen: SceneGraph, order: tuple[int, ...]) -> SceneGraph:
    """The walls of each room in this order, and the rooms the other way round."""
    return seen.replace(
        rooms=tuple(
            msgspec.structs.replace(room, planes=tuple(room.planes[k] for k in order))
            for room in reversed(seen.rooms)
        )
    )


@pytest.mark.parametrize("case", CASES)
def test_any_order_of_the_walls_leads_to_the_same_peaks(case: str) -> None:
    prior, rooms = CASES[case]
    index, seen = PlanIndex(graph(prior)), graph(rooms)
    expected = match(seen, index, semantics="none")
    for order in itertools.permutations(range(4)):
        found = match(reordered(seen, order), index, semantics="none")
        assert (found.verdict, found.count) == (expected.verdict, expected.count)
        assert found.candidates == expected.candidates
        one, two = ([s.probability for s in r.solutions] for r in (found, expected))
        assert one == pytest.approx(two, abs=1e-4)
