"""Identical rooms in a grid, where the number of placements is known by counting."""

from __future__ import annotations

from situgraph.experiments.oracle.definition import Definition
from situgraph.scenegraph.graph import Plane, Room, SceneGraph

WALL = 0.2  # metres between the faces of neighbouring rooms


def grid(rows: int, columns: int, width: float = 4.0, depth: float = 5.0) -> SceneGraph:
    """``rows`` x ``columns`` rooms, each ``width`` (x) by ``depth`` (y) metres with four walls."""
    rooms, planes = [], []
    for row in range(rows):
        for column in range(columns):
            x, y, place = column * (width + WALL), row * (depth + WALL), f"{row}-{column}"
            faces = [
                Plane(f"w{place}", (1.0, 0.0, 0.0), -x),
                Plane(f"s{place}", (0.0, 1.0, 0.0), -y),
                Plane(f"e{place}", (-1.0, 0.0, 0.0), x + width),
                Plane(f"n{place}", (0.0, -1.0, 0.0), y + depth),
            ]
            planes += faces
            center = (x + width / 2, y + depth / 2, 1.4)
            rooms.append(Room(f"r{place}", center, tuple(p.id for p in faces)))
    return SceneGraph(name=f"grid {rows} x {columns}", rooms=tuple(rooms), planes=tuple(planes))


def placements(
    pattern: tuple[int, int], plan: tuple[int, int], square: bool, constants: Definition
) -> int:
    """How many placements of an identical pattern in an identical grid are candidates.

    An h x w pattern in an n x m grid of the same rooms has (n - h + 1)(m - w + 1) shifts at each of
    the yaws that turn a room into itself, two or, for square rooms, four (with h and w exchanged at
    the quarter turns); to these come the shifts that overlap the grid in K rooms or more.
    """
    rows, columns = pattern
    least = constants.least_rooms(rows * columns)
    turned = [(rows, columns)] * 2 + ([(columns, rows)] * 2 if square else [])
    return sum(
        _overlap(h, plan[0], i) * _overlap(w, plan[1], j) >= least
        for h, w in turned
        for i in range(-h + 1, plan[0])
        for j in range(-w + 1, plan[1])
    )


def _overlap(length: int, available: int, start: int) -> int:
    return max(0, min(start + length, available) - max(start, 0))
