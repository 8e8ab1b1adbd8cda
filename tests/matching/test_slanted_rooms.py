"""Rooms whose walls are neither parallel nor at right angles: the yaw meets its limits there."""

from __future__ import annotations

import itertools
import math

import msgspec
import pytest

from situgraph.matching import MatchingConfig, PlanIndex, match
from situgraph.scenegraph.graph import Plane, Room, SceneGraph

CONFIG = MatchingConfig(max_boxes=5_000, max_work=20_000_000)
PRIOR = {  # the walls of each room: directions of their normals in degrees, offsets
    "one": ((90.0, 0.0), (180.0, 3.6), (-85.236, 2.9896), (0.0, 0.0)),
    "two": ((100.305, 0.6798), (180.0, 7.1), (-84.806, 2.9424), (0.0, -3.8)),
}
CENTER = {"one": (1.8, 1.575, 1.4), "two": (5.45, 1.875, 1.4)}
SEEN = (0.48167, 7.12261, 2.89441, -3.7801)  # offsets of the second room's; the first wall moved


def walls(name: str, faces: tuple[tuple[float, float], ...]) -> tuple[Plane, ...]:
    made = []
    for k, (angle, offset) in enumerate(faces):
        turn = math.radians(angle)
        made.append(Plane(f"{name}{k}", (math.cos(turn), math.sin(turn), 0.0), offset))
    return tuple(made)


def graph(rooms: dict[str, tuple[Plane, ...]]) -> SceneGraph:
    return SceneGraph(
        rooms=tuple(Room(n, CENTER[n], tuple(p.id for p in made)) for n, made in rooms.items()),
        planes=tuple(p for made in rooms.values() for p in made),
    )


PLAN = PlanIndex(graph({name: walls(name, faces) for name, faces in PRIOR.items()}), CONFIG)
ROOM = graph(
    {"two": walls("two", tuple((a, d) for (a, _), d in zip(PRIOR["two"], SEEN, strict=True)))}
)


@pytest.mark.parametrize("order", list(itertools.permutations(range(4))))
def test_a_moved_wall_is_searched_to_the_end_in_any_order_of_the_planes(
    order: tuple[int, ...],
) -> None:
    planes = tuple(ROOM.rooms[0].planes[k] for k in order)
    seen = ROOM.replace(rooms=(msgspec.structs.replace(ROOM.rooms[0], planes=planes),))
    result = match(seen, PLAN, semantics="none")
    assert result.complete
    assert result.candidates == 7
