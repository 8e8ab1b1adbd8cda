"""Rooms whose walls are neither parallel nor at right angles: the yaw meets its limits there."""

from __future__ import annotations

import itertools

import pytest
from tests.matching.faces import Rooms, graph, reordered

from situgraph.matching import MatchingConfig, PlanIndex, match

CONFIG = MatchingConfig(max_boxes=5_000, max_work=3_000_000)
PLAN: Rooms = {
    "one": ((1.8, 1.575), ((90.0, 0.0), (180.0, 3.6), (-85.236, 2.9896), (0.0, 0.0))),
    "two": ((5.45, 1.875), ((100.305, 0.6798), (180.0, 7.1), (-84.806, 2.9424), (0.0, -3.8))),
}
SEEN: Rooms = {  # the first wall moved
    "two": (
        (5.45, 1.875),
        ((100.305, 0.48167), (180.0, 7.12261), (-84.806, 2.89441), (0.0, -3.7801)),
    ),
}


@pytest.mark.parametrize("order", list(itertools.permutations(range(4))))
def test_a_moved_wall_is_searched_to_the_end_in_any_order_of_the_planes(
    order: tuple[int, ...],
) -> None:
    index = PlanIndex(graph(PLAN), CONFIG)
    result = match(reordered(graph(SEEN), order), index, semantics="none")
    assert result.complete
    assert result.candidates == 7
