"""Deliberate changes of a graph: broken symmetry."""

from __future__ import annotations

from typing import Literal

import msgspec
import numpy as np

from situgraph.errors import InputError
from situgraph.scenegraph.graph import Object, SceneGraph, Vec2

Change = Literal["object", "wall"]

# How far a wall is moved into its room (m): more than any tolerance, less than a room.
WALL_SHIFT = (0.35, 0.6)
# Things closer (m) to the middle of the layout than this may be their own image.
MIDDLE = 0.5

_change = msgspec.structs.replace


def break_symmetry(graph: SceneGraph, seed: int = 0, change: Change = "object") -> SceneGraph:
    """The graph with one thing altered, so that it no longer maps onto itself.

    ``object`` removes one object or gives it another category; ``wall`` moves one face of a room
    in by 0.35 to 0.6 m, and what hangs on it. The middle of the layout is spared, where a thing
    may be its own image. ``attributes['broken']`` names the node.

    Raises:
        InputError: there is nothing to alter.
    """
    rng = np.random.default_rng(seed)
    broken = _without_object(graph, rng) if change == "object" else _with_wall_moved(graph, rng)
    if broken is None:
        raise InputError(graph.name or "graph", f"no {change} to alter", "alter something else")
    return broken


def _without_object(graph: SceneGraph, rng: np.random.Generator) -> SceneGraph | None:
    middle = _middle(graph)
    able = [o for o in graph.objects if _away(o.center[:2], middle) > MIDDLE]
    if not able:
        return None
    chosen = able[int(rng.integers(len(able)))]
    others = sorted(graph.categories - {chosen.category})
    objects: tuple[Object, ...]
    if others and rng.random() < 0.5:
        other = _change(chosen, category=others[int(rng.integers(len(others)))])
        objects = tuple(other if o.id == chosen.id else o for o in graph.objects)
    else:
        objects = tuple(o for o in graph.objects if o.id != chosen.id)
    return graph.replace(objects=objects, attributes={**graph.attributes, "broken": chosen.id})


def _with_wall_moved(graph: SceneGraph, rng: np.random.Generator) -> SceneGraph | None:
    able = [
        (r, p)
        for r in graph.rooms
        if r.footprint is not None and len(r.footprint) == len(r.planes) == 4
        for p in r.planes
    ]
    if not able:
        return None
    room, plane_id = able[int(rng.integers(len(able)))]
    assert room.footprint is not None
    moved = graph.plane_by_id[plane_id]
    shift = float(rng.uniform(*WALL_SHIFT))
    step = shift * np.array(moved.normal[:2])
    outline = np.array(room.footprint)
    on = np.abs(outline @ np.array(moved.normal[:2]) + moved.offset) < 1e-3
    outline[on] += step
    corners = [(float(x), float(y)) for x, y in outline]
    planes = {p.id: p for p in graph.planes}
    for k, p in enumerate(room.planes):
        planes[p] = _change(planes[p], extent=(corners[k], corners[(k + 1) % 4]))
    planes[plane_id] = _change(planes[plane_id], offset=moved.offset - shift)
    x, y, z = room.center
    center = (x + 0.5 * float(step[0]), y + 0.5 * float(step[1]), z)
    new_room = _change(room, footprint=tuple(corners), center=center)
    objects = tuple(
        _change(o, center=(o.center[0] + step[0], o.center[1] + step[1], o.center[2]))
        if plane_id in o.planes
        else o
        for o in graph.objects
    )
    return graph.replace(
        rooms=tuple(new_room if r.id == room.id else r for r in graph.rooms),
        planes=tuple(planes[p.id] for p in graph.planes),
        objects=objects,
        attributes={**graph.attributes, "broken": plane_id},
    )


def _middle(graph: SceneGraph) -> Vec2:
    points = np.array([p for r in graph.rooms for p in (r.footprint or (r.center[:2],))])
    x, y = (0.5 * (points.min(axis=0) + points.max(axis=0))).tolist()
    mean_x, mean_y = np.mean([r.center[:2] for r in graph.rooms], axis=0).tolist()
    # Both are the centre of a half turn; where they differ there is none.
    return 0.5 * (x + mean_x), 0.5 * (y + mean_y)


def _away(point: Vec2, middle: Vec2) -> float:
    return float(np.hypot(point[0] - middle[0], point[1] - middle[1]))
