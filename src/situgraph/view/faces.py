"""The faces of walls as segments in the plan."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import msgspec
import numpy as np
from numpy.typing import NDArray

from situgraph.geometry.planes import plan_view as plan_views
from situgraph.geometry.poses import Array
from situgraph.scenegraph.graph import Plane, SceneGraph
from situgraph.view.outlines import Outline

_ON_PLANE = 0.05  # m, an edge of a footprint this close to a plane lies on it
_NEAR_PATH = 15.0  # m, how far a plane may be from a path to be drawn beside it
_HORIZONTAL = 0.7  # a plane whose normal has a shorter horizontal part is no wall


class Faces(msgspec.Struct, frozen=True):
    """Segments (k, 2, 2) in metres with unit normals (k, 2) to the room side.

    One plane may give several segments, one for each room it bounds. ``in_room`` is False for the
    planes that bound no room, ``infinite`` true for those of which nobody knows where they end.
    """

    ids: tuple[str, ...]
    segments: Array
    normals: Array
    virtual: NDArray[np.bool_]
    in_room: NDArray[np.bool_]
    infinite: NDArray[np.bool_]

    def only(self, mask: NDArray[np.bool_]) -> Faces:
        """The faces where ``mask`` (k,) is true."""
        ids = tuple(i for i, keep in zip(self.ids, mask) if keep)
        return Faces(
            ids,
            self.segments[mask],
            self.normals[mask],
            self.virtual[mask],
            self.in_room[mask],
            self.infinite[mask],
        )


class _Rows:
    """Faces being gathered."""

    def __init__(self) -> None:
        self.ids: list[str] = []
        self.segments: list[tuple[tuple[float, float], tuple[float, float]]] = []
        self.normals: list[tuple[float, float]] = []
        self.virtual: list[bool] = []
        self.in_room: list[bool] = []
        self.infinite: list[bool] = []

    def add(
        self,
        plane: Plane,
        a: Iterable[float],
        b: Iterable[float],
        in_room: bool,
        infinite: bool = False,
    ) -> None:
        (ax, ay), (bx, by) = (tuple(map(float, p)) for p in (a, b))
        length = float(np.hypot(plane.normal[0], plane.normal[1]))
        self.ids.append(plane.id)
        self.segments.append(((ax, ay), (bx, by)))
        self.normals.append((plane.normal[0] / length, plane.normal[1] / length))
        self.virtual.append(bool(plane.virtual))
        self.in_room.append(in_room)
        self.infinite.append(infinite)

    def done(self) -> Faces:
        return Faces(
            tuple(self.ids),
            np.array(self.segments, dtype=float).reshape(-1, 2, 2),
            np.array(self.normals, dtype=float).reshape(-1, 2),
            np.array(self.virtual, dtype=bool),
            np.array(self.in_room, dtype=bool),
            np.array(self.infinite, dtype=bool),
        )


def wall_faces(
    graph: SceneGraph,
    rooms: Iterable[str],
    outlines: Mapping[str, Outline],
    free: Iterable[str],
    wall_gap: float,
) -> Faces:
    """The faces of ``rooms`` and the planes ``free`` that bound no room.

    A plane with an extent is drawn along it, once; one without along the edges of its rooms'
    outlines. A free plane without an extent is the back of the faces within ``wall_gap`` (m) that
    look the other way, or else a line across the drawing.
    """
    rows, drawn = _Rows(), set[str]()
    for id in rooms:
        outline = outlines.get(id)
        for plane_id in graph.room_by_id[id].planes:
            plane = graph.plane_by_id[plane_id]
            if _flat(plane) or plane_id in drawn:
                continue
            if plane.extent is not None:
                drawn.add(plane_id)
                rows.add(plane, plane.extent[0], plane.extent[1], in_room=True)
            elif outline is not None:
                for a, b in _edges_on(plane, outline):
                    rows.add(plane, a, b, in_room=True)
    free = list(free)
    box, known = _bounds(rows, graph, free), rows.done()
    for plane in (graph.plane_by_id[i] for i in free):
        if _flat(plane):
            continue
        if plane.extent is not None:
            rows.add(plane, plane.extent[0], plane.extent[1], in_room=False)
            continue
        backs = _behind(plane, known, wall_gap)
        for a, b in backs:
            rows.add(plane, a, b, in_room=False)
        segment = None if backs else _across(plane, box)
        if segment is not None:
            rows.add(plane, segment[0], segment[1], in_room=False, infinite=True)
    return rows.done()


def plan_view(plane: Plane) -> tuple[Array, float]:
    """A wall's line in the plan: unit normal (2,) and offset (m)."""
    n, d = plan_views([plane.normal], [plane.offset])
    return n[0], float(d[0])


