"""Indoor OSM maps with areas and passages (osmAG) as A-Graphs.

osmAG (Feng et al., "osmAG: Hierarchical Semantic Topometric Area Graph Maps in the OSM Format for
Mobile Robotics", 2023) draws each room as a closed way and each door or opening as a segment that
names the two areas it joins.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from pathlib import Path

from situgraph.errors import InputError
from situgraph.plan.config import PlanConfig
from situgraph.plan.contents import ellipsoid
from situgraph.plan.digits import horizontal, metres, point2, point3
from situgraph.plan.faces import Face
from situgraph.plan.hosting import room_faces
from situgraph.plan.osm_areas import Areas, find_areas
from situgraph.plan.osm_doors import Passage, find_passages
from situgraph.plan.osm_file import read_ways
from situgraph.plan.rooms import RoomShape, center, ring
from situgraph.scenegraph.graph import Object, Plane, Room, Scalar, SceneGraph, Warning


def read_osm(path: str | os.PathLike[str], config: PlanConfig | None = None) -> SceneGraph:
    """The A-Graph of an indoor OSM map: rooms, their faces, doors with the rooms they join.

    The frame is x east, y north, in metres from the map's root node (an equirectangular projection
    on the WGS 84 ellipsoid at that node, whose position is in the graph's attributes). Storeys are
    stacked by the heights their areas state, the lowest at zero.

    Raises:
        InputError: as :func:`~situgraph.plan.osm_file.read_ways`, or no area is a room.
    """
    from situgraph.scenegraph.validation import validate

    settings = config or PlanConfig()
    source = read_ways(path, settings)
    areas = find_areas(source, settings)
    if not areas.shapes:
        raise InputError(path, "no area in it is a room", "tag rooms with indoor=room")
    passages = find_passages(source, areas, room_faces(areas.shapes), settings)
    planes, ids = _planes(areas.shapes)
    graph = SceneGraph(
        name=Path(path).stem,
        kind="prior",
        storeys=tuple(areas.storeys.values()),
        rooms=tuple(_room(n, areas, ids[n]) for n in range(len(areas.shapes))),
        planes=planes,
        objects=tuple(_door(n, p, ids, settings) for n, p in enumerate(passages)),
        warnings=(*areas.warnings, *_door_warnings(passages)),
        modelled_categories=("door",),
        attributes={"latitude": source.latitude, "longitude": source.longitude},
    )
    return validate(graph, path)


def _planes(shapes: Sequence[RoomShape]) -> tuple[tuple[Plane, ...], list[list[str]]]:
    planes: list[Plane] = []
    ids: list[list[str]] = []
    for shape in shapes:
        ids.append([f"p{len(planes) + k}" for k in range(len(shape.faces))])
        planes += [_plane(key, f, shape) for key, f in zip(ids[-1], shape.faces, strict=True)]
    return tuple(planes), ids


def _plane(key: str, face: Face, shape: RoomShape) -> Plane:
    return Plane(
        id=key,
        normal=horizontal(face.normal),
        offset=metres(face.offset),
        extent=(point2(face.point(face.low)), point2(face.point(face.high))),
        source=f"way {shape.element.guid}",
        attributes={"length": metres(face.length)},
    )


def _room(number: int, areas: Areas, planes: Sequence[str]) -> Room:
    way, shape = areas.ways[number], areas.shapes[number]
    attributes: dict[str, Scalar] = {"way": way.id, "area": metres(shape.outline.area)}
    if "osmAG:parent" in way.tags:
        attributes["parent"] = way.tags["osmAG:parent"]
    if shape.outline.interiors:
        attributes["holes"] = len(shape.outline.interiors)
    x, y = center(shape)
    return Room(
        id=f"r{number}",
        center=point3((x, y, 0.5 * (shape.bottom + shape.top))),
        planes=tuple(planes),
        storey=areas.storeys[areas.levels[number]].id,
        name=shape.element.name,
        footprint=ring(shape),
        attributes=attributes,
    )


def _door(
    number: int, passage: Passage, ids: Sequence[Sequence[str]], config: PlanConfig
) -> Object:
    # The map does not say whether a passage has a leaf.
    return Object(
        id=f"o{number}",
        category="door",
        center=point3(passage.box.center),
        ellipsoid=ellipsoid(passage.box, config.min_semi_axis),
        rooms=tuple(f"r{r}" for r in passage.rooms),
        planes=tuple(ids[room][face] for room, face in passage.faces),
        confidence=1.0,
        attributes={"way": passage.way.id, "leaf": None},
    )


def _door_warnings(passages: Sequence[Passage]) -> Iterator[Warning]:
    checks = (
        ("door-without-room", "are in no room", [not p.rooms for p in passages]),
        (
            "door-on-no-plane",
            "join a room none of whose faces runs along them",
            [bool(p.rooms) and len(p.faces) < len(p.rooms) for p in passages],
        ),
        (
            "unknown-area",
            "name an area that is not in the map; geometry tells the room",
            [bool(p.unknown) for p in passages],
        ),
    )
    for code, what, flags in checks:
        numbers = [n for n, flag in enumerate(flags) if flag]
        if numbers:
            ways = ", ".join(passages[n].way.id for n in numbers)
            message = f"{len(numbers)} passages {what}: {ways}"
            yield Warning(code, message, tuple(f"o{n}" for n in numbers))
