"""An IFC model as a :class:`~situgraph.plan.building.Building`: what stands where, without IFC."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from situgraph.plan.building import Building, Element, Filling, Level, Mesh
from situgraph.plan.config import PlanConfig
from situgraph.plan.ifc_categories import FIXTURES, category_of
from situgraph.plan.ifc_shapes import read_shapes
from situgraph.scenegraph.graph import Warning

WALLS = ("IfcWall", "IfcCurtainWall", "IfcColumn")
MAX_DEPTH = 20  # levels of aggregation followed upwards; more is a loop


def read_building(model: Any, schema: str, config: PlanConfig) -> Building:
    """Everything of an open IFC file that an A-Graph needs, in metres near the origin."""
    spaces = _leaves(_of(model, "IfcSpace"))
    walls = list(_of(model, *WALLS))
    fillings = list(_of(model, "IfcDoor", "IfcWindow"))
    holes = {d.id(): hole for d in fillings if (hole := _hole(d)) is not None}
    bare = [o for o in _of(model, "IfcOpeningElement") if _is_bare(o)]
    fixtures = _roots(_of(model, *FIXTURES))
    slabs = [] if spaces else list(_of(model, "IfcSlab"))
    parts = {e.id(): _parts(e) for e in (*walls, *fixtures)}
    bodies = [*spaces, *walls, *bare, *slabs, *fixtures, *holes.values()]
    bodies += [f for f in fillings if f.id() not in holes]
    bodies += [p for e in parts.values() for p in e]
    meshes, offset = read_shapes(model, bodies, config.far)
    for key, several in parts.items():
        found = [meshes[p.id()] for p in several if p.id() in meshes]
        if key not in meshes and found:
            meshes[key] = _joined(found)
    return Building(
        name=_project_name(model),
        levels=tuple(_levels(model, float(offset[2]))),
        spaces=tuple(_element(e, meshes[e.id()]) for e in spaces if e.id() in meshes),
        walls=tuple(_element(e, meshes[e.id()]) for e in walls if e.id() in meshes),
        fillings=tuple(_fillings(fillings, bare, holes, meshes)),
        fixtures=tuple(_element(e, meshes[e.id()]) for e in fixtures if e.id() in meshes),
        slabs=tuple(_element(e, meshes[e.id()]) for e in slabs if e.id() in meshes),
        boundaries=_boundaries(model),
        offset=(float(offset[0]), float(offset[1]), float(offset[2])),
        attributes=_attributes(model, schema),
        warnings=tuple(_missing_bodies([*spaces, *walls, *fillings, *fixtures], holes, meshes)),
    )


def _of(model: Any, *classes: str) -> Iterator[Any]:
    """Products of these classes and their subclasses, each once, in file order."""
    seen = set()
    for name in classes:
        try:
            found = model.by_type(name)
        except RuntimeError:  # a class this schema does not have
            continue
        for entity in sorted(found, key=lambda e: int(e.id())):
            if entity.id() not in seen:
                seen.add(entity.id())
                yield entity


def _parent(entity: Any) -> Any | None:
    for relation in getattr(entity, "Decomposes", None) or ():
        return relation.RelatingObject
    return None


def _roots(entities: Iterable[Any]) -> list[Any]:
    """Those that are no part of another of them: a flight belongs to its stair."""
    found = list(entities)
    ids = {e.id() for e in found}
    return [e for e in found if (p := _parent(e)) is None or p.id() not in ids]


def _leaves(spaces: Iterable[Any]) -> list[Any]:
    """Spaces that are not made of other spaces: a flat's outline is no room beside its rooms."""
    found = list(spaces)
    whole = {
        p.id()
        for e in found
        if e.Representation is not None and (p := _parent(e)) is not None and p.is_a("IfcSpace")
    }
    return [e for e in found if e.id() not in whole]


def _parts(entity: Any) -> list[Any]:
    """What an aggregate without a body of its own is made of; doors are not part of the wall."""
    if entity.Representation is not None:
        return []
    out: list[Any] = []
    queue, seen = [entity], {entity.id()}
    while queue:
        for relation in getattr(queue.pop(0), "IsDecomposedBy", None) or ():
            for part in relation.RelatedObjects:
                if part.id() not in seen and part.is_a("IfcElement"):
                    seen.add(part.id())
                    queue.append(part)
                    if not part.is_a("IfcDoor") and not part.is_a("IfcWindow"):
                        out.append(part)
    return out


def _joined(meshes: list[Mesh]) -> Mesh:
    starts = np.cumsum([0] + [len(m.vertices) for m in meshes[:-1]])
    faces = [m.faces + s for m, s in zip(meshes, starts, strict=True)]
    return Mesh(np.concatenate([m.vertices for m in meshes]), np.concatenate(faces))


def _hole(filling: Any) -> Any | None:
    for relation in filling.FillsVoids or ():
        opening = relation.RelatingOpeningElement
        return opening if opening is not None and opening.Representation is not None else None
    return None


def _is_bare(opening: Any) -> bool:
    host = _host(opening)
    return not opening.HasFillings and host is not None and bool(host.is_a("IfcWall"))


def _host(opening: Any) -> Any | None:
    for relation in opening.VoidsElements or ():
        return relation.RelatingBuildingElement
    return None


def _level(entity: Any) -> int | None:
    """The number of the storey an entity stands in, through aggregates, holes and hosts."""
    for _ in range(MAX_DEPTH):
        if entity is None:
            return None
        if entity.is_a("IfcBuildingStorey"):
            return int(entity.id())
        for relation in getattr(entity, "ContainedInStructure", None) or ():
            entity = relation.RelatingStructure
            break
        else:
            entity = _parent(entity) or _voided(entity)
    return None


