"""Hand-made scene graphs for the objects tests."""

from __future__ import annotations

from situgraph.scenegraph.graph import Plane, Room, SceneGraph, Storey

SIDES = ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0))


def box(key: str, x0: float, y0: float, x1: float, y1: float, footprint: bool):
    offsets = (-x0, x1, -y0, y1)
    planes = tuple(
        Plane(f"{key}{i}", (nx, ny, 0.0), d) for i, ((nx, ny), d) in enumerate(zip(SIDES, offsets))
    )
    corners = ((x0, y0), (x1, y0), (x1, y1), (x0, y1)) if footprint else None
    center = ((x0 + x1) / 2, (y0 + y1) / 2, 1.4)
    return Room(key, center, tuple(p.id for p in planes), "s0", footprint=corners), planes


def two_rooms(footprint: bool = False) -> SceneGraph:
    """Rooms a (x 0..4) and b (x 4.2..8.2), both y 0..5, a wall of 0.2 m between them."""
    a, pa = box("a", 0.0, 0.0, 4.0, 5.0, footprint)
    b, pb = box("b", 4.2, 0.0, 8.2, 5.0, footprint)
    return SceneGraph(
        kind="online", storeys=(Storey("s0", height=2.8),), rooms=(a, b), planes=pa + pb
    )
