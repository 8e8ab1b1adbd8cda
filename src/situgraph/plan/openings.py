"""Where doors, windows and bare openings are: an upright box each, from the hole it stands in."""

from __future__ import annotations

import math

import msgspec
import numpy as np

from situgraph.geometry.poses import Array
from situgraph.plan.backing import WallFaces
from situgraph.plan.building import Filling, Mesh

NEAR = 1.0  # m; faces of the host farther from the hole than this say nothing about it


class Box(msgspec.Struct, frozen=True):
    """An upright box: ``center`` (m), unit ``across`` (through the wall) and half sizes.

    ``half`` is (half width along the wall, half depth through it, half height). The width runs
    along ``(across_y, -across_x)``.
    """

    center: tuple[float, float, float]
    across: tuple[float, float]
    half: tuple[float, float, float]

    @property
    def along(self) -> tuple[float, float]:
        """The direction of its width."""
        return self.across[1], -self.across[0]

    @property
    def bottom(self) -> float:
        """Its lowest height (m)."""
        return self.center[2] - self.half[2]

    @property
    def top(self) -> float:
        """Its highest height (m)."""
        return self.center[2] + self.half[2]

    @property
    def yaw(self) -> float:
        """The angle of its width against x (rad)."""
        return math.atan2(self.along[1], self.along[0])

    def depth_within(self, low: float, high: float) -> Box:
        """The same box, from ``low`` to ``high`` metres across, measured from the origin."""
        (ax, ay), (x, y, z) = self.across, self.center
        shift = 0.5 * (low + high) - (ax * x + ay * y)
        half = (self.half[0], 0.5 * (high - low), self.half[2])
        return Box((x + shift * ax, y + shift * ay, z), self.across, half)


def filling_box(filling: Filling, walls: WallFaces) -> Box:
    """The box of a door, window or opening, cut to the thickness of the wall it is in."""
    host = walls.rows(np.flatnonzero(walls.key == filling.host))
    points = filling.mesh.vertices[:, :2]
    across = _across(points, host)
    if across is None:
        across = _stated_across(filling) or _short_side(points)
    box = oriented_box(filling.mesh, across)
    return _cut_to_wall(box, host)


def _stated_across(filling: Filling) -> tuple[float, float] | None:
    """The direction its placement states, unless the body is deeper than wide in it."""
    if filling.across is None:
        return None
    half = oriented_box(filling.mesh, filling.across).half
    return filling.across if half[1] <= half[0] else None


def oriented_box(mesh: Mesh, across: tuple[float, float]) -> Box:
    """The box round a mesh with its depth along the unit vector ``across``."""
    n = np.array(across)
    t = np.array([n[1], -n[0]])
    xy, z = mesh.vertices[:, :2], mesh.vertices[:, 2]
    u, v = xy @ t, xy @ n
    center = 0.5 * (u.min() + u.max()) * t + 0.5 * (v.min() + v.max()) * n
    return Box(
        (float(center[0]), float(center[1]), float(0.5 * (z.min() + z.max()))),
        across,
        (float(0.5 * np.ptp(u)), float(0.5 * np.ptp(v)), float(0.5 * np.ptp(z))),
    )


def extent_box(mesh: Mesh) -> Box:
    """The smallest upright box round a mesh, its width the longer side."""
    return oriented_box(mesh, _short_side(mesh.vertices[:, :2]))


def _across(points: Array, host: WallFaces) -> tuple[float, float] | None:
    """The normal of the host's face that carries most of the hole; None without such a face."""
    if not len(host.key):
        return None
    n = host.normal
    t = np.stack([n[:, 1], -n[:, 0]], axis=1)
    along = np.sort(np.einsum("rej,rj->re", host.ends, t), axis=1)
    u = points @ t.T
    overlap = np.minimum(u.max(axis=0), along[:, 1]) - np.maximum(u.min(axis=0), along[:, 0])
    distance = np.abs(points.mean(axis=0) @ n.T - np.einsum("rj,rj->r", host.ends[:, 0], n))
    score = np.where(distance <= NEAR, overlap, -1.0)
    best = int(np.argmax(score))
    if score[best] <= 0.0:
        return None
    return float(n[best, 0]), float(n[best, 1])


def _short_side(points: Array) -> tuple[float, float]:
    """The direction of the short side of the smallest rectangle round plan points.

    The smallest rectangle has a side along an edge of the convex hull (Freeman and Shapira, 1975).
    """
    import shapely

    hull = shapely.convex_hull(shapely.multipoints(points))
    corners = shapely.get_coordinates(hull)
    edges = np.diff(corners, axis=0)
    lengths = np.linalg.norm(edges, axis=1)
    edges = edges[lengths > 1e-9] / lengths[lengths > 1e-9, None]
    if not len(edges):
        return 0.0, 1.0
    normals = np.stack([-edges[:, 1], edges[:, 0]], axis=1)
    width, depth = np.ptp(corners @ edges.T, axis=0), np.ptp(corners @ normals.T, axis=0)
    best = int(np.argmin(np.round(width * depth, 9)))
    chosen = normals[best] if depth[best] <= width[best] else edges[best]
    return float(chosen[0]), float(chosen[1])


def _cut_to_wall(box: Box, host: WallFaces) -> Box:
    """Holes are often cut deeper than the wall is thick: keep what lies between its faces."""
    n, t = np.array(box.across), np.array(box.along)
    middle = np.array(box.center[:2])
    along = np.sort(host.ends @ t, axis=1) - middle @ t
    beside = (
        (np.abs(host.normal @ n) > 0.99)
        & (along[:, 1] > -box.half[0])
        & (along[:, 0] < box.half[0])
    )
    position = host.ends[beside].mean(axis=1) @ n
    position = position[np.abs(position - middle @ n) <= box.half[1] + NEAR]
    if len(position) < 2:
        return box
    low = max(float(position.min()), float(middle @ n) - box.half[1])
    high = min(float(position.max()), float(middle @ n) + box.half[1])
    return box.depth_within(low, high) if high - low > 0.01 else box
