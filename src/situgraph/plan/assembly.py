"""From a building model to its A-Graph: the recipe, free of any file format."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from situgraph.plan.audit import Audit, audit, boundary_warnings, homeless
from situgraph.plan.backing import Backing, WallFaces, backing, wall_faces
from situgraph.plan.building import Building, Element
from situgraph.plan.config import PlanConfig
from situgraph.plan.contents import Placed, ellipsoid, find_contents
from situgraph.plan.derived import derive_rooms
from situgraph.plan.digits import horizontal, metres, point2, point3
from situgraph.plan.faces import Face
from situgraph.plan.rooms import RoomShape, center, overlaps, ring, room_shape
from situgraph.plan.storeys import Storeys, find_storeys
from situgraph.scenegraph.graph import Object, Plane, Room, Scalar, SceneGraph, Warning


def assemble(building: Building, config: PlanConfig) -> SceneGraph:
    """The A-Graph of a building, in the building frame less ``building.offset``.

    Rooms come from its spaces, or from its walls when it has none.
    """
    shapes, lost = _shapes(building.spaces, config)
    derived = not building.spaces
    if derived:
        shapes = derive_rooms(building, config)
    shapes, storeys = _by_storey(shapes, building, config)
    walls = wall_faces(building.walls, config)
    contents = find_contents(building, walls, shapes, config)
    placed = contents.placed
    # Boundaries name spaces; derived rooms are none.
    audited = audit({} if derived else building.boundaries, placed, shapes)
    planes, plane_ids = _planes(shapes, walls, building, config)
    rooms = tuple(_room(i, s, storeys, plane_ids[i], derived) for i, s in enumerate(shapes))
    objects = tuple(_object(i, p, plane_ids, audited, config) for i, p in enumerate(placed))
    warnings = [
        *building.warnings, *_far_away(building), *_derived(derived, shapes), *_floorless(lost),
        *storeys.warnings, *_odd_rooms(shapes), *contents.warnings,
        *homeless(placed), *boundary_warnings(audited, placed, shapes),
    ]  # fmt: skip
    offset = dict(zip(("offset_x", "offset_y", "offset_z"), building.offset, strict=True))
    attributes: dict[str, Scalar] = {**building.attributes, **audited.attributes()}
    if building.name:
        attributes["building"] = building.name
    return SceneGraph(
        kind="prior",
        storeys=storeys.storeys,
        rooms=rooms,
        planes=planes,
        objects=objects,
        warnings=tuple(warnings),
        modelled_categories=_modelled(building, placed),
        attributes={**attributes, **(offset if any(building.offset) else {})},
    )


def _modelled(building: Building, placed: Sequence[Placed]) -> tuple[str, ...]:
    """Doors and windows if the model has any, wherever they stand; else what stands in rooms."""
    stated = {f.category for f in building.fillings if f.category in ("door", "window")}
    return tuple(sorted(stated | {p.category for p in placed}))


def _shapes(spaces: Sequence[Element], config: PlanConfig) -> tuple[list[RoomShape], list[Element]]:
    shapes, lost = [], []
    for space in spaces:
        shape = room_shape(space, config)
        if shape is None:
            lost.append(space)
        else:
            shapes.append(shape)
    return shapes, lost


def _by_storey(
    shapes: list[RoomShape], building: Building, config: PlanConfig
) -> tuple[list[RoomShape], Storeys]:
    """Rooms from the lowest storey up, in file order on each, and their storeys."""
    first = find_storeys(building.levels, shapes, config)
    order = sorted(range(len(shapes)), key=lambda n: (first.of_room[n], n))
    shapes = [shapes[n] for n in order]
    return shapes, find_storeys(building.levels, shapes, config)


def _planes(
    shapes: Sequence[RoomShape], walls: WallFaces, building: Building, config: PlanConfig
) -> tuple[tuple[Plane, ...], list[list[str]]]:
    sources = {w.key: w.source for w in building.walls}
    planes: list[Plane] = []
    ids: list[list[str]] = []
    for shape in shapes:
        ids.append([])
        for face in shape.faces:
            behind = backing(face, walls, config)
            key = f"p{len(planes)}"
            planes.append(_plane(key, face, behind, sources, config))
            ids[-1].append(key)
    return tuple(planes), ids


def _plane(
    key: str, face: Face, behind: Backing, sources: dict[int, str], config: PlanConfig
) -> Plane:
    attributes: dict[str, Scalar] = {
        "backed": round(behind.share, 4),
        "length": metres(face.length),
        "bottom": metres(face.bottom),
        "top": metres(face.top),
    }
    if behind.gap is not None:
        attributes["gap"] = metres(behind.gap)
    return Plane(
        id=key,
        normal=horizontal(face.normal),
        offset=metres(face.offset),
        extent=(point2(face.point(face.low)), point2(face.point(face.high))),
        virtual=behind.share < config.virtual_share,
        source=None if behind.key is None else sources[behind.key],
        attributes=attributes,
    )


def _room(
    number: int, shape: RoomShape, storeys: Storeys, planes: Sequence[str], derived: bool
) -> Room:
    element = shape.element
    x, y = center(shape)
    attributes: dict[str, Scalar] = {
        **({"derived": True} if derived else {"guid": element.guid}),
        "area": metres(shape.outline.area),
        "bottom": metres(shape.bottom),
        "height": metres(shape.top - shape.bottom),
    }
    if element.long_name:
        attributes["long_name"] = element.long_name
    if shape.outline.interiors:
        attributes["holes"] = len(shape.outline.interiors)
    return Room(
        id=f"r{number}",
        center=point3((x, y, 0.5 * (shape.bottom + shape.top))),
        planes=tuple(planes),
        storey=f"s{storeys.of_room[number]}",
        name=element.name,
        footprint=ring(shape),
        attributes=attributes,
    )


def _object(
    number: int,
    item: Placed,
    plane_ids: Sequence[Sequence[str]],
    audited: Audit,
    config: PlanConfig,
) -> Object:
    source = item.source
    attributes: dict[str, Scalar] = {"guid": source.guid, "ifc_class": source.kind}
    if source.name:
        attributes["name"] = source.name
    if item.category == "door":
        attributes["leaf"] = getattr(source, "leaf", True)
    if number in audited.differing:
        attributes["boundaries"] = "differ"
    return Object(
        id=f"o{number}",
        category=item.category,
        center=point3(item.box.center),
        ellipsoid=ellipsoid(item.box, config.min_semi_axis),
        rooms=tuple(f"r{r}" for r in item.rooms),
        planes=tuple(plane_ids[room][face] for room, face in item.faces),
        confidence=1.0,
        attributes=attributes,
    )


def _far_away(building: Building) -> Iterator[Warning]:
    if any(building.offset):
        x, y, z = building.offset
        message = (
            f"the model stands far from its origin: ({x:.0f}, {y:.0f}, {z:.0f}) m are taken off "
            "all coordinates"
        )
        yield Warning("model-offset", message)


def _derived(derived: bool, shapes: Sequence[RoomShape]) -> Iterator[Warning]:
    if derived:
        message = f"the model has no spaces: {len(shapes)} rooms are derived from its walls"
        yield Warning("rooms-derived", message, tuple(f"r{i}" for i in range(len(shapes))))


def _floorless(lost: Sequence[Element]) -> Iterator[Warning]:
    if lost:
        message = f"{len(lost)} spaces have no floor area and are left out"
        yield Warning("room-without-floor", message, tuple(e.guid for e in lost))


def _odd_rooms(shapes: Sequence[RoomShape]) -> Iterator[Warning]:
    slivers = [i for i, s in enumerate(shapes) if s.slivers]
    if slivers:
        total = sum(shapes[i].slivers for i in slivers)
        message = f"{total} faces of {len(slivers)} rooms are slivers and left out"
        yield Warning("sliver-faces", message, tuple(f"r{i}" for i in slivers))
    parts = [i for i, s in enumerate(shapes) if s.parts > 1]
    if parts:
        message = f"{len(parts)} rooms have a floor in several parts; the largest is the footprint"
        yield Warning("room-in-parts", message, tuple(f"r{i}" for i in parts))
    for one, other, share in overlaps(shapes):
        message = f"rooms r{one} and r{other} share {share:.0%} of the smaller one's floor"
        yield Warning("rooms-overlap", message, (f"r{one}", f"r{other}"))