def _flat(plane: Plane) -> bool:
    return bool(np.hypot(plane.normal[0], plane.normal[1]) < _HORIZONTAL)


def _edges_on(plane: Plane, outline: Outline) -> list[tuple[Array, Array]]:
    """The edges of an outline that lie on the plane."""
    polygon = outline.polygon
    after = np.roll(polygon, -1, axis=0)
    if outline.derived:
        on = [side == plane.id for side in outline.sides]
    else:
        n, d = plan_view(plane)
        on = list((abs(polygon @ n + d) < _ON_PLANE) & (abs(after @ n + d) < _ON_PLANE))
    return [(polygon[i], after[i]) for i, yes in enumerate(on) if yes]


def _behind(plane: Plane, faces: Faces, gap: float) -> list[tuple[Array, Array]]:
    """The stretches of a plane that stand back to back with known faces."""
    n, d = plan_view(plane)
    distance = faces.segments @ n + d
    back = (faces.normals @ n < -0.97) & (distance.max(axis=1) < -0.02) & ~faces.virtual
    back &= distance.min(axis=1) > -gap
    along, foot = np.array([-n[1], n[0]]), -d * n
    thickness = -distance[back].mean(axis=1)
    # At corners a wall's back is longer than its face by the thickness.
    ends = np.sort((faces.segments[back] - foot) @ along, axis=1)
    ends += thickness[:, None] * np.array([-1.0, 1.0])
    spans: list[list[float]] = []
    for start, end in sorted(ends.tolist()):
        if spans and start <= spans[-1][1] + gap:
            spans[-1][1] = max(end, spans[-1][1])
        else:
            spans.append([start, end])
    return [(foot + start * along, foot + end * along) for start, end in spans]


def _bounds(rows: _Rows, graph: SceneGraph, free: Sequence[str]) -> tuple[Array, Array] | None:
    """What the unbounded planes are cut to: everything else, and a metre more."""
    points = [np.reshape(rows.segments, (-1, 2))] if rows.segments else []
    points += [np.array([k.pose[:2] for k in graph.keyframes])] if graph.keyframes else []
    points += [np.array([r.center[:2] for r in graph.rooms])] if graph.rooms else []
    if not points:
        return None
    if not graph.rooms:  # nothing but planes around a path: reach those that are near
        middle = np.concatenate(points).mean(axis=0)
        lines = [plan_view(p) for p in (graph.plane_by_id[i] for i in free) if not _flat(p)]
        steps = [-(n @ middle + d) * n for n, d in lines]
        points += [(middle + s)[None] for s in steps if np.linalg.norm(s) < _NEAR_PATH]
    every = np.concatenate(points)
    return every.min(axis=0) - 1.0, every.max(axis=0) + 1.0


def _across(plane: Plane, box: tuple[Array, Array] | None) -> tuple[Array, Array] | None:
    """The plane's line inside a box, or None where it misses it."""
    n, d = plan_view(plane)
    foot, along = -d * n, np.array([-n[1], n[0]])
    low, high = (foot - 1.0, foot + 1.0) if box is None else box
    start, end = -np.inf, np.inf
    for axis in (0, 1):
        if abs(along[axis]) < 1e-9:
            if not low[axis] <= foot[axis] <= high[axis]:
                return None
            continue
        t = sorted((np.array([low[axis], high[axis]]) - foot[axis]) / along[axis])
        start, end = max(start, t[0]), min(end, t[1])
    return (foot + start * along, foot + end * along) if start < end else None
