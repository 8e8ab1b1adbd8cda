"""A region of free space becomes a polygon whose sides lie on wall planes.

The lines of the planes that bound the region cut the plan into convex cells; the cells that are
mostly free are the room. Where the region ends without a wall, a line of no plane closes it. This
gives rectangles, L-shapes and slanted walls alike, and no side between two walls is invented.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from situgraph.geometry.poses import Array
from situgraph.slam.config import RoomConfig
from situgraph.slam.gaps import Gap
from situgraph.slam.planemap import Interval, MapPlane, united
from situgraph.slam.raster import Mask, Raster

STEPS = np.array([1.0, 2.0, 3.0])  # cells before a wall where its room's free space is looked for


class Side(NamedTuple):
    """A side of a room: its line (3,) n, d with n into the room; plane number, None where open.

    ``low`` and ``high`` (m) along the tangent, ``seen`` (m): how much of it is wall or doorway.
    """

    line: Array
    plane: int | None
    low: float
    high: float
    seen: float

    @property
    def length(self) -> float:
        """Metres."""
        return self.high - self.low


class Footprint(NamedTuple):
    """A room's outline: counter-clockwise ``corners`` (n, 2), side i from corner i to i + 1."""

    corners: Array
    sides: tuple[Side, ...]
    area: float
    centre: tuple[float, float]

    @property
    def planes(self) -> tuple[int, ...]:
        """Numbers of the planes around it, each once, in order."""
        return tuple(dict.fromkeys(s.plane for s in self.sides if s.plane is not None))

    @property
    def closed(self) -> float:
        """Share of the outline that was seen as wall or doorway."""
        return sum(s.seen for s in self.sides) / max(sum(s.length for s in self.sides), 1e-9)


def footprint(
    region: Mask,
    raster: Raster,
    planes: Sequence[MapPlane],
    gaps: Sequence[Gap],
    config: RoomConfig,
) -> Footprint | None:
    """The outline of a region, None where no wall bounds it."""
    free = raster.centres(region)
    low, high = free.min(axis=0) - config.open_slack, free.max(axis=0) + config.open_slack
    near = [p for p in planes if (p.low <= high).all() and (p.high >= low).all()]
    support = {p.number: _support(p, region, raster, config) for p in near}
    kept = _chosen([p for p in near if support[p.number] >= config.least_support], support, config)
    if not kept:
        return None
    lines = [np.array([*p.normal, p.offset]) for p in kept]
    lines += _closing(lines, free, config)
    shape = _union(_cells(lines, free), lines, free, raster.cell, config)
    if shape is None:
        return None
    corners = _corners(shape)
    sides = _sides(corners, lines, kept, planes, gaps, config)
    centre = shape.centroid
    return Footprint(corners, tuple(sides), float(shape.area), (float(centre.x), float(centre.y)))


def _support(plane: MapPlane, region: Mask, raster: Raster, config: RoomConfig) -> float:
    """Metres of the plane that have the region right before them."""
    total = 0.0
    for low, high in plane.intervals:
        along = np.arange(low + raster.cell / 2, high, raster.cell)
        if len(along) == 0:
            continue
        wall = -plane.offset * plane.normal + along[:, None] * plane.tangent
        before = (wall + (STEPS * raster.cell)[:, None, None] * plane.normal).reshape(-1, 2)
        free = raster.look(region, before).reshape(len(STEPS), -1)
        total += raster.cell * int(np.count_nonzero(free.any(axis=0)))
    return total


def _chosen(
    planes: Sequence[MapPlane], support: dict[int, float], config: RoomConfig
) -> list[MapPlane]:
    """The planes without near doubles: frames of windows, skirtings, a wall seen twice."""
    kept: list[MapPlane] = []
    for plane in sorted(planes, key=lambda p: (-support[p.number], p.number)):
        middle = plane.ends().mean(axis=0)
        double = any(
            float(plane.normal @ other.normal) > 0.97
            and abs(float(other.normal @ middle) + other.offset) < config.jog
            for other in kept
        )
        if not double:
            kept.append(plane)
    return kept[: config.most_planes]


def _closing(lines: Sequence[Array], free: Array, config: RoomConfig) -> list[Array]:
    """Lines of no plane where the region reaches past every wall, in the walls' directions."""
    directions: list[Array] = []
    for line in lines:
        for n in (line[:2], -line[:2]):
            if all(float(n @ m) < 0.9 for m in directions):
                directions.append(n)
    added = []
    for n in directions:
        offset = -float(np.percentile(free @ n, 0.5))
        closed = any(
            float(n @ line[:2]) > 0.9 and abs(line[2] - offset) < config.open_slack
            for line in lines
        )
        if not closed:
            added.append(np.array([*n, offset]))
    return added


def _cells(lines: Sequence[Array], free: Array) -> list[Array]:
    """Convex polygons (n, 2) into which the lines cut the region's surroundings."""
    (x0, y0), (x1, y1) = free.min(axis=0) - 1.0, free.max(axis=0) + 1.0
    cells = [np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])]
    for line in lines:
        cut: list[Array] = []
        for cell in cells:
            side = cell @ line[:2] + line[2]
            if (side > 1e-6).any() and (side < -1e-6).any():
                cut += [_half(cell, side), _half(cell, -side)]
            else:
                cut.append(cell)
        cells = cut
    return cells


