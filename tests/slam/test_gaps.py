"""Openings in walls, and open door leaves, which are no walls."""

from __future__ import annotations

import numpy as np

from situgraph.slam.config import RoomConfig
from situgraph.slam.gaps import doorways, without_leaves
from situgraph.slam.planemap import Interval, MapPlane

CONFIG = RoomConfig()


def facing_left(number: int, x: float, *stretches: Interval) -> MapPlane:
    """A plane x = ``x`` with its normal towards -x, seen between these y."""
    spans = [(-b, -a) for a, b in stretches]
    return MapPlane(number, 0, np.array([-1.0, 0.0, 0.0, x]), intervals=sorted(spans))


def facing_right(number: int, x: float, *stretches: Interval) -> MapPlane:
    return MapPlane(number, 0, np.array([1.0, 0.0, 0.0, -x]), intervals=sorted(stretches))


def facing(number: int, normal: tuple[float, float], a: tuple[float, float], b) -> MapPlane:
    """A plane between two points of the plan."""
    n = np.array([*normal, 0.0])
    made = MapPlane(number, 0, np.array([*n, -n[:2] @ np.array(a)]))
    made.intervals = [tuple(sorted(float(np.array(p) @ made.tangent) for p in (a, b)))]
    return made


def spans(planes: list[MapPlane]) -> dict[int, list[float]]:
    return {p.number: sorted(round(float(v), 6) for a, b in p.intervals
                             for v in (p.point(a)[1], p.point(b)[1])) for p in planes}  # fmt: skip


def test_a_leaf_is_short_and_thin() -> None:
    front, back = facing_left(0, 2.0, (0.0, 0.9)), facing_right(1, 2.04, (0.0, 0.8))
    wall = facing_right(2, 0.0, (0.0, 4.0))
    assert spans(without_leaves([front, back, wall], CONFIG)) == {2: [0.0, 4.0]}
    thick = facing_right(1, 2.2, (0.0, 0.8))
    assert len(without_leaves([front, thick, wall], CONFIG)) == 3


def test_leaves_of_two_doors_in_one_line_are_leaves() -> None:
    """Across a corridor, one with the jamb that it hangs on; of the other only the jamb is left."""
    both = facing_left(0, 2.0, (0.0, 1.32), (2.4, 2.9))
    back = facing_right(1, 2.04, (0.3, 1.28))
    assert spans(without_leaves([both, back], CONFIG)) == {0: [2.4, 2.9]}


def test_a_leaf_that_was_taken_into_the_line_of_a_wall_is_a_leaf() -> None:
    """Its back, seen by itself, lies before that line: no wall has its back before its front."""
    wall = facing_left(0, 2.0, (0.0, 4.3), (5.3, 6.5))
    back = facing_right(1, 1.94, (5.4, 6.4))
    assert spans(without_leaves([wall, back], CONFIG)) == {0: [0.0, 4.3]}


def test_piers_between_doors_in_a_thin_wall_stay() -> None:
    front = facing_left(0, 2.0, (0.0, 1.2), (2.1, 3.3), (4.2, 5.4))
    back = facing_right(1, 2.06, (0.0, 1.2), (2.1, 3.3), (4.2, 5.4))
    assert len(spans(without_leaves([front, back], CONFIG))[0]) == 6


def test_a_door_as_wide_as_its_corridor_is_a_door_where_a_leaf_hangs() -> None:
    """The end of a corridor behind x = 2: nothing but an open leaf tells it from an alcove."""
    hall = facing_right(0, 2.0, (-4.0, 0.0), (2.0, 6.0))
    sides = [facing(1, (0.0, 1.0), (-3.0, 0.0), (1.8, 0.0)),
             facing(2, (0.0, -1.0), (-3.0, 2.0), (1.8, 2.0))]  # fmt: skip
    walls = [hall, *sides]
    assert not [g for g in doorways(walls, CONFIG, walls) if g.plane == 0]
    leaf = facing(3, (0.0, 1.0), (1.9, 0.4), (2.9, 0.3))
    (gap,) = [g for g in doorways(walls, CONFIG, [*walls, leaf]) if g.plane == 0]
    assert sorted(gap.ends[:, 1].tolist()) == [0.0, 2.0]
