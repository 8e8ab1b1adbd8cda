"""An IFC model as a :class:`~situgraph.plan.building.Building`: what stands where, without IFC."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from situgraph.plan.building import Building, Element, Filling, Level, Mesh
from situgraph.plan.config import PlanConfig
from situgraph.plan.ifc_categories import FIXTURES, category_of
from situgraph.plan.ifc_links import (
    has_body,
    hole,
    host,
    leaves,
    level,
    many,
    one,
    parent,
    parts,
    products,
    roots,
)
from situgraph.plan.ifc_shapes import read_shapes
from situgraph.scenegraph.graph import Warning

WALLS = ("IfcWall", "IfcCurtainWall", "IfcColumn")


def read_building(model: Any, schema: str, config: PlanConfig) -> Building:
    """Everything of an open IFC file that an A-Graph needs, in metres near the origin."""
    spaces = [] if config.ignore_spaces else leaves(products(model, "IfcSpace"))
    walls = list(products(model, *WALLS))
    fillings = list(products(model, "IfcDoor", "IfcWindow"))
    holes = {d.id(): opening for d in fillings if (opening := hole(d)) is not None}
    bare = [o for o in products(model, "IfcOpeningElement") if _is_bare(o)]
    fixtures = roots(products(model, *FIXTURES))
    slabs = [] if any(has_body(s) for s in spaces) else list(products(model, "IfcSlab"))
    pieces = {e.id(): parts(e) for e in (*walls, *fixtures)}
    bodies = [*spaces, *walls, *bare, *slabs, *fixtures, *holes.values()]
    bodies += [f for f in fillings if f.id() not in holes]
    bodies += [p for e in pieces.values() for p in e]
    # Behind a room's face the side of a wall counts, not the slope of its top: no need to clip it.
    uncut = {w.id() for w in walls} if spaces else set()
    meshes, offset = read_shapes(model, bodies, config.far, uncut)
    for key, several in pieces.items():
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


def _joined(meshes: list[Mesh]) -> Mesh:
    starts = np.cumsum([0] + [len(m.vertices) for m in meshes[:-1]])
    faces = [m.faces + s for m, s in zip(meshes, starts, strict=True)]
    return Mesh(np.concatenate([m.vertices for m in meshes]), np.concatenate(faces))


def _is_bare(opening: Any) -> bool:
    wall = host(opening)
    return not many(opening, "HasFillings") and wall is not None and bool(wall.is_a("IfcWall"))


def _element(entity: Any, mesh: Mesh) -> Element:
    return Element(
        key=int(entity.id()),
        guid=str(entity.GlobalId),
        kind=entity.is_a(),
        name=_text(entity.Name),
        mesh=mesh,
        level=level(entity),
        long_name=_text(getattr(entity, "LongName", None)),
        category=category_of(entity),
    )


def _fillings(
    fillings: Iterable[Any], bare: Iterable[Any], holes: dict[int, Any], meshes: dict[int, Mesh]
) -> Iterator[Filling]:
    for entity in fillings:
        opening = holes.get(entity.id())
        mesh = meshes.get(opening.id() if opening is not None else entity.id())
        if mesh is not None:
            yield _filling(entity, mesh, opening)
    for opening in bare:
        if opening.id() in meshes:
            yield _filling(opening, meshes[opening.id()], opening)


def _filling(entity: Any, mesh: Mesh, opening: Any | None) -> Filling:
    wall = host(opening) if opening is not None else parent(entity)
    return Filling(
        key=int(entity.id()),
        guid=str(entity.GlobalId),
        kind=entity.is_a(),
        category="opening" if entity.is_a("IfcOpeningElement") else category_of(entity),
        name=_text(entity.Name),
        mesh=mesh,
        host=None if wall is None else int(wall.id()),
        level=level(entity),
        in_hole=opening is not None,
        leaf=not entity.is_a("IfcOpeningElement"),
        across=_across(entity) if opening is None else None,
    )


def _across(entity: Any) -> tuple[float, float] | None:
    """The y axis of a door's own placement, which by the standard points through the door."""
    from ifcopenshell.util.placement import get_local_placement

    try:
        y = get_local_placement(entity.ObjectPlacement)[:2, 1]
    except (AttributeError, TypeError, RecursionError):  # no placement, or a broken one
        return None
    length = math.hypot(y[0], y[1])
    return (float(y[0] / length), float(y[1] / length)) if 0.9 < length < 1.1 else None


def _levels(model: Any, base: float) -> Iterator[Level]:
    """Storeys with the elevation they declare, ``base`` taken off, or that of their placement."""
    from ifcopenshell.util.placement import get_local_placement

    scale = _unit(model)
    for storey in products(model, "IfcBuildingStorey"):
        height = storey.Elevation
        try:
            if height is None:
                height = get_local_placement(storey.ObjectPlacement)[2, 3]
            declared = float(height) * scale - base
        except (AttributeError, TypeError, ValueError, RecursionError):
            declared = math.nan
        stated = declared if math.isfinite(declared) else None
        yield Level(int(storey.id()), str(storey.GlobalId), _text(storey.Name), stated)


def _unit(model: Any) -> float:
    """The file's length unit in metres; metres where it states none that makes sense."""
    from ifcopenshell.util.unit import calculate_unit_scale

    try:
        scale = float(calculate_unit_scale(model))
    except (AttributeError, TypeError, ValueError, KeyError, IndexError, ZeroDivisionError):
        return 1.0
    return scale if 0.0 < scale < 1e6 else 1.0


def _boundaries(model: Any) -> dict[int, tuple[int, ...]]:
    """For each door, window or opening: the spaces its space boundaries name."""
    found: dict[int, set[int]] = {}
    for relation in products(model, "IfcRelSpaceBoundary"):
        element, space = one(relation, "RelatedBuildingElement"), one(relation, "RelatingSpace")
        if element is None or space is None or not space.is_a("IfcSpace"):
            continue
        if element.is_a("IfcOpeningElement"):
            filled = [one(f, "RelatedBuildingElement") for f in many(element, "HasFillings")]
            element = next((f for f in filled if f is not None), element)
        if any(element.is_a(kind) for kind in ("IfcDoor", "IfcWindow", "IfcOpeningElement")):
            found.setdefault(int(element.id()), set()).add(int(space.id()))
    return {key: tuple(sorted(spaces)) for key, spaces in sorted(found.items())}


def _attributes(model: Any, schema: str) -> dict[str, str | float | int | bool | None]:
    found: dict[str, str | float | int | bool | None] = {"schema": schema, "unit_m": _unit(model)}
    north = _true_north(model)
    if north is not None:
        found["true_north"] = north
    for project in products(model, "IfcProject"):
        found["project"] = str(project.GlobalId)
        break
    return found


def _true_north(model: Any) -> float | None:
    """The direction of true north in the building frame: radians from x towards y."""
    for context in products(model, "IfcGeometricRepresentationContext"):
        direction = one(context, "TrueNorth")
        if direction is None or context.ContextType not in ("Model", None, "Design"):
            continue
        x, y = (float(v) for v in (*direction.DirectionRatios[:2], 0.0, 0.0)[:2])
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
    for entity in (*products(model, "IfcBuilding"), *products(model, "IfcProject")):
        if text := _text(entity.Name):
            return text
    return None


def _text(value: Any) -> str | None:
    text = " ".join(str(value).split()) if value is not None else ""
    return text[:200] or None
