"""Vertical faces: coplanar triangles of a mesh gathered into the faces a robot sees."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

import msgspec
import numpy as np
from numpy.typing import NDArray

from situgraph.geometry.poses import Array
from situgraph.plan.building import Mesh
from situgraph.plan.config import PlanConfig
from situgraph.plan.outlines import footprint, is_consistent

Span = tuple[float, float]

SHORT = 1e-3  # m; shorter stretches of a face come from rounding
MANY = 2_000_000  # triangles times stretches; a face of more is not looked at stretch by stretch
PROBE = 0.01  # m; how far beside a face its two sides are looked at


class Face(msgspec.Struct, frozen=True):
    """A vertical face: unit ``normal`` (2,) and ``offset`` with ``n.x + d = 0`` in the plan.

    ``spans`` are the stretches it covers along its tangent ``(n_y, -n_x)`` (m), ``bottom`` and
    ``top`` its heights (m).
    """

    normal: tuple[float, float]
    offset: float
    spans: tuple[Span, ...]
    bottom: float
    top: float

    @property
    def tangent(self) -> tuple[float, float]:
        """The direction along the face; with an inward normal, counter-clockwise round the room."""
        return self.normal[1], -self.normal[0]

    @property
    def length(self) -> float:
        """The length of its stretches (m)."""
        return sum(hi - lo for lo, hi in self.spans)

    @property
    def height(self) -> float:
        """From its lowest to its highest point (m)."""
        return self.top - self.bottom

    @property
    def low(self) -> float:
        """Where it begins along its tangent (m)."""
        return self.spans[0][0]

    @property
    def high(self) -> float:
        """Where it ends along its tangent (m)."""
        return self.spans[-1][1]

    def point(self, along: float) -> tuple[float, float]:
        """The plan point on the face at ``along`` metres of its tangent."""
        (nx, ny), (tx, ty) = self.normal, self.tangent
        return along * tx - self.offset * nx, along * ty - self.offset * ny


def vertical_faces(
    mesh: Mesh, config: PlanConfig, *, outward: bool = True, min_height: float = 0.0
) -> list[Face]:
    """The vertical faces of a closed mesh (metres), largest first, coplanar facets merged.

    Normals leave the body (walls), or point into it (rooms) when ``outward`` is false. Stretches of
    a face that are lower than ``min_height``, such as the strip above a niche, are faces of their
    own.
    """
    corners = mesh.vertices[mesh.faces]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    double = np.linalg.norm(cross, axis=1)
    flat = np.linalg.norm(cross[:, :2], axis=1)
    keep = (double > 1e-9) & (flat >= np.cos(config.face_tilt) * double)
    if not keep.any():
        return []
    normal = cross[keep, :2] / flat[keep, None]
    normal *= (1.0 if outward else -1.0) * _senses(mesh, corners, keep, normal)[:, None]
    corners, area = corners[keep], 0.5 * double[keep]
    groups = _coplanar(normal, corners, area, config)
    gap = config.coplanar_gap
    return [f for g in groups for f in _faces(normal[g], corners[g], area[g], gap, min_height)]


def _senses(mesh: Mesh, corners: Array, keep: NDArray[np.bool_], normal: Array) -> Array:
    """1 where a triangle's own normal leaves the body, -1 where it points into it.

    The sign of the volume tells, if all triangles wind the same way. If not, the side that lies in
    the body's shadow is the inside.
    """
    import shapely

    if is_consistent(mesh):
        return np.full(len(normal), -1.0 if _volume(corners) < 0.0 else 1.0)
    shadow = shapely.union_all(footprint(mesh))
    middle = corners[keep][:, :, :2].mean(axis=1)
    ahead, behind = (
        shapely.contains_xy(shadow, *(middle + side * PROBE * normal).T) for side in (1.0, -1.0)
    )
    return np.where(ahead & ~behind, -1.0, 1.0)


def _volume(corners: Array) -> float:
    local = corners - corners[0, 0]
    return float(np.einsum("ij,ij->", local[:, 0], np.cross(local[:, 1], local[:, 2])))


def _coplanar(
    normal: Array, corners: Array, area: Array, config: PlanConfig
) -> Iterator[NDArray[np.intp]]:
    """Groups of triangles, each gathered round the largest one left."""
    center = corners[:, :, :2].sum(axis=1) / 3.0
    free = np.ones(len(area), dtype=bool)
    for seed in np.argsort(-area, kind="stable"):
        if not free[seed]:
            continue
        near = free & (normal @ normal[seed] >= np.cos(config.coplanar_angle))
        near &= np.abs((center - center[seed]) @ normal[seed]) <= config.coplanar_offset
        free &= ~near
        yield np.flatnonzero(near)


def _faces(
    normal: Array, corners: Array, area: Array, gap: float, min_height: float
) -> Iterator[Face]:
    """The faces in one plane: pieces farther apart than ``gap`` are faces of their own."""
    mean = area @ normal
    n = mean / math.hypot(mean[0], mean[1])
    along = corners[:, :, :2] @ np.array([n[1], -n[0]])
    away = (corners[:, :, :2] @ n).sum(axis=1) / 3.0
    first, last = along.min(axis=1), along.max(axis=1)
    for low, high, bottom, top in _stretches(along, corners[:, :, 2], min_height):
        for start, end in merged(zip(low.tolist(), high.tolist(), strict=True), gap):
            mine = (low >= start) & (high <= end)
            weight = np.where((first < end - SHORT) & (last > start + SHORT), area, 0.0)
            if not weight.any():
                continue
            yield Face(
                normal=(float(n[0]), float(n[1])),
                offset=-float(weight @ away / weight.sum()),
                spans=merged(zip(low[mine].tolist(), high[mine].tolist(), strict=True)),
                bottom=float(bottom[mine].min()),
                top=float(top[mine].max()),
            )


def _stretches(
    along: Array, z: Array, min_height: float
) -> Iterator[tuple[Array, Array, Array, Array]]:
    """Begin, end, bottom and top of the stretches of a face: the high ones, then the low ones.

    Triangles given by their corners' places ``along`` (n, 3) and heights ``z`` (n, 3). A stretch is
    as high as what its triangles cover together on the highest upright through it (gables).
    """
    cuts = np.unique(np.round(along, 4))
    cuts = cuts[np.insert(np.diff(cuts) > SHORT, 0, True)]
    count = len(along)
    if min_height <= 0.0 or count <= 2 or len(cuts) < 3 or count * len(cuts) > MANY:
        yield along.min(axis=1), along.max(axis=1), z.min(axis=1), z.max(axis=1)
        return
    start, end = cuts[:-1], cuts[1:]
    inset = 0.1 * SHORT
    uprights = [_covered(along, z, at) for at in (start + inset, 0.5 * (start + end), end - inset)]
    heights = np.max([u[0] for u in uprights], axis=0)
    bottom = np.min([u[1] for u in uprights], axis=0)
    top = np.max([u[2] for u in uprights], axis=0)
    for chosen in (heights >= min_height, (heights > 0.0) & (heights < min_height)):
        if chosen.any():
            yield start[chosen], end[chosen], bottom[chosen], top[chosen]


def _covered(along: Array, z: Array, at: Array) -> tuple[Array, Array, Array]:
    """On the uprights ``at`` (m,): the height that triangles cover, its lowest and highest point.

    The lowest point is infinite, the highest minus that, where no triangle meets the upright.
    """
    u0, u1 = along[:, :, None], np.roll(along, -1, axis=1)[:, :, None]
    z0, z1 = z[:, :, None], np.roll(z, -1, axis=1)[:, :, None]
    crosses = (np.minimum(u0, u1) <= at) & (at <= np.maximum(u0, u1)) & (u0 != u1)
    share = (at - u0) / np.where(u0 == u1, 1.0, u1 - u0)
    met = np.where(crosses, z0 + share * (z1 - z0), np.nan)
    hit = crosses.any(axis=1)
    low = np.where(hit, np.min(met, axis=1, initial=np.inf, where=crosses), np.inf)
    high = np.where(hit, np.max(met, axis=1, initial=-np.inf, where=crosses), -np.inf)
    order = np.argsort(low, axis=0)
    low, high = np.take_along_axis(low, order, axis=0), np.take_along_axis(high, order, axis=0)
    reached = np.maximum.accumulate(high, axis=0)
    before = np.vstack([np.full((1, len(at)), -np.inf), reached[:-1]])
    new = np.where(np.isfinite(low), high - np.maximum(low, before), 0.0)
    return np.maximum(new, 0.0).sum(axis=0), low[0], reached[-1]


def merged(spans: Iterable[Span], gap: float = 1e-3) -> tuple[Span, ...]:
    """Sorted intervals with those that overlap, or lie within ``gap`` metres, made one."""
    out: list[Span] = []
    for low, high in sorted(spans):
        if out and low <= out[-1][1] + gap:
            out[-1] = (out[-1][0], max(out[-1][1], high))
        else:
            out.append((low, high))
    return tuple(out)
