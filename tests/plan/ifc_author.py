"""A small author of IFC files for tests: metres in, any unit and offset out."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import ifcopenshell
import ifcopenshell.guid

Point = tuple[float, float]
METRE, MILLIMETRE, FOOT = 1.0, 0.001, 0.3048


class Author:
    """Builds one model; lengths are metres, ``unit`` says in what the file states them.

    ``far`` is added by the site's placement, ``far_points`` to the points of every outline.
    """

    def __init__(
        self,
        schema: str = "IFC4",
        unit: float = METRE,
        far: tuple[float, float, float] = (0.0, 0.0, 0.0),
        far_points: Point = (0.0, 0.0),
        yaw: float = 0.0,
    ) -> None:
        self.model = ifcopenshell.file(schema=schema)
        self.unit, self.far_points = unit, far_points
        self.context = self._context(schema)
        self.site_placement = self._placement(far, yaw=yaw)
        self.building = self._root("IfcBuilding", Name="House", ObjectPlacement=self.site_placement)
        self.project = self._root(
            "IfcProject",
            Name="Test",
            RepresentationContexts=[self.context],
            UnitsInContext=self._units(),
        )
        self._aggregate(self.project, [self.building])

    # ------------------------------------------------------------------ what stands where

    def storey(self, name: str, elevation: float, declared: float | None = None) -> Any:
        stated = elevation if declared is None else declared
        storey = self._root(
            "IfcBuildingStorey",
            Name=name,
            Elevation=stated / self.unit,
            ObjectPlacement=self._placement((0, 0, 0), self.site_placement),
        )
        self._aggregate(self.building, [storey])
        return storey

    def space(
        self,
        name: str,
        outline: Sequence[Point],
        bottom: float = 0.0,
        height: float = 2.5,
        storey: Any = None,
        long_name: str | None = None,
        holes: Sequence[Sequence[Point]] = (),
        body: Any = None,
    ) -> Any:
        item = body or self.prism(outline, bottom, height, holes)
        space = self._product("IfcSpace", name, item, LongName=long_name)
        if storey is not None:
            self._aggregate(storey, [space])
        return space

    def wall(
        self,
        start: Point,
        end: Point,
        thickness: float = 0.2,
        bottom: float = 0.0,
        height: float = 2.8,
        storey: Any = None,
        name: str = "wall",
    ) -> Any:
        """A straight wall along its axis, longer by half its thickness at both ends."""
        outline = strip(start, end, thickness, thickness / 2)
        wall = self._product("IfcWall", name, self.prism(outline, bottom, height))
        self._contain(storey, wall)
        return wall

    def door(self, wall: Any, at: Point, along: Point, width: float = 0.9, **where: Any) -> Any:
        return self._filling("IfcDoor", wall, at, along, width, 0.0, 2.1, **where)

    def window(self, wall: Any, at: Point, along: Point, width: float = 1.2, **where: Any) -> Any:
        return self._filling("IfcWindow", wall, at, along, width, 0.9, 1.2, **where)

    def opening(
        self,
        wall: Any,
        at: Point,
        along: Point,
        width: float = 0.9,
        sill: float = 0.0,
        height: float = 2.1,
        bottom: float = 0.0,
        depth: float = 0.6,
    ) -> Any:
        """A hole deeper than the wall, as exporters make them."""
        outline = box(at, along, width, depth)
        hole = self._product(
            "IfcOpeningElement", "hole", self.prism(outline, bottom + sill, height)
        )
        self._root("IfcRelVoidsElement", RelatingBuildingElement=wall, RelatedOpeningElement=hole)
        return hole

    def element(
        self,
        kind: str,
        at: Point,
        size: Point,
        bottom: float = 0.0,
        height: float = 0.8,
        **more: Any,
    ) -> Any:
        """A box-shaped element with sides along the axes."""
        outline = box(at, (1.0, 0.0), *size)
        return self._product(kind, kind, self.prism(outline, bottom, height), **more)

    def parts(self, whole: Any, kind: str, boxes: Sequence[tuple[Point, Point]]) -> list[Any]:
        """Parts of an aggregate: boxes given by centre and size, 2.8 m high."""
        made = [self.element(kind, at, size, height=2.8) for at, size in boxes]
        self._aggregate(whole, made)
        return made

    def boundary(self, space: Any, element: Any) -> Any:
        return self._root(
            "IfcRelSpaceBoundary",
            RelatingSpace=space,
            RelatedBuildingElement=element,
            PhysicalOrVirtualBoundary="PHYSICAL",
            InternalOrExternalBoundary="INTERNAL",
        )

    def save(self, path: Path, schema_name: str | None = None) -> Path:
        """Write the file; ``schema_name`` replaces the name in its header."""
        text = self.model.to_string()
        if schema_name is not None:
            text = text.replace(f"'{self.model.schema_identifier}'", f"'{schema_name}'", 1)
        path.write_text(text)
        return path

    # ------------------------------------------------------------------ bodies

    def prism(
        self,
        outline: Sequence[Point],
        bottom: float,
        height: float,
        holes: Sequence[Sequence[Point]] = (),
    ) -> Any:
        make = self.model.create_entity
        rings = [self._polyline(ring) for ring in (outline, *holes)]
        if holes:
            profile = make("IfcArbitraryProfileDefWithVoids", "AREA", None, rings[0], rings[1:])
        else:
            profile = make("IfcArbitraryClosedProfileDef", "AREA", None, rings[0])
        position = self._axis((0.0, 0.0, bottom))
        up = make("IfcDirection", (0.0, 0.0, 1.0))
        return make("IfcExtrudedAreaSolid", profile, position, up, height / self.unit)

    def faceted(self, low: Sequence[float], high: Sequence[float], flip: Sequence[int] = ()) -> Any:
        """A box as a faceted body; the faces numbered in ``flip`` wind the wrong way round."""
        (x0, y0, z0), (x1, y1, z1) = low, high
        corners = [(x, y, z) for z in (z0, z1) for x, y in ((x0, y0), (x1, y0), (x1, y1), (x0, y1))]
        rings = [(3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
        make = self.model.create_entity
        points = [make("IfcCartesianPoint", self._scaled(c)) for c in corners]
        faces = []
        for number, ring in enumerate(rings):
            order = ring[::-1] if number in flip else ring
            loop = make("IfcPolyLoop", [points[k] for k in order])
            faces.append(make("IfcFace", [make("IfcFaceOuterBound", loop, True)]))
        return make("IfcFacetedBrep", make("IfcClosedShell", faces))

    def roofed(self, outline: Sequence[Point], bottom: float, height: float, slope: float) -> Any:
        """A prism cut by a roof plane that falls by ``slope`` along x from ``height`` at x = 0."""
        make = self.model.create_entity
        normal = (math.sin(math.atan(slope)), 0.0, math.cos(math.atan(slope)))
        position = self._axis((0.0, 0.0, bottom + height), normal)
        space = make("IfcHalfSpaceSolid", make("IfcPlane", position), False)
        solid = self.prism(outline, bottom, height)
        return make("IfcBooleanClippingResult", "DIFFERENCE", solid, space)

    # ------------------------------------------------------------------ plumbing

    def _filling(
        self,
        kind: str,
        wall: Any,
        at: Point,
        along: Point,
        width: float,
        sill: float,
        height: float,
        bottom: float = 0.0,
        hosted: bool = True,
    ) -> Any:
        outline = box(at, along, width, 0.06)
        body = self.prism(outline, bottom + sill, height)
        made = self._product(
            kind, kind, body, OverallHeight=height / self.unit, OverallWidth=width / self.unit
        )
        if hosted:
            hole = self.opening(wall, at, along, width, sill, height, bottom)
            self._root(
                "IfcRelFillsElement", RelatingOpeningElement=hole, RelatedBuildingElement=made
            )
        return made

    def _product(self, kind: str, name: str, item: Any, **more: Any) -> Any:
        make = self.model.create_entity
        shape = make("IfcShapeRepresentation", self.context, "Body", "SolidModel", [item])
        return self._root(
            kind,
            Name=name,
            ObjectPlacement=self._placement((0, 0, 0), self.site_placement),
            Representation=make("IfcProductDefinitionShape", None, None, [shape]),
            **more,
        )

    def _root(self, kind: str, **attributes: Any) -> Any:
        return self.model.create_entity(kind, GlobalId=ifcopenshell.guid.new(), **attributes)

    def _aggregate(self, whole: Any, parts: Sequence[Any]) -> None:
        self._root("IfcRelAggregates", RelatingObject=whole, RelatedObjects=list(parts))

    def _contain(self, storey: Any, element: Any) -> None:
        if storey is not None:
            self._root(
                "IfcRelContainedInSpatialStructure",
                RelatingStructure=storey,
                RelatedElements=[element],
            )

    def _polyline(self, ring: Sequence[Point]) -> Any:
        make = self.model.create_entity
        dx, dy = self.far_points
        points = [make("IfcCartesianPoint", self._scaled((x + dx, y + dy))) for x, y in ring]
        return make("IfcPolyline", [*points, points[0]])

    def _axis(
        self, at: Sequence[float], up: Sequence[float] | None = None, yaw: float = 0.0
    ) -> Any:
        make = self.model.create_entity
        point = make("IfcCartesianPoint", self._scaled(at))
        if up is None:
            up = (0.0, 0.0, 1.0)
            side = (math.cos(yaw), math.sin(yaw), 0.0)
        else:
            side = (0.0, 1.0, 0.0)
        return make(
            "IfcAxis2Placement3D",
            point,
            make("IfcDirection", tuple(up)),
            make("IfcDirection", side),
        )

    def _placement(self, at: Sequence[float], parent: Any = None, yaw: float = 0.0) -> Any:
        return self.model.create_entity("IfcLocalPlacement", parent, self._axis(at, yaw=yaw))

    def _scaled(self, point: Sequence[float]) -> tuple[float, ...]:
        return tuple(float(v) / self.unit for v in point)

    def _context(self, schema: str) -> Any:
        make = self.model.create_entity
        world = make("IfcAxis2Placement3D", make("IfcCartesianPoint", (0.0, 0.0, 0.0)))
        return make("IfcGeometricRepresentationContext", None, "Model", 3, 1e-5, world, None)

    def _units(self) -> Any:
        make = self.model.create_entity
        metre = make("IfcSIUnit", None, "LENGTHUNIT", None, "METRE")
        if self.unit == MILLIMETRE:
            metre = make("IfcSIUnit", None, "LENGTHUNIT", "MILLI", "METRE")
        elif self.unit != METRE:
            factor = make("IfcMeasureWithUnit", make("IfcLengthMeasure", self.unit), metre)
            size = make("IfcDimensionalExponents", 1, 0, 0, 0, 0, 0, 0)
            metre = make("IfcConversionBasedUnit", size, "LENGTHUNIT", "FOOT", factor)
        radian = make("IfcSIUnit", None, "PLANEANGLEUNIT", None, "RADIAN")
        return make("IfcUnitAssignment", [metre, radian])


def box(at: Point, along: Point, width: float, depth: float) -> list[Point]:
    """A rectangle round a point: ``width`` along a unit direction, ``depth`` across it."""
    (x, y), (tx, ty) = at, along
    return [
        (x + i * width / 2 * tx - j * depth / 2 * ty, y + i * width / 2 * ty + j * depth / 2 * tx)
        for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))
    ]


def strip(start: Point, end: Point, thickness: float, extra: float) -> list[Point]:
    """The outline of a straight wall between two axis points."""
    length = math.dist(start, end)
    along = ((end[0] - start[0]) / length, (end[1] - start[1]) / length)
    middle = ((start[0] + end[0]) / 2, (start[1] + end[1]) / 2)
    return box(middle, along, length + 2 * extra, thickness)


def rectangle(x0: float, y0: float, x1: float, y1: float) -> list[Point]:
    """An axis-parallel rectangle, counter-clockwise."""
    return [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]


def two_rooms(author: Author, storey: Any = None, bottom: float = 0.0) -> dict[str, Any]:
    """Rooms A (4 x 3 m) and B (3 x 3 m) side by side, a door between, one outside, a window each.

    Walls are 0.2 m thick with axes at x = -0.1, 4.1, 7.3 and y = -0.1, 3.1.
    """
    made: dict[str, Any] = {"storey": storey}
    at = {"bottom": bottom}
    made["a"] = author.space("A", rectangle(0, 0, 4, 3), bottom, storey=storey, long_name="Office")
    made["b"] = author.space("B", rectangle(4.2, 0, 7.2, 3), bottom, storey=storey)
    wall = {"storey": storey, "bottom": bottom}
    made["west"] = author.wall((-0.1, -0.1), (-0.1, 3.1), **wall)
    made["middle"] = author.wall((4.1, -0.1), (4.1, 3.1), **wall)
    made["east"] = author.wall((7.3, -0.1), (7.3, 3.1), **wall)
    made["south"] = author.wall((-0.1, -0.1), (7.3, -0.1), **wall)
    made["north"] = author.wall((-0.1, 3.1), (7.3, 3.1), **wall)
    made["door"] = author.door(made["middle"], (4.1, 1.0), (0.0, 1.0), **at)
    made["entrance"] = author.door(made["south"], (6.0, -0.1), (1.0, 0.0), 1.0, **at)
    made["window a"] = author.window(made["north"], (2.0, 3.1), (1.0, 0.0), **at)
    made["window b"] = author.window(made["east"], (7.3, 1.5), (0.0, 1.0), **at)
    return made