def _voided(entity: Any) -> Any | None:
    if entity.is_a("IfcOpeningElement"):
        return _host(entity)
    for relation in getattr(entity, "FillsVoids", None) or ():
        return relation.RelatingOpeningElement
    return None


def _element(entity: Any, mesh: Mesh) -> Element:
    return Element(
        key=int(entity.id()),
        guid=str(entity.GlobalId),
        kind=entity.is_a(),
        name=_text(entity.Name),
        mesh=mesh,
        level=_level(entity),
        long_name=_text(getattr(entity, "LongName", None)),
        category=category_of(entity),
    )


def _fillings(
    fillings: Iterable[Any], bare: Iterable[Any], holes: dict[int, Any], meshes: dict[int, Mesh]
) -> Iterator[Filling]:
    for entity in fillings:
        hole = holes.get(entity.id())
        mesh = meshes.get(hole.id() if hole is not None else entity.id())
        if mesh is not None:
            yield _filling(entity, mesh, hole)
    for opening in bare:
        if opening.id() in meshes:
            yield _filling(opening, meshes[opening.id()], opening)


def _filling(entity: Any, mesh: Mesh, hole: Any | None) -> Filling:
    host = _host(hole) if hole is not None else _parent(entity)
    return Filling(
        key=int(entity.id()),
        guid=str(entity.GlobalId),
        kind=entity.is_a(),
        category="opening" if entity.is_a("IfcOpeningElement") else category_of(entity),
        name=_text(entity.Name),
        mesh=mesh,
        host=None if host is None else int(host.id()),
        level=_level(entity),
        in_hole=hole is not None,
        leaf=not entity.is_a("IfcOpeningElement"),
        across=_across(entity) if hole is None else None,
    )


def _across(entity: Any) -> tuple[float, float] | None:
    """The y axis of a door's own placement, which by the standard points through the door."""
    from ifcopenshell.util.placement import get_local_placement

    if entity.ObjectPlacement is None:
        return None
    y = get_local_placement(entity.ObjectPlacement)[:2, 1]
    length = math.hypot(y[0], y[1])
    return (float(y[0] / length), float(y[1] / length)) if length > 0.9 else None


def _levels(model: Any, base: float) -> Iterator[Level]:
    from ifcopenshell.util.placement import get_local_placement
    from ifcopenshell.util.unit import calculate_unit_scale

    scale = float(calculate_unit_scale(model))
    for storey in _of(model, "IfcBuildingStorey"):
        height = storey.Elevation
        if height is None and storey.ObjectPlacement is not None:
            height = float(get_local_placement(storey.ObjectPlacement)[2, 3])
        declared = None if height is None else float(height) * scale - base
        yield Level(int(storey.id()), str(storey.GlobalId), _text(storey.Name), declared)


def _boundaries(model: Any) -> dict[int, tuple[int, ...]]:
    """For each door, window or opening: the spaces its space boundaries name."""
    found: dict[int, set[int]] = {}
    for relation in _of(model, "IfcRelSpaceBoundary"):
        element, space = relation.RelatedBuildingElement, relation.RelatingSpace
        if element is None or space is None or not space.is_a("IfcSpace"):
            continue
        if element.is_a("IfcOpeningElement"):
            filled = [f.RelatedBuildingElement for f in element.HasFillings or ()]
            element = filled[0] if filled else element
        if (
            element.is_a("IfcDoor")
            or element.is_a("IfcWindow")
            or element.is_a("IfcOpeningElement")
        ):
            found.setdefault(int(element.id()), set()).add(int(space.id()))
    return {key: tuple(sorted(spaces)) for key, spaces in sorted(found.items())}


def _attributes(model: Any, schema: str) -> dict[str, str | float | int | bool | None]:
    from ifcopenshell.util.unit import calculate_unit_scale

    found: dict[str, str | float | int | bool | None] = {
        "schema": schema,
        "unit_m": float(calculate_unit_scale(model)),
    }
    north = _true_north(model)
    if north is not None:
        found["true_north"] = north
    for project in _of(model, "IfcProject"):
        found["project"] = str(project.GlobalId)
        break
    return found


def _true_north(model: Any) -> float | None:
    """The direction of true north in the building frame: radians from x towards y."""
    try:
        contexts = model.by_type("IfcGeometricRepresentationContext", include_subtypes=False)
    except RuntimeError:
        return None
    for context in sorted(contexts, key=lambda c: int(c.id())):
        if context.TrueNorth is not None and context.ContextType in ("Model", None, "Design"):
            x, y = (float(v) for v in context.TrueNorth.DirectionRatios[:2])
            if math.isfinite(x) and math.isfinite(y) and math.hypot(x, y) > 1e-6:
                return math.atan2(y, x)
    return None


def _missing_bodies(
    entities: Iterable[Any], holes: dict[int, Any], meshes: dict[int, Mesh]
) -> Iterator[Warning]:
    lost: dict[str, list[str]] = {}
    for entity in entities:
        key = holes[entity.id()].id() if entity.id() in holes else entity.id()
        if key not in meshes:
            lost.setdefault(entity.is_a(), []).append(str(entity.GlobalId))
    for kind, guids in sorted(lost.items()):
        message = f"{len(guids)} {kind} without a usable body are left out"
        yield Warning("no-geometry", message, tuple(sorted(guids)))


def _project_name(model: Any) -> str | None:
    for entity in (*_of(model, "IfcBuilding"), *_of(model, "IfcProject")):
        if text := _text(entity.Name):
            return text
    return None


def _text(value: Any) -> str | None:
    text = " ".join(str(value).split()) if value is not None else ""
    return text[:200] or None
