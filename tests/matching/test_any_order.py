"""Peaks that only some orders of the planes once led to: the answer is the same in all of them."""

from __future__ import annotations

import itertools

import pytest
from tests.matching.faces import Rooms, graph, reordered

from situgraph.matching import PlanIndex, match

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
