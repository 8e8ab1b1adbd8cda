"""The drawing of deviations says how many, where and of which kind."""

from __future__ import annotations

from situgraph.plan.six_rooms import six_rooms
from situgraph.view import draw_deviations
from situgraph.view.canvas import svg_text

MOVED = {"kind": "moved-wall", "category": "wall", "place": [7.0, 2.6, 1.4], "online": "p1",
         "prior": "p1", "offset": 0.12, "message": ""}  # fmt: skip
GONE = {"kind": "missing-object", "category": "door", "place": [3.0, 5.2, 1.0], "message": ""}


def test_marks_offsets_and_legend() -> None:
    plan = six_rooms()
    text = svg_text(draw_deviations(plan, [MOVED, GONE], plan.replace(kind="online")))
    assert "2 deviations" in text
    assert "+12 cm" in text
    assert ">moved<" in text
    assert ">missing<" in text


def test_a_building_as_planned_and_one_without_floors() -> None:
    plan = six_rooms()
    assert "0 deviations" in svg_text(draw_deviations(plan, [], plan))
    empty = plan.replace(rooms=(), planes=(), objects=(), storeys=())
    assert "no floor" in svg_text(draw_deviations(empty, [], plan))
