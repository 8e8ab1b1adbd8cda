"""The demo building, cell by cell: a plan of its first rooms, and some of these seen."""

from __future__ import annotations

import msgspec
import pytest

from situgraph.geometry.poses import Placement
from situgraph.matching import PlanIndex, match
from situgraph.plan.six_rooms import six_rooms
from situgraph.scenegraph.graph import SceneGraph
from situgraph.scenegraph.transform import transformed

CELLS = [(planned, seen) for planned in range(1, 7) for seen in range(1, planned + 1)]
MOTION = Placement(3.0, -7.0, 0.0, 0.7)


def first_rooms(building: SceneGraph, count: int) -> SceneGraph:
    """The first rooms of a building, with their walls and objects."""
    rooms = building.rooms[:count]
    ids, planes = {r.id for r in rooms}, {p for r in rooms for p in r.planes}
    objects = tuple(
        msgspec.structs.replace(
            o,
            rooms=tuple(r for r in o.rooms if r in ids),
            planes=tuple(p for p in o.planes if p in planes),
        )
        for o in building.objects
        if ids & set(o.rooms)
    )
    kept = tuple(p for p in building.planes if p.id in planes)
    return building.replace(rooms=rooms, planes=kept, objects=objects)


@pytest.mark.parametrize("semantics", ["containment", "likelihood"])
@pytest.mark.parametrize(("planned", "seen"), CELLS)
def test_objects_locate_the_robot_in_its_first_room(
    planned: int, seen: int, semantics: str
) -> None:
    building = six_rooms(planned)
    online = transformed(first_rooms(building, seen), MOTION)
    result = match(online, PlanIndex(building), semantics=semantics)  # type: ignore[arg-type]
    assert result.unique
    assert result.best is not None
    assert result.best.rooms == {r.id: r.id for r in online.rooms}
    assert result.certified == (semantics == "likelihood")


def test_walls_alone_locate_it_where_the_layout_breaks_the_symmetry() -> None:
    unique = {
        (planned, seen)
        for planned, seen in CELLS
        if match(first_rooms(six_rooms(planned), seen), six_rooms(planned), semantics="none").unique
    }
    assert unique == {(3, 3), (5, 5)}
