"""Triangles with a part number: what beams hit and what the camera sees."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from situgraph.geometry.poses import Array, rotation2

Float32 = NDArray[np.float32]

# The six faces of a cube of side 2: corners counter-clockwise from outside.
_CUBE = np.array(
    [
        [[-1, -1, -1], [-1, 1, -1], [1, 1, -1], [1, -1, -1]],
        [[-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]],
        [[-1, -1, -1], [1, -1, -1], [1, -1, 1], [-1, -1, 1]],
        [[1, 1, -1], [-1, 1, -1], [-1, 1, 1], [1, 1, 1]],
        [[-1, 1, -1], [-1, -1, -1], [-1, -1, 1], [-1, 1, 1]],
        [[1, -1, -1], [1, 1, -1], [1, 1, 1], [1, -1, 1]],
    ],
    dtype=float,
)
_CUBE_AXES = ((1, 0), (0, 1), (0, 2), (0, 2), (1, 2), (1, 2))  # texture axes of each face


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles, counter-clockwise from outside.

    ``corners`` (m, 3, 3) metres, ``uv`` (m, 3, 2) texture coordinates in metres along the surface,
    ``part`` (m,) number of the world's part each one belongs to.
    """

    corners: Array
    uv: Array
    part: NDArray[np.int32]

    @property
    def normals(self) -> Array:
        """Outward unit normals (m, 3)."""
        a, b, c = np.moveaxis(self.corners, 1, 0)
        n = np.cross(b - a, c - a)
        return np.asarray(n / np.maximum(np.linalg.norm(n, axis=1, keepdims=True), 1e-12))

    def where(self, keep: NDArray[np.bool_]) -> Mesh:
        """Only the triangles where ``keep`` (m,) is true."""
        return Mesh(self.corners[keep], self.uv[keep], self.part[keep])


class MeshBuilder:
    """Collects surfaces and gives the mesh of them all."""

    def __init__(self) -> None:
        self._corners: list[Array] = []
        self._uv: list[Array] = []
        self._part: list[NDArray[np.int32]] = []

    def triangles(self, corners: ArrayLike, uv: ArrayLike, part: int) -> None:
        """Add triangles (m, 3, 3) with texture coordinates (m, 3, 2)."""
        c = np.asarray(corners, dtype=float).reshape(-1, 3, 3)
        self._corners.append(c)
        self._uv.append(np.asarray(uv, dtype=float).reshape(-1, 3, 2))
        self._part.append(np.full(len(c), part, dtype=np.int32))

    def quads(self, corners: ArrayLike, uv: ArrayLike, part: int) -> None:
        """Add quads (m, 4, 3) with texture coordinates (m, 4, 2)."""
        c = np.asarray(corners, dtype=float).reshape(-1, 4, 3)
        t = np.asarray(uv, dtype=float).reshape(-1, 4, 2)
        order = [0, 1, 2, 0, 2, 3]
        self.triangles(c[:, order], t[:, order], part)

    def upright(self, start: ArrayLike, end: ArrayLike, low: float, high: float, part: int) -> None:
        """Add a vertical quad over the plan-view segment; its normal is to the segment's right."""
        a, b = np.asarray(start, dtype=float), np.asarray(end, dtype=float)
        corners = [[*a, low], [*b, low], [*b, high], [*a, high]]
        # Texture runs along the world, so that neighbouring faces of one wall go on without a seam.
        along = (b - a) / max(float(np.linalg.norm(b - a)), 1e-12)
        u0, u1 = float(a @ along), float(b @ along)
        self.quads(corners, [[u0, low], [u1, low], [u1, high], [u0, high]], part)

    def level(self, polygon: object, height: float, part: int, *, up: bool) -> None:
        """Add a horizontal surface: a shapely polygon (holes and parts allowed) at a height."""
        for triangle in _triangulated(polygon):
            xy = triangle if up else triangle[::-1]
            corners = np.concatenate([xy, np.full((3, 1), height)], axis=1)
            self.triangles(corners, xy, part)

    def prism(self, polygon: object, low: float, high: float, part: int) -> None:
        """Add the solid over a shapely polygon between two heights."""
        for start, end in edges(polygon):
            self.upright(start, end, low, high, part)
        self.level(polygon, high, part, up=True)
        self.level(polygon, low, part, up=False)

    def box(self, center: ArrayLike, half: ArrayLike, yaw: float, part: int) -> None:
        """Add a box: half sizes (3,) along its own axes, turned by ``yaw`` about z."""
        size = np.asarray(half, dtype=float)
        local = _CUBE * size
        uv = np.stack([local[i][:, axes] for i, axes in enumerate(_CUBE_AXES)])
        turned = local.copy()
        turned[..., :2] = local[..., :2] @ rotation2(yaw).T
        self.quads(turned + np.asarray(center, dtype=float), uv + 10.0, part)

    def cylinder(
        self, center: ArrayLike, radius: float, half_height: float, part: int, sides: int = 16
    ) -> None:
        """Add an upright cylinder."""
        c = np.asarray(center, dtype=float)
        angle = np.linspace(0, 2 * np.pi, sides, endpoint=False)
        ring = c[:2] + radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        low, high = c[2] - half_height, c[2] + half_height
        for i in range(sides):
            self.upright(ring[i], ring[(i + 1) % sides], low, high, part)
            pair = np.stack([ring[i], ring[(i + 1) % sides]])
            top = np.concatenate([np.vstack([c[:2], pair]), np.full((3, 1), high)], axis=1)
            self.triangles(top, top[:, :2], part)
            bottom = np.concatenate([np.vstack([c[:2], pair[::-1]]), np.full((3, 1), low)], axis=1)
            self.triangles(bottom, bottom[:, :2], part)

    def mesh(self) -> Mesh:
        """Everything added so far, slivers left out."""
        corners = np.concatenate([np.zeros((0, 3, 3)), *self._corners])
        a, b, c = np.moveaxis(corners, 1, 0)
        keep = np.linalg.norm(np.cross(b - a, c - a), axis=1) > 1e-8
        uv = np.concatenate([np.zeros((0, 3, 2)), *self._uv])
        part = np.concatenate([np.zeros(0, dtype=np.int32), *self._part])
        return Mesh(corners[keep], uv[keep], part[keep])


def edges(polygon: object) -> list[tuple[Array, Array]]:
    """The boundary segments of a shapely polygon, its inside on their left, in metres."""
    import shapely

    found: list[tuple[Array, Array]] = []
    for part in polygons(polygon):
        whole = shapely.geometry.polygon.orient(part)
        for ring in (whole.exterior, *whole.interiors):
            xy = np.asarray(ring.coords)[:, :2]
            found.extend((xy[i], xy[i + 1]) for i in range(len(xy) - 1))
    return found


def polygons(geometry: object) -> list[object]:
    """The polygons in any shapely geometry; points and lines in it are left out."""
    import shapely

    return [
        part
        for part in shapely.get_parts(shapely.get_parts(geometry))
        if part.geom_type == "Polygon" and part.area > 1e-8
    ]


def _triangulated(polygon: object) -> list[Array]:
    """Counter-clockwise triangles (3, 2) that fill a shapely polygon."""
    import shapely

    found = []
    for part in polygons(polygon):
        for triangle in shapely.get_parts(shapely.constrained_delaunay_triangles(part)):
            xy = np.asarray(triangle.exterior.coords)[:3, :2]
            (ax, ay), (bx, by) = xy[1] - xy[0], xy[2] - xy[0]
            found.append(xy if ax * by - ay * bx > 0 else xy[::-1])
    return found
