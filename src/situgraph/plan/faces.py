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

PROBE = 0.01  # m; how far beside a face its two sides are looked at


class Face(msgspec.Struct, frozen=True):
    """A vertical face: unit ``normal`` (2,) and ``offset`` with ``n.x + d = 0`` in the plan.

    ``spans`` are the stretches it covers along its tangent ``(n_y, -n_x)`` (m), ``bottom`` and
    ``top`` its heights (m), ``area`` in square metres.
    """

    normal: tuple[float, float]
    offset: float
    spans: tuple[Span, ...]
    bottom: float
    top: float
    area: float

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

    def reversed(self) -> Face:
        """The same face seen from its other side."""
        nx, ny = self.normal
        spans = tuple((-hi, -lo) for lo, hi in reversed(self.spans))
        return msgspec.structs.replace(self, normal=(-nx, -ny), offset=-self.offset, spans=spans)


def vertical_faces(mesh: Mesh, config: PlanConfig, *, outward: bool = True) -> list[Face]:
    """The vertical faces of a closed mesh (metres), largest first, coplanar facets merged.

    Normals leave the body (walls), or point into it (rooms) when ``outward`` is false.
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
    return [f for g in groups for f in _faces(normal[g], corners[g], area[g], config.coplanar_gap)]


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


def _faces(normal: Array, corners: Array, area: Array, gap: float) -> Iterator[Face]:
    """The faces in one plane: pieces farther apart than ``gap`` are faces of their own."""
    mean = area @ normal
    n = mean / math.hypot(mean[0], mean[1])
    along = corners[:, :, :2] @ np.array([n[1], -n[0]])
    low, high = along.min(axis=1), along.max(axis=1)
    away = (corners[:, :, :2] @ n).sum(axis=1) / 3.0
    bottom, top = corners[:, :, 2].min(axis=1), corners[:, :, 2].max(axis=1)
    for start, end in merged(zip(low.tolist(), high.tolist(), strict=True), gap):
        mine = (low >= start) & (high <= end)
        weight = area[mine]
        size = float(weight.sum())
        yield Face(
            normal=(float(n[0]), float(n[1])),
            offset=-float(weight @ away[mine]) / size,
            spans=merged(zip(low[mine].tolist(), high[mine].tolist(), strict=True)),
            bottom=float(bottom[mine].min()),
            top=float(top[mine].max()),
            area=size,
        )


def merged(spans: Iterable[Span], gap: float = 1e-3) -> tuple[Span, ...]:
    """Sorted intervals with those that overlap, or lie within ``gap`` metres, made one."""
    out: list[Span] = []
    for low, high in sorted(spans):
        if out and low <= out[-1][1] + gap:
            out[-1] = (out[-1][0], max(out[-1][1], high))
        else:
            out.append((low, high))
    return tuple(out)