def _half(cell: Array, side: Array) -> Array:
    """The part of a convex polygon where ``side`` (n,), linear in the plan, is positive."""
    out = []
    for i in range(len(cell)):
        j = (i + 1) % len(cell)
        if side[i] >= 0:
            out.append(cell[i])
        if side[i] * side[j] < 0:
            share = side[i] / (side[i] - side[j])
            out.append(cell[i] + share * (cell[j] - cell[i]))
    return np.array(out)


def _union(
    cells: Sequence[Array], lines: Sequence[Array], free: Array, cell: float, config: RoomConfig
) -> Any:
    """The polygon of the cells that are mostly free; the largest where they fall apart."""
    import shapely

    normals = np.array([line[:2] for line in lines])
    offsets = np.array([line[2] for line in lines])
    powers = 1 << np.arange(len(lines), dtype=np.int64)

    def code(points: Array) -> Array:
        out: Array = ((points @ normals.T + offsets > 0) * powers).sum(axis=1)
        return out

    names, counts = np.unique(code(free), return_counts=True)
    covered = dict(zip(names.tolist(), counts.tolist()))
    taken = []
    for polygon, name in zip(cells, code(np.array([c.mean(axis=0) for c in cells])).tolist()):
        shape = shapely.Polygon(polygon)
        if covered.get(name, 0) * cell**2 > config.free_share * shape.area:
            taken.append(shape)
    if not taken:
        return None
    shape = shapely.unary_union(shapely.set_precision(taken, 1e-6))
    parts = list(getattr(shape, "geoms", [shape]))
    largest = max(parts, key=lambda s: s.area)
    return shapely.Polygon(largest.exterior)


def _corners(shape: Any) -> Array:
    """Counter-clockwise corners (n, 2) without points on straight sides."""
    import shapely

    ring = np.asarray(shapely.geometry.polygon.orient(shape).exterior.coords)[:-1]
    before, after = np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0)
    a, b = ring - before, after - ring
    turn = np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    sharp = turn > 1e-3 * np.linalg.norm(a, axis=1) * np.linalg.norm(b, axis=1)
    out: Array = ring[sharp]
    return out


def _sides(
    corners: Array,
    lines: Sequence[Array],
    kept: Sequence[MapPlane],
    planes: Sequence[MapPlane],
    gaps: Sequence[Gap],
    config: RoomConfig,
) -> list[Side]:
    sides = []
    for a, b in zip(corners, np.roll(corners, -1, axis=0)):
        tangent = (b - a) / max(float(np.linalg.norm(b - a)), 1e-9)
        normal = np.array([-tangent[1], tangent[0]])
        line = np.array([*normal, -float(normal @ a)])
        number, seen = _behind(line, a, b, kept, planes, gaps, config)
        for own, plane in zip(lines, kept):
            if number == plane.number:
                line = own
        along = np.array([-line[1], line[0]])
        low, high = sorted((float(along @ a), float(along @ b)))
        sides.append(Side(line, number, low, high, seen))
    return sides


def _behind(
    line: Array,
    a: Array,
    b: Array,
    kept: Sequence[MapPlane],
    planes: Sequence[MapPlane],
    gaps: Sequence[Gap],
    config: RoomConfig,
) -> tuple[int | None, float]:
    """The plane a side lies on, None when it is none, and how much (m) of the side was seen."""
    length = float(np.linalg.norm(b - a))
    tangent = (b - a) / max(length, 1e-9)
    walls: list[Interval] = []
    best: tuple[float, int] | None = None
    on_kept = {p.number for p in kept}
    for plane in planes:
        if float(plane.normal @ line[:2]) < 0.97:
            continue
        middle = (a + b) / 2
        if abs(float(plane.normal @ middle) + plane.offset) > config.jog:
            continue
        mine = [
            _clip(
                float(tangent @ (plane.point(u) - a)), float(tangent @ (plane.point(v) - a)), length
            )
            for u, v in plane.intervals
        ]
        mine += [
            _clip(float(tangent @ (g.ends[0] - a)), float(tangent @ (g.ends[1] - a)), length)
            for g in gaps
            if g.plane == plane.number
        ]
        walls += mine
        share = sum(v - u for u, v in united(mine, 0.0))
        if plane.number in on_kept and share > 0.2 and (best is None or share > best[0]):
            exact = abs(float(plane.normal @ middle) + plane.offset)
            if exact < 0.02 or best is None:
                best = (share, plane.number)
    seen = min(sum(v - u for u, v in united(walls, 0.0)), length)
    return (None if best is None else best[1]), seen


def _clip(a: float, b: float, length: float) -> Interval:
    low, high = (a, b) if a < b else (b, a)
    low, high = min(max(low, 0.0), length), min(max(high, 0.0), length)
    return low, high
