"""The plan-view shadow of a body."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from situgraph.plan.building import Mesh

if TYPE_CHECKING:
    from shapely import MultiPolygon, Polygon

SNAP = 1e-3  # m; corners nearer than this are one corner of an outline
CRUMB = 0.01  # m2; smaller polygons come from rounding, not from a floor


def footprint(mesh: Mesh) -> list[Polygon]:
    """The plan-view shadow of a body: disjoint polygons, counter-clockwise, largest first.

    The faces that look down cast the whole shadow. In a body that does not close, or whose
    triangles wind both ways, all faces are taken.
    """
    import shapely

    corners = mesh.vertices[mesh.faces][:, :, :2]
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    double = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    seen = np.abs(double) > 1e-9
    if not seen.any():
        return []
    chosen = seen & (double < 0.0) if is_consistent(mesh) else seen
    triangles = shapely.make_valid(shapely.polygons(corners[chosen]))
    union = shapely.union_all(triangles, grid_size=1e-6)
    # Closing by a millimetre heals seams between triangles that do not quite share an edge.
    healed = union.buffer(SNAP, join_style="mitre").buffer(-SNAP, join_style="mitre")
    return polygons(healed.simplify(SNAP))


def is_consistent(mesh: Mesh) -> bool:
    """Whether the body closes and all its triangles wind the same way.

    Then each edge is walked as often in one direction as in the other. Corners are told apart by
    their place, to a tenth of a millimetre, because bodies often repeat them.
    """
    _, number = np.unique(np.round(mesh.vertices, 4), axis=0, return_inverse=True)
    faces = number.reshape(-1)[mesh.faces]
    start, end = faces.reshape(-1), np.roll(faces, -1, axis=1).reshape(-1)
    count = int(faces.max()) + 1
    low, high = np.minimum(start, end), np.maximum(start, end)
    _, edge = np.unique(low * count + high, return_inverse=True)
    balance = np.bincount(edge, weights=np.sign(end - start))
    return not balance.any()


def polygons(shape: Polygon | MultiPolygon) -> list[Polygon]:
    """The polygons of a shape, counter-clockwise, largest first, crumbs left out."""
    from shapely import Polygon
    from shapely.geometry.polygon import orient

    parts = [p for p in getattr(shape, "geoms", [shape]) if isinstance(p, Polygon)]
    parts = sorted((p for p in parts if p.area > CRUMB), key=lambda p: (-p.area, p.bounds))
    return [orient(p.normalize(), 1.0) for p in parts]
