from __future__ import annotations

from dataclasses import replace

import msgspec
import numpy as np
import pytest
from tests.objects.world import two_rooms

from situgraph.objects.config import ObjectsConfig
from situgraph.objects.gaps import WallGap
from situgraph.objects.openings import Seen, openings
from situgraph.objects.relations import room_views
from situgraph.scenegraph.graph import Object

CONFIG = ObjectsConfig()
VIEWS = room_views(two_rooms(), CONFIG)
JAMBS = ((1.5, 1.7), (2.3, 2.5))


def panel(x: float, low: float, high: float, bottom: float = 0.0, top: float = 2.1) -> np.ndarray:
    y, z = np.meshgrid(np.arange(low, high, 0.05), np.arange(bottom, top, 0.05))
    return np.stack([np.full(y.size, x), y.ravel(), z.ravel()], axis=1)


def thing(number: int, points: np.ndarray, category: str = "door", seen: int = 4) -> Seen:
    return Seen(number, category, points, np.full(len(points), float(seen)), seen, seen, 0.9 * seen)


def given(things: list[Seen]) -> list[Object]:
    return openings(things, VIEWS, CONFIG).given


def test_both_sides_of_a_wall_are_one_door() -> None:
    (door,) = given([thing(0, panel(4.0, 1.5, 2.4)), thing(3, panel(4.2, 1.6, 2.4))])
    assert door.id == "o0"
    assert np.allclose(door.center, (4.0, 1.95, 1.05), atol=0.08)
    assert door.attributes["seen"] == 8


def test_an_open_leaf_does_not_move_the_door() -> None:
    leaf = np.stack([np.linspace(3.1, 3.95, 60), np.full(60, 1.5), np.linspace(0, 2, 60)], axis=1)
    (door,) = given([thing(0, np.concatenate([panel(4.0, 1.5, 2.4), leaf]))])
    assert np.allclose(door.center, (4.0, 1.95, 1.05), atol=0.06)


def test_a_window_seen_in_part_does_not_narrow_it() -> None:
    whole = thing(0, panel(0.0, 1.0, 2.6, 0.9, 2.2), "window", 5)
    part = thing(1, panel(0.0, 2.0, 2.5, 1.2, 2.2), "window", 2)
    (window,) = given([part, whole])
    assert np.allclose(window.center, (0.0, 1.8, 1.55), atol=0.08)


def test_neighbours_that_one_frame_ran_together_stay_two() -> None:
    a, b, between = (panel(0.0, *v, 0.9, 2.2) for v in ((0.5, 1.7), (2.1, 3.3), (1.7, 2.1)))
    hits = np.concatenate([np.full(len(a) + len(b), 10.0), np.ones(len(between))])
    both = Seen(7, "window", np.concatenate([a, b, between]), hits, 10, 10, 9.0)
    found = given([both])
    assert [o.id for o in found] == ["o7", "o7.2"]
    assert np.allclose(sorted(o.center[1] for o in found), (1.1, 2.7), atol=0.06)


def test_a_part_that_few_frames_saw_does_not_share_in_the_sightings_of_the_rest() -> None:
    door, wall = panel(4.0, 0.6, 1.5), panel(4.0, 2.0, 3.1)
    hits = np.concatenate([np.full(len(door), 20.0), np.full(len(wall), 6.0)])
    found = openings(
        [Seen(7, "door", np.concatenate([door, wall]), hits, 20, 20, 16.0)], VIEWS, CONFIG
    )
    assert [o.attributes["seen"] for o in found.given] == [20]
    assert [o.attributes["seen"] for o in found.weak] == [6]


def test_of_a_door_and_a_window_in_one_place_the_more_often_seen_stands() -> None:
    door, window = thing(0, panel(4.0, 1.5, 2.4)), thing(1, panel(4.0, 1.5, 2.4), "window", 9)
    (found,) = given([door, window])
    assert found.category == "window"


def test_what_lies_in_no_wall_has_no_place() -> None:
    found = openings([thing(5, panel(2.0, 1.5, 2.4))], VIEWS, CONFIG)
    assert (found.given, found.weak, found.homeless) == ([], [], [5])


def test_a_jamb_alone_is_the_gap_that_it_bounds() -> None:
    jamb = thing(0, panel(4.0, 1.4, 1.8))
    beside, far = (WallGap(np.array([[4.0, a], [4.0, b]]), 0.0) for a, b in ((1.6, 3.0), (3.0, 4)))
    without = openings([jamb], VIEWS, CONFIG, [far])
    assert (without.given, [o.id for o in without.weak]) == ([], ["o0"])
    (door,) = openings([jamb], VIEWS, CONFIG, [far, beside]).given
    assert np.allclose(door.center, (4.0, 2.2, 1.05), atol=0.06)


def test_both_jambs_of_a_wide_door_are_one_door() -> None:
    jambs = [thing(0, panel(4.0, 1.2, 1.6)), thing(1, panel(4.0, 2.9, 3.3))]
    gap = WallGap(np.array([[4.0, 1.5], [4.0, 3.0]]), 0.0)
    (door,) = openings(jambs, VIEWS, CONFIG, [gap]).given
    assert np.allclose(door.center, (4.0, 2.25, 1.05), atol=0.1)


