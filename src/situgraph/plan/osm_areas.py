"""The rooms and storeys of an indoor OSM map."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import msgspec
import numpy as np

from situgraph.plan.building import Element
from situgraph.plan.config import PlanConfig
from situgraph.plan.derived import NO_BODY, ring_faces
from situgraph.plan.osm_file import OsmMap, Way
from situgraph.plan.outlines import polygons
from situgraph.plan.rooms import RoomShape, in_order
from situgraph.scenegraph.graph import Storey, Warning

if TYPE_CHECKING:
    from shapely import Polygon

STOREY_HEIGHT = 3.0  # m, where no area states one
INNER = 0.9  # an area with this share inside another on its level lies in it


class Areas(msgspec.Struct, frozen=True):
    """Rooms from the lowest storey up, in file order on each: way, level, shape; and storeys."""

    ways: tuple[Way, ...]
    levels: tuple[float, ...]
    shapes: tuple[RoomShape, ...]
    storeys: dict[float, Storey]
    warnings: tuple[Warning, ...]


def find_areas(source: OsmMap, config: PlanConfig) -> Areas:
    """The areas that are rooms, less smaller rooms inside them; structures are left out."""
    rooms = [way for way in source.ways if _is_room(way)]
    outlines = {way.id: _outline(way, config) for way in rooms}
    kept = [way for way in rooms if outlines[way.id] is not None]
    kept.sort(key=_level_or_zero)
    levels = [_level_or_zero(way) for way in kept]
    storeys = _storeys(kept, levels)
    whole = [o for way in kept if (o := outlines[way.id]) is not None]
    shapes = []
    for number, outline in enumerate(_without_inner(whole, levels)):
        shapes.append(_shape(number, kept[number], outline, storeys[levels[number]], config))
    return Areas(
        tuple(kept), tuple(levels), tuple(shapes), storeys, tuple(_warnings(rooms, kept, shapes))
    )


def level_of(way: Way) -> float | None:
    """The level of a way, or the lowest of several such as ``1;2``; None where it names none."""
    try:
        found = min(float(part) for part in way.tags.get("level", "").split(";"))
    except ValueError:
        return None
    return found if abs(found) < 1000.0 else None


def _level_or_zero(way: Way) -> float:
    return level_of(way) or 0.0


def _is_room(way: Way) -> bool:
    if "osmAG:type" in way.tags:
        return way.tags["osmAG:type"] == "area" and way.tags.get("osmAG:areaType") == "room"
    return way.tags.get("indoor") in ("room", "corridor")


def _outline(way: Way, config: PlanConfig) -> Polygon | None:
    import shapely

    if len(set(way.points)) < 3:
        return None
    # A ring that crosses itself becomes its parts; the largest is the room.
    valid = shapely.make_valid(shapely.Polygon(way.points))
    parts = polygons(valid.simplify(config.coplanar_offset))
    return parts[0] if parts else None


def _without_inner(outlines: Sequence[Polygon], levels: Sequence[float]) -> Iterator[Polygon]:
    from shapely import STRtree

    tree = STRtree(list(outlines))
    for number, outline in enumerate(outlines):
        rest = outline
        for other in sorted(int(i) for i in tree.query(outline, predicate="intersects")):
            inner = outlines[other]
            if other == number or levels[other] != levels[number] or inner.area >= outline.area:
                continue
            if outline.intersection(inner).area > INNER * inner.area:
                rest = rest.difference(inner)
        parts = polygons(rest)
        yield parts[0] if parts else outline


def _storeys(ways: Sequence[Way], levels: Sequence[float]) -> dict[float, Storey]:
    """Storeys by level, the lowest at zero, each as high as most of its areas say."""
    out: dict[float, Storey] = {}
    elevation = 0.0
    for number, level in enumerate(sorted(set(levels))):
        stated = [_height(w) for w, its in zip(ways, levels, strict=True) if its == level]
        heights = [h for h in stated if h is not None]
        height = float(np.median(heights)) if heights else STOREY_HEIGHT
        out[level] = Storey(f"s{number}", f"{level:g}", elevation, height)
        elevation += height
    return out


def _height(way: Way) -> float | None:
    try:
        height = float(way.tags["height"])
    except (KeyError, ValueError):
        return None
    return height if 1.0 < height < 100.0 else None


def _shape(
    number: int, way: Way, outline: Polygon, storey: Storey, config: PlanConfig
) -> RoomShape:
    bottom, top = storey.elevation, storey.elevation + (storey.height or STOREY_HEIGHT)
    rings = (outline.exterior, *outline.interiors)
    found = [f for ring in rings for f in ring_faces(np.array(ring.coords[:-1]), bottom, top)]
    kept = [f for f in found if f.length >= config.min_face_length]
    element = Element(number, way.id, "area", way.tags.get("name", way.id), NO_BODY)
    faces = tuple(in_order(kept, outline))
    return RoomShape(element, outline, faces, bottom, top, slivers=len(found) - len(kept))


def _warnings(
    rooms: Sequence[Way], kept: Sequence[Way], shapes: Sequence[RoomShape]
) -> Iterator[Warning]:
    used = {way.id for way in kept}
    lost = [way.id for way in rooms if way.id not in used]
    opened = [way.id for way in kept if way.points[0] != way.points[-1]]
    loose = [way.id for way in kept if level_of(way) is None]
    for ids, code, what in (
        (lost, "room-without-floor", "areas enclose no floor and are left out"),
        (opened, "ring-not-closed", "areas do not end where they begin and are closed"),
        (loose, "room-without-storey", "areas name no level and are put on level 0"),
    ):
        if ids:
            yield Warning(code, f"{len(ids)} {what}", tuple(ids))
    slivers = [i for i, shape in enumerate(shapes) if shape.slivers]
    if slivers:
        total = sum(shapes[i].slivers for i in slivers)
        message = f"{total} faces of {len(slivers)} rooms are slivers and left out"
        yield Warning("sliver-faces", message, tuple(f"r{i}" for i in slivers))
