"""The six-room building: symmetric where the paper's is, and solvable by objects from one room."""

from __future__ import annotations

import itertools
from collections import Counter

import numpy as np
import pytest

from situgraph.errors import InputError
from situgraph.plan.six_rooms import six_rooms
from situgraph.scenegraph.graph import SceneGraph
from situgraph.scenegraph.validation import validate

TURNS = (0, 1, 2, 3)  # quarter turns


def corners(graph: SceneGraph, rooms: int) -> np.ndarray:
    return np.array([graph.room_by_id[f"r{i}"].footprint for i in range(1, rooms + 1)])


def placements(seen: int, mapped: int) -> list[tuple[int, tuple[int, ...]]]:
    """By brute force: every quarter turn and one-to-one map of rooms that geometry allows.

    Rooms agree when all corners do, within a centimetre; a corner of each is enough for the shift.
    """
    graph = six_rooms(6)
    source, target = corners(graph, seen), corners(graph, mapped)
    found = []
    for turn in TURNS:
        c, s = (1, 0, -1, 0)[turn], (0, 1, 0, -1)[turn]
        turned = source @ np.array([[c, s], [-s, c]])
        for room in range(mapped):
            for k in range(4):
                moved = turned + target[room][k] - turned[0][0]
                match = []
                for outline in moved:
                    fits = [
                        i
                        for i, other in enumerate(target)
                        if max(np.min(np.linalg.norm(other - p, axis=1)) for p in outline) < 0.01
                    ]
                    match.append(fits[0] if fits else -1)
                key = (turn, tuple(match))
                if -1 not in match and key not in found:
                    found.append(key)
    return found


def counts(graph: SceneGraph, node: str, level: str) -> Counter[str]:
    items = graph.objects_by_room if level == "room" else graph.objects_by_plane
    return Counter(o.category for o in items.get(node, ()))


def contained(graph: SceneGraph, seen: int, there: int, turn: int) -> bool:
    """The paper's filter for one room pair under a turn, at room and at plane level."""
    room, other = graph.room_by_id[f"r{seen}"], graph.room_by_id[f"r{there}"]
    pairs = [(room.id, other.id, "room")]
    pairs += [(room.planes[k], other.planes[(k + turn) % 4], "plane") for k in range(4)]
    return all(counts(graph, v, level) <= counts(graph, u, level) for v, u, level in pairs)


def only(graph: SceneGraph, categories: set[str]) -> SceneGraph:
    return graph.replace(objects=tuple(o for o in graph.objects if o.category in categories))


@pytest.mark.parametrize(("mapped", "seen"), [(m, j) for m in range(1, 7) for j in range(1, m + 1)])
def test_geometry_alone_is_ambiguous_but_for_three_and_five_rooms(mapped: int, seen: int) -> None:
    unique = len(placements(seen, mapped)) == 1
    assert unique == ((mapped, seen) in {(3, 3), (5, 5)})


@pytest.mark.parametrize("categories", [{"door", "window"}, {"door", "window", "column", "sink",
                                        "radiator", "extinguisher", "furniture"}])  # fmt: skip
def test_doors_and_windows_of_one_room_say_which_it_is(categories: set[str]) -> None:
    for mapped in range(1, 7):
        graph = only(six_rooms(mapped), categories)
        for seen, there, turn in itertools.product(
            range(1, mapped + 1), range(1, mapped + 1), (0, 2)
        ):
            same = seen == there and turn == 0
            assert contained(graph, seen, there, turn) == same


def test_one_miss_in_a_room_does_not_bring_a_rival_in() -> None:
    graph = only(six_rooms(6), {"door", "window"})
    for room in graph.rooms:
        for missed in graph.objects_by_room[room.id]:
            seen = graph.replace(objects=tuple(o for o in graph.objects if o.id != missed.id))
            for there, turn in itertools.product(range(1, 7), (0, 2)):
                if (there, turn) == (int(room.id[1:]), 0):
                    continue
                other = graph.rooms[there - 1]
                pairs = [(room.planes[k], other.planes[(k + turn) % 4]) for k in range(4)]
                assert not all(
                    counts(seen, v, "plane") <= counts(graph, u, "plane") for v, u in pairs
                )


@pytest.mark.parametrize("mapped", range(1, 7))
def test_the_building_is_a_valid_prior(mapped: int) -> None:
    graph = six_rooms(mapped)
    assert validate(graph, "six rooms") == graph
    assert len(graph.rooms) == mapped
    assert len(graph.planes) == 4 * mapped
    doors = [o for o in graph.objects if o.category == "door" and len(o.rooms) == 2]
    joined = {frozenset(o.rooms) for o in doors}
    assert {frozenset({f"r{i}", f"r{i + 1}"}) for i in range(1, mapped)} <= joined


def test_sizes_are_those_of_a_building() -> None:
    graph = six_rooms()
    for item in graph.objects:
        assert item.ellipsoid is not None
        width, depth, height = (2.0 * a for a in item.ellipsoid.axes)
        if item.category == "door":
            assert (width, height) == pytest.approx((0.9, 2.1))
            assert depth in (pytest.approx(0.15), pytest.approx(0.25))
        if item.category == "window":
            assert 1.2 <= width <= 1.6
            assert item.center[2] - 0.5 * height == pytest.approx(0.9)


def test_openings_of_a_wall_do_not_touch() -> None:
    graph = six_rooms()
    for plane in graph.planes:
        assert plane.extent is not None
        start, end = np.array(plane.extent)
        direction = (end - start) / np.linalg.norm(end - start)
        spans = []
        for item in graph.objects_by_plane.get(plane.id, ()):
            if item.category in ("door", "window"):
                assert item.ellipsoid is not None
                at = float((np.array(item.center[:2]) - start) @ direction)
                spans.append((at - item.ellipsoid.axes[0], at + item.ellipsoid.axes[0]))
        spans.sort()
        bounds = [0.0, *(b for span in spans for b in span), float(np.linalg.norm(end - start))]
        assert all(b - a > 0.14 for a, b in itertools.pairwise(bounds))


def test_other_numbers_of_rooms_are_refused() -> None:
    for rooms in (0, 7):
        with pytest.raises(InputError, match="1 to 6"):
            six_rooms(rooms)
