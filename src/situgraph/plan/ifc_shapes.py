"""Bodies of IFC products as triangles, in metres and building coordinates.

The ``manifold`` kernel is ten times faster than OpenCascade and leaves some shapes out: clipped
bodies come unclipped or as the wrong half, some profiles come empty. Those, and only those, are
made by OpenCascade, which needs a tenth of a second for a roof of many planes.
"""

from __future__ import annotations

import math
from collections.abc import Container, Iterable, Iterator
from typing import Any, Literal

import numpy as np

from situgraph.geometry.poses import Array
from situgraph.plan.building import Mesh
from situgraph.plan.ifc_links import has_body, many, one

Kernel = Literal["manifold", "opencascade"]
MAX_DEPTH = 20  # nested mapped items looked through before a body counts as clipped


class _Body:
    """Triangles before the building's offset is known: local vertices and where they go."""

    def __init__(self, vertices: Array, faces: Any, matrix: Array) -> None:
        self.vertices, self.faces, self.matrix = vertices, faces, matrix

    def mesh(self, offset: Array) -> Mesh:
        """In building coordinates less ``offset``, which goes first so that no digits are lost."""
        turn, shift = self.matrix[:3, :3], self.matrix[:3, 3] - offset
        return Mesh(self.vertices @ turn.T + shift, self.faces)


def read_shapes(
    model: Any, products: Iterable[Any], far: float, uncut: Container[int] = ()
) -> tuple[dict[int, Mesh], Array]:
    """Meshes by entity number, and the offset (3,) that was taken off their coordinates.

    Products whose number is in ``uncut`` are taken as they were before any clipping.

    Openings are not cut out of walls: doors and windows are placed by the openings themselves.
    The offset is zero unless the building stands more than ``far`` metres from the origin; it is
    whole metres, so that adding it gives the file's coordinates back.
    """
    wanted = {p.id(): p for p in products if has_body(p)}
    clipped = {i for i, p in wanted.items() if _is_clipped(p)}
    bodies = dict(_bodies(model, [p for i, p in wanted.items() if i not in clipped], "manifold"))
    rest = [p for i, p in wanted.items() if i not in bodies]
    whole = [p for p in rest if p.id() in uncut]
    bodies.update(_bodies(model, whole, "opencascade", cut=False))
    rest = [p for p in rest if p.id() not in bodies]
    bodies.update(_bodies(model, rest, "opencascade"))
    offset = _offset(bodies.values(), far)
    return {i: bodies[i].mesh(offset) for i in wanted if i in bodies}, offset


def _bodies(
    model: Any, products: list[Any], kernel: Kernel, cut: bool = True
) -> Iterator[tuple[int, _Body]]:
    if not products:
        return
    from ifcopenshell import geom

    settings: Any = geom.settings()  # type: ignore[no-untyped-call]
    settings.set("disable-opening-subtractions", True)
    settings.set("disable-boolean-result", not cut)
    iterator: Any = geom.iterator(settings, model, 1, include=products, geometry_library=kernel)
    seen: dict[int, int] = {}
    if not iterator.initialize():
        return
    while True:
        shape = iterator.get()
        vertices = np.frombuffer(shape.geometry.verts_buffer, dtype=float).reshape(-1, 3).copy()
        faces = np.frombuffer(shape.geometry.faces_buffer, dtype=np.int32).reshape(-1, 3)
        # a product may come once a representation: the most detailed body counts
        if len(faces) > seen.get(shape.id, 0) and np.isfinite(vertices).all():
            seen[shape.id] = len(faces)
            matrix = np.array(shape.transformation.matrix, dtype=float).reshape(4, 4, order="F")
            yield shape.id, _Body(vertices, faces.astype(np.int64), matrix)
        if not iterator.next():
            return


def _offset(bodies: Iterable[_Body], far: float) -> Array:
    centers = [b.matrix[:3, :3] @ b.vertices.mean(axis=0) + b.matrix[:3, 3] for b in bodies]
    if not centers:
        return np.zeros(3)
    middle = np.round(np.median(np.array(centers), axis=0))
    if math.hypot(middle[0], middle[1]) <= far:
        middle[:2] = 0.0
    if abs(middle[2]) <= far:
        middle[2] = 0.0
    return np.asarray(middle, dtype=float)


def _is_clipped(product: Any) -> bool:
    """Whether a body of the product is the result of a boolean operation."""
    for representation in many(one(product, "Representation"), "Representations"):
        kind = getattr(representation, "RepresentationIdentifier", None)
        if kind in ("Axis", "Box", "FootPrint", "Annotation"):
            continue
        if any(_has_boolean(item, MAX_DEPTH) for item in many(representation, "Items")):
            return True
    return False


def _has_boolean(item: Any, depth: int) -> bool:
    if depth == 0 or item.is_a("IfcBooleanResult"):
        return True
    if item.is_a("IfcMappedItem"):
        mapped = one(one(item, "MappingSource"), "MappedRepresentation")
        return any(_has_boolean(i, depth - 1) for i in many(mapped, "Items"))
    return False
