"""What a scene graph must obey, and what is odd but allowed.

Errors stop; oddities become warnings in the graph (code ``face-behind-room``).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import numpy as np

from situgraph.errors import InputError
from situgraph.scenegraph.graph import Room, SceneGraph, Warning

UNIT_TOLERANCE = 1e-3  # a normal printed with three decimals still counts as unit
LARGEST_MEDIAN_ROOM = 250.0  # m; 4 m rooms written in mm or cm have 4000 or 400
FACE_SLACK = 0.05  # m; how far inside the room the side of a face is probed


def validate(graph: SceneGraph, source: object = "graph") -> SceneGraph:
    """Check a graph; return it, with warnings added where something is odd.

    Raises:
        InputError: ids double or dangling, numbers not finite, normals not unit, not metres.
    """
    for kind in ("storeys", "rooms", "planes", "objects", "keyframes"):
        _unique(kind, [node.id for node in getattr(graph, kind)], source)
    _numbers(graph, source)
    _references(graph, source)
    _units(graph, source)
    return _with_odd_faces(graph)


def _fail(source: object, place: str, problem: str, remedy: str = "") -> InputError:
    return InputError(source, f"{place}: {problem}", remedy)


def _unique(kind: str, ids: Sequence[str], source: object) -> None:
    if len(set(ids)) == len(ids):
        return
    first: dict[str, int] = {}
    for position, key in enumerate(ids):
        if key in first:
            place = f"{kind}[{position}].id"
            raise _fail(
                source, place, f'"{key}" is already the id of {kind}[{first[key]}]', "rename one"
            )
        first[key] = position


def _finite(kind: str, field: str, values: Iterable[Iterable[float]], source: object) -> None:
    array = np.array([tuple(v) for v in values], dtype=float)
    bad = np.argwhere(~np.isfinite(array))
    if len(bad):
        raise _fail(source, f"{kind}[{bad[0][0]}].{field}", "expected finite numbers")


def _numbers(graph: SceneGraph, source: object) -> None:
    _finite("storeys", "elevation", ((s.elevation, s.height or 0.0) for s in graph.storeys), source)
    _finite("rooms", "center", (r.center for r in graph.rooms), source)
    _finite("planes", "offset", ((p.offset,) for p in graph.planes), source)
    _finite("planes", "normal", (p.normal for p in graph.planes), source)
    _finite("objects", "center", (o.center for o in graph.objects), source)
    _finite("objects", "confidence", ((o.confidence or 0.0,) for o in graph.objects), source)
    _finite("keyframes", "pose", ((k.stamp, *k.pose) for k in graph.keyframes), source)
    for i, room in enumerate(graph.rooms):
        if room.footprint is not None:
            _polygon(f"rooms[{i}].footprint", room.footprint, source)
    for i, plane in enumerate(graph.planes):
        length = math.sqrt(sum(v * v for v in plane.normal))
        if abs(length - 1.0) > UNIT_TOLERANCE:
            kind = (
                "a zero normal" if length < UNIT_TOLERANCE else f"a normal of length {length:.4g}"
            )
            raise _fail(source, f"planes[{i}].normal", f"{kind}, expected unit length")
        if plane.extent is not None and not all(math.isfinite(v) for p in plane.extent for v in p):
            raise _fail(source, f"planes[{i}].extent", "expected finite numbers")
    for i, item in enumerate(graph.objects):
        if item.ellipsoid is None:
            continue
        if not all(math.isfinite(v) and v > 0.0 for v in item.ellipsoid.axes):
            raise _fail(
                source, f"objects[{i}].ellipsoid.axes", "expected positive finite semi-axes"
            )
        if abs(math.hypot(*item.ellipsoid.rotation) - 1.0) > UNIT_TOLERANCE:
            place = f"objects[{i}].ellipsoid.rotation"
            raise _fail(source, place, "expected a unit quaternion")
    for i, frame in enumerate(graph.keyframes):
        if abs(math.hypot(*frame.pose[3:]) - 1.0) > UNIT_TOLERANCE:
            raise _fail(source, f"keyframes[{i}].pose", "expected x y z and a unit quaternion")


def _polygon(place: str, footprint: Sequence[tuple[float, float]], source: object) -> None:
    if len(footprint) < 3:
        raise _fail(source, place, f"{len(footprint)} corners, expected at least 3")
    if not all(math.isfinite(v) for point in footprint for v in point):
        raise _fail(source, place, "expected finite numbers")


def _references(graph: SceneGraph, source: object) -> None:
    storeys, rooms, planes = graph.storey_by_id, graph.room_by_id, graph.plane_by_id
    for i, room in enumerate(graph.rooms):
        if room.storey is not None and room.storey not in storeys:
            raise _fail(source, f"rooms[{i}].storey", f'no storey has the id "{room.storey}"')
        for j, plane in enumerate(room.planes):
            if plane not in planes:
                place = f"rooms[{i}].planes[{j}]"
                raise _fail(
                    source, place, f'no plane has the id "{plane}"', "add it or drop the reference"
                )
        if len(set(room.planes)) < len(room.planes):
            raise _fail(source, f"rooms[{i}].planes", "the same plane twice")
    for i, item in enumerate(graph.objects):
        for j, key in enumerate(item.rooms):
            if key not in rooms:
                raise _fail(source, f"objects[{i}].rooms[{j}]", f'no room has the id "{key}"')
        for j, key in enumerate(item.planes):
            if key not in planes:
                raise _fail(source, f"objects[{i}].planes[{j}]", f'no plane has the id "{key}"')


def room_size(graph: SceneGraph, room: Room) -> float | None:
    """The larger side (m) of a room's footprint, else of its farthest plane; None if unknown."""
    if room.footprint is not None:
        points = np.array(room.footprint)
        return float(np.ptp(points, axis=0).max())
    if not room.planes:
        return None
    normals, offsets = graph.plane_arrays(room.planes)
    return 2.0 * float(np.abs(normals @ np.array(room.center) + offsets).max())


