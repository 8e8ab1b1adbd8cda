"""Small buildings made by hand for the tests of the pictures."""

from __future__ import annotations

import msgspec
import numpy as np

from situgraph.geometry.poses import Placement
from situgraph.scenegraph.graph import (
    Ellipsoid,
    Keyframe,
    Object,
    Plane,
    Room,
    SceneGraph,
    Storey,
)
from situgraph.scenegraph.transform import transformed

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


TRUE = Placement(2.0, 1.0, 0.0, 0.5)


def seen(prior: SceneGraph, rooms: tuple[str, ...], *, moved: str | None = None) -> SceneGraph:
    """What a robot in a turned map frame saw of some rooms, and one room that is not there.

    The wall ``moved`` stands 0.3 m inside its room.
    """
    kept = [r for r in prior.rooms if r.id in rooms]
    planes = [prior.plane_by_id[p] for r in kept for p in r.planes]
    planes = [
        msgspec.structs.replace(p, offset=p.offset - 0.3, extent=None) if p.id == moved else p
        for p in planes
    ]
    false_room = Room("r-false", (8.0, 12.0, 1.3), (), name="nothing")
    graph = prior.replace(
        name="Log",
        kind="online",
        storeys=(),
        rooms=(
            *(msgspec.structs.replace(r, storey=None, name=None, footprint=None) for r in kept),
            false_room,
        ),
        planes=tuple(planes),
        objects=tuple(
            msgspec.structs.replace(
                o,
                rooms=tuple(r for r in o.rooms if r in rooms),
                planes=tuple(p for p in o.planes if any(p == q.id for q in planes)),
            )
            for o in prior.objects
            if set(o.rooms) & set(rooms)
        ),
        keyframes=walked(prior).keyframes[:14],
    )  # fmt: skip
    return transformed(graph, TRUE.inverse())


def match_of(online: SceneGraph, moved: str | None = None, **changes: object) -> dict[str, object]:
    """A match JSON that is right for ``seen``; ids are the same in both graphs."""
    rooms = {r.id: r.id for r in online.rooms if r.id != "r-false"}
    solution = {
        "transform": {"x": TRUE.x, "y": TRUE.y, "z": TRUE.z, "yaw": TRUE.yaw},
        "storeys": {},
        "rooms": rooms,
        "also_covers": {},
        "planes": {p.id: p.id for p in online.planes},
        "objects": {o.id: o.id for o in online.objects[1:]},
        "score": 0.97,
        "probability": 0.9991,
        "rms": 0.03,
        "deviations": []
        if moved is None
        else [{"plane": moved, "offset": 0.3, "tilt": 0.0, "sigma": 0.02}],
    }
    found: dict[str, object] = {
        "format": "situgraph/match",
        "version": 1,
        "unique": True,
        "certified": True,
        "verdict": "unique",
        "reason": "one placement explains 3 of 4 rooms",
        "probability_outside": 1e-6,
        "count": 1,
        "truncated": False,
        "solutions": [solution],
        "disambiguation": [],
        "stats": {
            "rooms_online": len(online.rooms),
            "rooms_prior": 6,
            "semantics": "likelihood",
            "room_candidates": {"type": 24, "semantic": 9, "geometric": 4},
            "plane_candidates": {"type": 96, "semantic": 40, "geometric": 12},
            "hypotheses": 12,
            "candidates": 2,
            "seconds": {"index": 0.001, "search": 0.0004, "total": 0.0018},
            "complete": True,
            "model": "at least 3 of 4 rooms, 0.15 m, 5 deg, walls moved up to 0.4 m",
        },
    }
    return {**found, **changes}


def ambiguous(online: SceneGraph, prior: SceneGraph) -> dict[str, object]:
    """The same seen in a half-turned building: two placements, and what would tell them apart."""
    match = match_of(online)
    true = match["solutions"][0]  # type: ignore[index]
    x = max(c[0] for r in prior.rooms for c in r.footprint or ())
    y = max(c[1] for r in prior.rooms for c in r.footprint or ())
    half = Placement(x, y, 0.0, np.pi).compose(TRUE)
    turned = {**true, "transform": {"x": half.x, "y": half.y, "z": half.z, "yaw": half.yaw}}
    last = {r.id: q.id for r, q in zip(prior.rooms, reversed(prior.rooms))}
    turned = {
        **turned, "rooms": {r: last[r] for r in true["rooms"]}, "objects": {}, "probability": 0.3
    }  # fmt: skip
    room = prior.rooms[0]
    advice = [
        {"look_for": "window", "on_plane": room.planes[3], "in_room": room.id, "splits": [[0], [1]]}
    ]
    return {
        **match,
        "unique": False,
        "certified": False,
        "verdict": "ambiguous",
        "count": 2,
        "reason": "two placements explain 3 of 4 rooms",
        "solutions": [{**true, "probability": 0.7}, turned],
        "disambiguation": advice,
    }