def test_a_door_has_some_wall_beside_it() -> None:
    leaf = msgspec.structs.replace(two_rooms().planes[1], extent=((4.0, 1.5), (4.0, 2.5)))
    graph = two_rooms()
    views = room_views(graph.replace(planes=(graph.planes[0], leaf, *graph.planes[2:])), CONFIG)
    found = openings([thing(0, panel(4.0, 1.5, 2.45))], views, CONFIG)
    assert (found.given, [o.id for o in found.weak]) == ([], ["o0"])


@pytest.mark.parametrize(
    ("category", "bottom", "top"), [("door", 0.0, 2.8), ("door", 0.0, 0.7), ("window", 0.1, 0.9)]
)
def test_what_is_too_high_or_too_low_is_no_opening(category: str, bottom: float, top: float):
    assert given([thing(0, panel(0.0, 1.5, 2.4, bottom, top), category)]) == []


def test_an_unsure_door_is_one_where_there_is_a_gap() -> None:
    unsure = replace(thing(0, panel(4.0, 1.5, 2.4)), score=0.5 * 4)
    gap, beside = (WallGap(np.array([[4.1, a], [4.1, b]]), 0.0) for a, b in ((1.5, 2.4), (2.3, 3)))
    assert CONFIG.door_confidence > 0.4
    assert openings([unsure], VIEWS, CONFIG, [beside]).given == []
    assert len(openings([unsure], VIEWS, CONFIG, [gap]).given) == 1
    window = replace(unsure, category="window")
    assert len(openings([window], VIEWS, CONFIG).given) == 1


def test_slivers_are_no_openings() -> None:
    found = given([thing(0, panel(4.0, 1.5, 1.7))])
    assert found == []


def test_a_door_begins_near_the_floor() -> None:
    found = given([thing(0, panel(4.0, 1.5, 2.4, 1.3, 2.1))])
    assert found == []


def test_what_was_seen_once_is_weak() -> None:
    found = openings([thing(0, panel(4.0, 1.5, 2.4), seen=1)], VIEWS, CONFIG)
    assert (found.given, [o.id for o in found.weak]) == ([], ["o0"])


def test_an_open_door_is_two_jambs_and_a_lintel() -> None:
    parts = [panel(4.0, 1.5, 1.6), panel(4.0, 2.3, 2.4), panel(4.0, 1.6, 2.3, 2.0, 2.1)]
    hits = np.concatenate([np.full(len(p), n) for p, n in zip(parts, (30.0, 3.0, 3.0))])
    (door,) = given([Seen(0, "door", np.concatenate(parts), hits, 30, 30, 27.0)])
    assert np.allclose(door.center, (4.0, 1.95, 1.05), atol=0.08)


def test_two_doors_that_ran_together_are_parted() -> None:
    a, b, between = (panel(0.0, *v) for v in ((0.5, 1.4), (2.6, 3.5), (1.4, 2.6)))
    hits = np.concatenate([np.full(len(a) + len(b), 20.0), np.full(len(between), 2.0)])
    found = given([Seen(0, "door", np.concatenate([a, b, between]), hits, 20, 20, 18.0)])
    assert np.allclose(sorted(o.center[1] for o in found), (0.95, 3.05), atol=0.06)


def test_two_pieces_of_one_frame_are_one_sighting() -> None:
    jambs = [replace(thing(k, panel(4.0, *y), seen=1), frames=(7,)) for k, y in enumerate(JAMBS)]
    found = openings(jambs, VIEWS, CONFIG)
    assert found.given == []
    assert [o.attributes["seen"] for o in found.weak] == [1]
    later = replace(jambs[1], frames=(8,))
    (door,) = openings([jambs[0], later], VIEWS, CONFIG).given
    assert door.attributes["seen"] == 2


def test_what_one_frame_alone_showed_does_not_widen_a_door() -> None:
    door = thing(0, panel(4.0, 1.5, 2.1), seen=8)
    speck = panel(4.0, 2.55, 2.65)
    once, often = (
        given([door, thing(1, speck, seen=seen)])[0].ellipsoid.axes[0] for seen in (1, 3)
    )
    assert once < 0.4 < 0.5 < often


def test_the_jamb_of_a_door_at_the_corner_is_of_that_door() -> None:
    """The wall y = 0 of room a has a door up to 0.1 m before its corner with the wall x = 4."""
    views = room_views(two_rooms(footprint=True), CONFIG)
    jamb = np.array([(x, y, z) for x in (3.86, 3.9, 3.95) for y in (-0.35, -0.2, -0.1)
                     for z in np.arange(0.0, 2.1, 0.05)])  # fmt: skip
    beside = panel(4.0, 0.0, 0.35)
    door = panel(0.0, 3.0, 3.9)[:, [1, 0, 2]]
    things = [thing(0, door), thing(1, np.concatenate([jamb, beside]), seen=8)]
    found = openings(things, views, CONFIG)
    assert [o.id for o in found.given] == ["o0"]
    assert np.allclose(found.given[0].center, (3.45, 0.0, 1.0), atol=0.1)


def test_frames_that_should_have_shown_one_piece_or_the_other_count_together() -> None:
    """Patches of a wall that were named door now and then, when the robot was in either room."""
    one, two = (
        replace(thing(k, panel(4.0 + 0.2 * k, *y), seen=2), expected=4, score=1.6,
                frames=(4 * k, 4 * k + 1), due=tuple(range(4 * k, 4 * k + 4)))
        for k, y in enumerate(JAMBS)
    )  # fmt: skip
    assert given([one, two]) == []
    same = replace(two, frames=(2, 3), due=one.due)
    assert len(given([one, same])) == 1