def _units(graph: SceneGraph, source: object) -> None:
    sizes = [s for room in graph.rooms if (s := room_size(graph, room)) is not None]
    if sizes and (median := float(np.median(sizes))) > LARGEST_MEDIAN_ROOM:
        problem = f"the median room is {median:.0f} m wide"
        raise _fail(source, "rooms", problem, "the graph must be in metres: scale mm by 0.001")


def _with_odd_faces(graph: SceneGraph) -> SceneGraph:
    """Warn of faces whose inner side, next to the face, is outside the room's footprint."""
    known = {w.ids for w in graph.warnings if w.code == "face-behind-room"}
    found = []
    for room in graph.rooms:
        if room.footprint is None:
            continue
        for key in room.planes:
            plane = graph.plane_by_id[key]
            if plane.extent is None or (room.id, key) in known:
                continue
            (x0, y0), (x1, y1) = plane.extent
            x = (x0 + x1) / 2 + FACE_SLACK * plane.normal[0]
            y = (y0 + y1) / 2 + FACE_SLACK * plane.normal[1]
            nx, ny, _ = plane.normal
            behind = (x - 2 * FACE_SLACK * nx, y - 2 * FACE_SLACK * ny)
            if not _inside(x, y, room.footprint) and _inside(*behind, room.footprint):
                message = (
                    f"room {room.id} lies behind its face {key}: the normal points out of the room"
                )
                found.append(Warning("face-behind-room", message, (room.id, key)))
    return graph.replace(warnings=(*graph.warnings, *found)) if found else graph


def _inside(x: float, y: float, polygon: Sequence[tuple[float, float]]) -> bool:
    """Whether the point lies in the polygon (even-odd rule)."""
    inside = False
    x0, y0 = polygon[-1]
    for x1, y1 in polygon:
        if (y0 > y) != (y1 > y) and x < (x1 - x0) * (y - y0) / (y1 - y0) + x0:
            inside = not inside
        x0, y0 = x1, y1
    return inside
