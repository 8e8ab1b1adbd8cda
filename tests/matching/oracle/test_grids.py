"""The brute force against what can be counted by hand: identical patterns in identical grids."""

from __future__ import annotations

import pytest

from situgraph.experiments.oracle.definition import Definition
from situgraph.experiments.oracle.grids import grid, placements
from situgraph.experiments.oracle.problem import Problem
from situgraph.experiments.oracle.verdict import answer
from situgraph.geometry.poses import Placement
from situgraph.scenegraph.transform import transformed

ALL = Definition(rival_ratio=0.0)


def test_the_count_is_the_textbook_one_when_the_pattern_must_lie_inside() -> None:
    for (h, w), (n, m) in [((1, 1), (2, 3)), ((1, 3), (3, 5)), ((2, 2), (4, 3))]:
        assert placements((h, w), (n, m), False, ALL) == 2 * (n - h + 1) * (m - w + 1)
    # 12 rooms need 9: one column may lie outside.
    assert placements((3, 4), (3, 4), False, ALL) == 2 * 3


@pytest.mark.parametrize(
    ("pattern", "plan", "square"),
    [
        ((1, 1), (1, 1), False),
        ((1, 1), (2, 2), True),
        ((1, 2), (2, 3), False),
        ((1, 3), (3, 3), True),
        ((2, 2), (3, 3), False),
        ((1, 4), (2, 5), False),
        ((2, 3), (2, 3), False),
        ((1, 7), (1, 8), False),
    ],
)
def test_the_brute_force_finds_every_placement_on_a_grid_once(
    pattern: tuple[int, int], plan: tuple[int, int], square: bool
) -> None:
    width = 5.0 if square else 4.0
    online = transformed(grid(*pattern, width), Placement(3.0, -7.0, 0.0, 0.7))
    found = answer(Problem(online, grid(*plan, width), "none", ALL))
    assert len(found.candidates) == placements(pattern, plan, square, ALL)
    # Those that lie wholly inside are equally likely; those that hang over the edge explain less.
    inside = placements(pattern, plan, square, Definition(min_share=1.0))
    best = found.candidates[0].evidence
    assert sum(abs(c.evidence - best) < 1e-6 for c in found.candidates) == inside
