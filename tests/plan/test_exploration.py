"""How a robot gets to know a building."""

from __future__ import annotations

import typing
from itertools import pairwise

import numpy as np

from situgraph.objects.config import ObjectsConfig
from situgraph.plan.exploration import RoomLinks
from situgraph.plan.layout_config import Kind
from situgraph.plan.layouts import make_layout


def test_half_of_the_doors_of_visited_rooms_are_not_passed() -> None:
    doors = passed = 0
    for kind in typing.get_args(Kind):
        for seed in range(3):
            plan = make_layout(kind, 10, seed)
            walk = RoomLinks(plan).walk(4, np.random.default_rng(seed))
            stops = [plan.rooms[k].id for k in walk.stops]
            steps = {frozenset(step) for step in pairwise(stops)}
            near = [set(o.rooms) for o in plan.objects if o.category == "door"]
            doors += sum(bool(rooms & set(stops)) for rooms in near)
            passed += sum(rooms in steps for rooms in near)
    assert abs(1.0 - passed / doors - ObjectsConfig().doorway_not_passed) < 0.1
