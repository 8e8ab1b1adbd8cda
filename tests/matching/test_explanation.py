"""Why a pair of rooms was not matched: the stage that dropped it, and the figure that did."""

from __future__ import annotations

import msgspec
import pytest

from situgraph.geometry.poses import Placement
from situgraph.matching import PlanIndex, match
from situgraph.matching.explanation import explain_pair
from situgraph.plan.six_rooms import six_rooms
from situgraph.scenegraph.graph import Plane, Room, SceneGraph
from situgraph.scenegraph.transform import transformed

RECTANGLES = [(0, 0, 4, 3), (4.2, 0, 7, 3), (0, 3.2, 4, 5.5), (4.2, 3.2, 2.5, 5.5), (11.4, 0, 4, 3)]


def building() -> SceneGraph:
    rooms, planes = [], []
    for k, (x, y, w, h) in enumerate(RECTANGLES):
        faces = [((1.0, 0.0), -x), ((-1.0, 0.0), x + w), ((0.0, 1.0), -y), ((0.0, -1.0), y + h)]
        names = tuple(f"p{k}.{i}" for i in range(4))
        planes += [Plane(n, (*f, 0.0), d) for n, (f, d) in zip(names, faces)]
        rooms.append(Room(f"r{k}", (x + w / 2, y + h / 2, 1.3), names))
    return SceneGraph(rooms=tuple(rooms), planes=tuple(planes))


@pytest.fixture(scope="module")
def plan() -> SceneGraph:
    return building()


def test_a_matched_pair(plan: SceneGraph) -> None:
    result = match(transformed(plan, Placement(3.0, -7.0, 0.0, 0.7)), PlanIndex(plan))
    assert explain_pair(result, "r1", "r1").stage == "matched"


def test_two_rooms_of_other_widths(plan: SceneGraph) -> None:
    result = match(transformed(plan, Placement(3.0, -7.0, 0.0, 0.7)), PlanIndex(plan))
    told = explain_pair(result, "r1", "r2")
    assert told.stage == "geometric"
    assert "m off" in told.sentence


def test_two_rooms_that_are_alike_but_elsewhere(plan: SceneGraph) -> None:
    result = match(transformed(plan, Placement(3.0, -7.0, 0.0, 0.7)), PlanIndex(plan))
    told = explain_pair(result, "r0", "r4")
    assert told.stage == "placement"
    assert "of 5 rooms" in told.sentence
    assert "11.40" in told.sentence


def test_a_room_without_walls(plan: SceneGraph) -> None:
    bare = plan.replace(rooms=(*plan.rooms, Room("bare", (1.0, 1.0, 1.0), ())))
    assert explain_pair(match(bare, PlanIndex(plan)), "bare", "r0").stage == "type"


def test_an_object_too_many() -> None:
    plan = six_rooms()
    window = next(o for o in plan.objects if o.category == "window")
    room = window.rooms[0]
    more = tuple(msgspec.structs.replace(window, id=f"more{k}") for k in range(9))
    result = match(plan.replace(objects=(*plan.objects, *more)), plan, semantics="containment")
    told = explain_pair(result, room, room)
    assert told.stage == "semantic"
    assert "window count" in told.sentence


def test_walls_with_an_object_too_many() -> None:
    plan = six_rooms()
    # A door and a window are on the wrong walls: the room holds what it should, its walls do not.
    south, _, north, _ = plan.room_by_id["r5"].planes
    strays = {"o6": ("p13", north), "o17": (south,)}
    online = plan.replace(
        objects=tuple(
            msgspec.structs.replace(o, planes=strays[o.id]) if o.id in strays else o
            for o in plan.objects
        )
    )
    told = explain_pair(match(online, plan, semantics="containment"), "r5", "r5")
    assert told.stage == "semantic"
    for sentence in (f"{south}: window count 1 > 0 on {south}", f"{north}: door count 2 > 1"):
        assert f"wall {sentence}" in told.sentence


def test_a_shape_that_does_not_fit_is_no_matter_of_objects() -> None:
    plan = six_rooms()
    online = plan.replace(planes=tuple(_shifted(p) for p in plan.planes))
    told = explain_pair(match(online, plan, semantics="containment"), "r1", "r1")
    assert told.stage == "geometric"


def _shifted(plane: Plane) -> Plane:
    """Southern and western faces of r1, one metre out."""
    far = plane.id in ("p0", "p3")
    return msgspec.structs.replace(plane, offset=plane.offset + 1.0) if far else plane
