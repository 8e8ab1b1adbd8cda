"""Small buildings made by hand for the tests of the pictures."""

from __future__ import annotations

from situgraph.scenegraph.graph import (
    Ellipsoid,
    Keyframe,
    Object,
    Plane,
    Room,
    SceneGraph,
    Storey,
)

WALL = 0.2


def office(
    columns: int = 3,
    rows: int = 2,
    storeys: int = 1,
    *,
    footprints: bool = True,
    name: str = "Office",
) -> SceneGraph:
    """A grid of rooms 5 x 4 m (the wall included), doors between neighbours, windows outside."""
    levels, rooms, planes, objects = [], [], [], []
    for level in range(storeys):
        levels.append(Storey(f"s{level}", f"Level {level}", 3.0 * level, 2.7))
        for row in range(rows):
            for column in range(columns):
                key = f"{level}-{row}-{column}"
                x0, y0 = 5.0 * column, 4.0 * row
                x1, y1 = x0 + 5.0 - WALL, y0 + 4.0 - WALL
                corners = ((x0, y0), (x1, y0), (x1, y1), (x0, y1))
                normals = ((0, 1, 0), (-1, 0, 0), (0, -1, 0), (1, 0, 0))
                ids = tuple(f"p{key}-{i}" for i in range(4))
                for i in range(4):
                    a, b = corners[i], corners[(i + 1) % 4]
                    n = normals[i]
                    offset = -(n[0] * a[0] + n[1] * a[1])
                    extent = (a, b) if footprints else None
                    planes.append(Plane(ids[i], n, offset, extent=extent))
                center = ((x0 + x1) / 2, (y0 + y1) / 2, 3.0 * level + 1.35)
                rooms.append(
                    Room(
                        f"r{key}",
                        center,
                        ids,
                        storey=f"s{level}",
                        name=f"{level}{row}{column}",
                        footprint=corners if footprints else None,
                    )
                )
                if column + 1 < columns:
                    objects.append(
                        Object(
                            f"o{key}-door",
                            "door",
                            (x1 + WALL / 2, (y0 + y1) / 2, 3.0 * level + 1.0),
                            Ellipsoid((0.1, 0.5, 1.0)),
                            (f"r{key}", f"r{level}-{row}-{column + 1}"),
                            (f"p{key}-1", f"p{level}-{row}-{column + 1}-3"),
                        )
                    )
                if row == 0:
                    objects.append(
                        Object(
                            f"o{key}-window",
                            "window",
                            ((x0 + x1) / 2, y0 - WALL / 2, 3.0 * level + 1.5),
                            Ellipsoid((0.8, 0.1, 0.6)),
                            (f"r{key}",),
                            (f"p{key}-0",),
                        )
                    )
                objects.append(
                    Object(
                        f"o{key}-table",
                        "table" if column % 2 else "chair",
                        (x0 + 1.2, y0 + 1.0, 3.0 * level + 0.4),
                        Ellipsoid((0.6, 0.4, 0.4)),
                        (f"r{key}",),
                    )
                )
    return SceneGraph(
        name=name,
        storeys=tuple(levels),
        rooms=tuple(rooms),
        planes=tuple(planes),
        objects=tuple(objects),
    )


def walked(graph: SceneGraph) -> SceneGraph:
    """The graph as if seen by a robot that crossed its first row of rooms."""
    frames = tuple(
        Keyframe(f"k{i}", float(i), (0.5 + 0.5 * i, 1.9, 0.3, 0.0, 0.0, 0.0, 1.0))
        for i in range(25)
    )
    return graph.replace(kind="online", keyframes=frames)
