"""Rooms of a model that has none: what its walls enclose, cut above each storey's floor."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import msgspec
import numpy as np

from situgraph.geometry.planes import from_footprint
from situgraph.geometry.poses import Array
from situgraph.plan.building import Building, Element, Level, Mesh
from situgraph.plan.config import PlanConfig
from situgraph.plan.faces import Face
from situgraph.plan.outlines import footprint, polygons
from situgraph.plan.rooms import RoomShape, in_order

if TYPE_CHECKING:
    from shapely import Polygon

NO_BODY = Mesh(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64))
NEAR = 0.1  # m; walls this near a room stand round it
FLAT = 0.6  # m; a thicker body of a slab is sloped or stepped
ONE_STOREY = 5.0  # m; walls that reach higher than this together make more than one storey
ROUNDING = 1e-9  # a point on the common edge of two triangles lies in both
SAME = 0.5  # share of the smaller of two rooms, in plan, that makes them one


class _Outline(msgspec.Struct, frozen=True):
    """The shadow of one wall or door and the heights between which it stands."""

    shadow: Polygon
    bottom: float
    top: float


def derive_rooms(building: Building, config: PlanConfig) -> list[RoomShape]:
    """Rooms from wall footprints: the holes of their union, cut ``cut_height`` above each storey.

    Doors stand in whole walls here (openings are not cut out), so they do not open a room. Doors
    without a wall, such as those of curtain walls, close the gap they stand in themselves. Floor
    and ceiling are the slabs below and above the cut, else the storey and the tops of the walls.
    """
    outlines = list(_outlines(building))
    levels = [lv for lv in building.levels if lv.elevation is not None]
    found: list[tuple[float, RoomShape]] = []
    for elevation in _elevations(levels, outlines):
        cut = elevation + config.cut_height
        crossing = [o for o in outlines if o.bottom < cut < o.top]
        for hole in _holes([o.shadow for o in crossing], config):
            below, above = _slabs_around(hole, cut, building.slabs)
            bottom = elevation if below is None else below
            top = _wall_tops(hole, crossing) if above is None else above
            level = min(levels, key=lambda lv: abs((lv.elevation or 0.0) - bottom), default=None)
            found.append(
                (abs(cut - config.cut_height - bottom), _shape(hole, level, bottom, top, config))
            )
    return _distinct(found, config)


def _outlines(building: Building) -> Iterator[_Outline]:
    import shapely

    # A flat slab at the height of the cut is as solid as a wall: split levels.
    slabs = [e.mesh for e in building.slabs if e.mesh.high[2] - e.mesh.low[2] < FLAT]
    for mesh in (*(e.mesh for e in building.walls), *slabs):
        for shadow in footprint(mesh):
            yield _Outline(shadow, float(mesh.low[2]), float(mesh.high[2]))
    for door in (f.mesh for f in building.fillings if not f.in_hole):
        # Without its handles and frames, so that the room has one face there.
        shadow = shapely.oriented_envelope(shapely.multipoints(door.vertices[:, :2]))
        if shadow.area > 0.0:
            yield _Outline(shadow, float(door.low[2]), float(door.high[2]))


def _elevations(levels: Sequence[Level], outlines: Sequence[_Outline]) -> list[float]:
    """The floors to look at: the declared storeys, else the heights at which walls begin."""
    declared = {round(lv.elevation or 0.0, 2) for lv in levels}
    tall = max((o.top for o in outlines), default=0.0) - min(
        (o.bottom for o in outlines), default=0.0
    )
    if declared and (len(declared) > 1 or tall < ONE_STOREY):
        return sorted(declared)
    return sorted({round(o.bottom, 1) for o in outlines})


def _holes(crossing: Sequence[Polygon], config: PlanConfig) -> Iterator[Polygon]:
    import shapely

    if not crossing:
        return
    half, slot = 0.5 * config.close_gap, 0.5 * config.min_room_width
    union = shapely.union_all(np.array(crossing)).buffer(half, join_style="mitre")
    union = union.buffer(-half, join_style="mitre")
    for solid in polygons(union):
        for ring in solid.interiors:
            # A pillar or core that stands inside without touching the rim is a hole of the room.
            free = shapely.Polygon(ring).difference(union)
            wide = free.buffer(-slot, join_style="mitre").buffer(slot, join_style="mitre")
            for part in polygons(wide.intersection(free).simplify(config.coplanar_offset)):
                if part.area >= config.min_room_area:
                    yield part


def _slabs_around(
    hole: Polygon, cut: float, slabs: Sequence[Element]
) -> tuple[float | None, float | None]:
    """The slab surfaces below and above the cut under most of the room, if any.

    Most of it, because the floor of a landing ends where the stairs begin.
    """
    below: list[float] = []
    above: list[float] = []
    for x, y in _samples(hole):
        over = (s.mesh for s in slabs if _covers(s.mesh, x, y))
        heights = [z for mesh in over for z in _heights(mesh, x, y)]
        below += [max((z for z in heights if z <= cut), default=-np.inf)]
        above += [min((z for z in heights if z > cut), default=np.inf)]
    return _usual(below), _usual(above)


def _samples(hole: Polygon) -> list[tuple[float, float]]:
    """Points spread over a room: those of a 5 x 5 grid that lie in it, else one point."""
    import shapely

    x0, y0, x1, y1 = hole.bounds
    shares = (np.arange(5) + 0.5) / 5.0
    x, y = (g.ravel() for g in np.meshgrid(x0 + shares * (x1 - x0), y0 + shares * (y1 - y0)))
    inside = shapely.contains_xy(hole, x, y)
    if inside.any():
        return list(zip(x[inside].tolist(), y[inside].tolist(), strict=True))
    point = hole.representative_point()
    return [(float(point.x), float(point.y))]


def _covers(mesh: Mesh, x: float, y: float) -> bool:
    (x0, y0, _), (x1, y1, _) = mesh.low, mesh.high
    return bool(x0 <= x <= x1 and y0 <= y <= y1)


def _usual(heights: Sequence[float]) -> float | None:
    """The most frequent height, the highest of several as frequent; None if most are infinite."""
    rounded = [round(z, 2) if np.isfinite(z) else None for z in heights]
    counts = Counter(rounded)
    best = max(counts, key=lambda z: (counts[z], -np.inf if z is None else z))
    return best if best is None else next(z for z in heights if round(z, 2) == best)


def _wall_tops(hole: Polygon, crossing: Sequence[_Outline]) -> float:
    """The middle height of the tops of the walls round a room."""
    import shapely

    near = shapely.distance(np.array([o.shadow for o in crossing]), hole) < NEAR
    return float(np.median([o.top for o, beside in zip(crossing, near, strict=True) if beside]))


def _heights(mesh: Mesh, x: float, y: float) -> list[float]:
    """Where a vertical line meets the triangles of a mesh (barycentric coordinates)."""
    a, b, c = np.moveaxis(mesh.vertices[mesh.faces], 1, 0)
    ab, ac, ap = b - a, c - a, np.array([x, y]) - a[:, :2]
    double = ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0]
    level = np.abs(double) > 1e-9
    double = np.where(level, double, 1.0)
    v = (ap[:, 0] * ac[:, 1] - ap[:, 1] * ac[:, 0]) / double
    w = (ab[:, 0] * ap[:, 1] - ab[:, 1] * ap[:, 0]) / double
    inside = level & (v >= -ROUNDING) & (w >= -ROUNDING) & (v + w <= 1 + ROUNDING)
    z: Array = (a[:, 2] + v * ab[:, 2] + w * ac[:, 2])[inside]
    return [float(height) for height in z]


def _shape(
    hole: Polygon, level: Level | None, bottom: float, top: float, config: PlanConfig
) -> RoomShape:
    faces = [
        face
        for ring in (hole.exterior, *hole.interiors)
        for face in ring_faces(np.array(ring.coords[:-1]), bottom, top)
        if face.length >= config.min_face_length
    ]
    element = Element(0, "", "", None, NO_BODY, None if level is None else level.key)
    return RoomShape(element, hole, tuple(in_order(faces, hole)), bottom, top)


def ring_faces(ring: Array, bottom: float, top: float) -> Iterator[Face]:
    """The edges of a ring: counter-clockwise round the room, or clockwise round a pillar."""
    normals, offsets = from_footprint(ring)
    for n, d, start, end in zip(normals, offsets, ring, np.roll(ring, -1, axis=0), strict=True):
        t = np.array([n[1], -n[0]])
        span = (float(start @ t), float(end @ t))
        yield Face((float(n[0]), float(n[1])), float(d), (span,), bottom, top)


def _distinct(found: Sequence[tuple[float, RoomShape]], config: PlanConfig) -> list[RoomShape]:
    """Rooms seen in several cuts once, named by number from the lowest up.

    Of rooms one above the other, as in a stairwell, the lower ends where the upper begins.
    """
    kept: list[RoomShape] = []
    for _, shape in sorted(found, key=lambda pair: (round(pair[0], 3), -pair[1].bottom)):
        same_floor = [o for o in kept if abs(o.bottom - shape.bottom) < 0.5 * config.storey_split]
        if not any(_share(shape, other) > SAME for other in same_floor):
            kept.append(shape)
    kept.sort(key=lambda s: (round(s.bottom, 2), s.outline.bounds))
    return [_numbered(n, _ended(shape, kept)) for n, shape in enumerate(kept, start=1)]


def _ended(shape: RoomShape, kept: Sequence[RoomShape]) -> RoomShape:
    above = [
        o.bottom for o in kept if shape.bottom < o.bottom < shape.top and _share(shape, o) > SAME
    ]
    if not above:
        return shape
    top = min(above)
    faces = tuple(msgspec.structs.replace(f, top=top) for f in shape.faces)
    return msgspec.structs.replace(shape, faces=faces, top=top)


def _share(one: RoomShape, other: RoomShape) -> float:
    """The share of the smaller of two rooms that lies over or under the other."""
    smaller = min(one.outline.area, other.outline.area)
    return float(one.outline.intersection(other.outline).area / smaller)


def _numbered(number: int, shape: RoomShape) -> RoomShape:
    key, name = f"derived-{number}", f"derived {number}"
    element = Element(-number, key, "derived", name, NO_BODY, shape.element.level)
    return msgspec.structs.replace(shape, element=element)
