"""Wall bodies between faces.

Where the faces of two rooms lie back to back, the body between them is filled; so are the corners
where such walls meet (a morphological closing of the rooms). A wall of which only one face is known
gets a band of nominal thickness behind it. Virtual faces have no wall; openings are cut out.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import msgspec
import numpy as np

from situgraph.geometry.poses import Array
from situgraph.view.config import ViewConfig
from situgraph.view.faces import Faces
from situgraph.view.openings import Opening

if TYPE_CHECKING:
    from shapely.geometry.base import BaseGeometry

_SLIVER = 0.015  # m, thinner pieces are noise of nearly parallel faces
_BACK_TO_BACK = -0.97  # cosine between the normals of the two faces of a wall


class Walls(msgspec.Struct, frozen=True):
    """Polygons in the plan, exteriors and holes as (n, 2) arrays, and what is seen of the faces.

    ``loose`` are the planes of no room that no wall body explains.
    """

    solid: tuple[tuple[Array, ...], ...] = ()
    one_face: tuple[tuple[Array, ...], ...] = ()
    edges: tuple[Array, ...] = ()
    loose: tuple[str, ...] = ()


def wall_bodies(
    polygons: Sequence[Array], faces: Faces, openings: Iterable[Opening], config: ViewConfig
) -> Walls:
    """The walls around room ``polygons``, with ``openings`` cut out."""
    import shapely

    rooms = _union([_sound(p) for p in polygons])
    half = 0.5 * config.wall_gap
    closed = rooms.buffer(half, join_style="mitre", mitre_limit=2.0)
    closed = shapely.union(closed.buffer(-half, join_style="mitre", mitre_limit=2.0), rooms)
    holes = _union([shapely.polygons(o.outline(0.5 * config.wall_gap)) for o in openings])
    cut = shapely.union(holes, _union(_behind(faces.only(faces.virtual), config.wall_gap)))
    real = faces.only(~faces.virtual)
    pairs = _union(_between(faces.only(~faces.infinite & ~faces.virtual), config.wall_gap))
    solid = shapely.difference(shapely.difference(shapely.union(closed, pairs), rooms), cut)
    lines = shapely.linestrings(real.only(real.in_room).segments)
    band = _union(list(shapely.buffer(lines, config.one_face_thickness, cap_style="square")))
    band = shapely.difference(shapely.difference(band, shapely.union(closed, pairs)), cut)
    seen = shapely.difference(shapely.multilinestrings(lines), holes)
    edges = tuple(shapely.get_coordinates(part) for part in shapely.get_parts(seen))
    loose = _uncovered(real.only(~real.in_room & ~real.infinite), pairs)
    return Walls(_rings(_without_slivers(solid)), _rings(_without_slivers(band)), edges, loose)


def _sound(polygon: Array) -> BaseGeometry:
    """The polygon as a valid geometry, whatever a model calls a footprint."""
    import shapely

    shape = shapely.polygons(polygon)
    return shape if shape.is_valid else shape.buffer(0)


def _union(shapes: Sequence[BaseGeometry]) -> BaseGeometry:
    import shapely

    return shapely.union_all(np.array(shapes, dtype=object)) if len(shapes) else shapely.Polygon()


def _behind(faces: Faces, depth: float) -> list[BaseGeometry]:
    """The strips behind faces: what would be wall if they were real."""
    import shapely

    a, b = faces.segments[:, 0], faces.segments[:, 1]
    back = depth * faces.normals
    return list(shapely.polygons(np.stack([a, b, b - back, a - back], axis=1)))


def _between(faces: Faces, gap: float) -> list[BaseGeometry]:
    """Bodies between faces that bound no room and whatever stands back to back with them."""
    import shapely

    free = np.flatnonzero(~faces.in_room)
    if not len(free):
        return []
    lines = shapely.linestrings(faces.segments)
    first, second = shapely.STRtree(lines).query(lines[free], predicate="dwithin", distance=gap)
    bodies = []
    for i, j in zip(free[first], second):
        n, (a, b) = faces.normals[i], faces.segments[i]
        thickness = float((a - faces.segments[j].mean(axis=0)) @ n)
        if i == j or faces.normals[j] @ n > _BACK_TO_BACK or not 0.02 < thickness <= gap:
            continue
        along = (b - a) / max(float(np.linalg.norm(b - a)), 1e-9)
        ends = np.sort((faces.segments[j] - a) @ along)
        start = max(0.0, ends[0] - thickness)
        end = min(float(np.linalg.norm(b - a)), ends[1] + thickness)
        if end - start > 0.1:
            p, q = a + start * along, a + end * along
            bodies.append(shapely.polygons([p, q, q - thickness * n, p - thickness * n]))
    return bodies


def _uncovered(faces: Faces, bodies: BaseGeometry) -> tuple[str, ...]:
    """The faces that lie along no body for half of their length."""
    import shapely

    lines = shapely.linestrings(faces.segments)
    rest = shapely.length(shapely.difference(lines, bodies.buffer(0.02)))
    return tuple(
        i for i, part, all in zip(faces.ids, rest, shapely.length(lines)) if part > all / 2
    )


def _without_slivers(shape: BaseGeometry) -> BaseGeometry:
    opened = shape.buffer(-_SLIVER, join_style="mitre").buffer(_SLIVER, join_style="mitre")
    return opened.simplify(0.002)


def _rings(shape: BaseGeometry) -> tuple[tuple[Array, ...], ...]:
    """Exteriors counter-clockwise and holes clockwise, so that any fill rule leaves holes open."""
    import shapely
    from shapely.geometry.polygon import orient

    parts = [p for p in shapely.get_parts(shape) if p.geom_type == "Polygon" and not p.is_empty]
    found = []
    for part in (orient(p) for p in parts):
        found.append(tuple(np.array(r.coords) for r in (part.exterior, *part.interiors)))
    return tuple(found)
