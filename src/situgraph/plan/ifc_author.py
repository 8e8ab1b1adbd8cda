"""Entities of an IFC4 model, made one by one: identities, placements, bodies, relations."""

from __future__ import annotations

import uuid
from collections.abc import Sequence
from typing import Any

from situgraph.scenegraph.graph import Vec2, Vec3

# All GlobalIds are derived from this and the node's name, so that writing twice gives one file.
NAMESPACE = uuid.UUID("6f0f2b1e-6c0e-5c1b-9a39-3a0a5b6d7e11")
# The date written in the header: a fixed one, for the same reason.
DATE = "2000-01-01T00:00:00"


class Author:
    """Writes one building: knows the model, its units and its body context."""

    def __init__(self, name: str, version: str) -> None:
        """Start an IFC4 file in metres for the building ``name``."""
        import ifcopenshell

        self.name = name
        self.model: Any = ifcopenshell.file(schema="IFC4")
        self._header(version)
        zero = self.model.createIfcCartesianPoint((0.0, 0.0, 0.0))
        self._up = self.model.createIfcDirection((0.0, 0.0, 1.0))
        world = self.model.createIfcAxis2Placement3D(zero)
        context = self.model.createIfcGeometricRepresentationContext(
            None, "Model", 3, 1e-5, world, None
        )
        self._body = self.model.createIfcGeometricRepresentationSubContext(
            "Body", "Model", None, None, None, None, context, None, "MODEL_VIEW", None
        )
        units = self.model.createIfcUnitAssignment(
            [
                self.model.createIfcSIUnit(None, kind, None, unit)
                for kind, unit in (
                    ("LENGTHUNIT", "METRE"),
                    ("AREAUNIT", "SQUARE_METRE"),
                    ("VOLUMEUNIT", "CUBIC_METRE"),
                    ("PLANEANGLEUNIT", "RADIAN"),
                )
            ]
        )
        self.project = self.rooted("IfcProject", "project", Name=name)
        self.project.RepresentationContexts = [context]
        self.project.UnitsInContext = units

    def rooted(self, kind: str, key: str, **attributes: Any) -> Any:
        """An entity with a GlobalId that follows from the building's name and ``key``."""
        import ifcopenshell.guid

        number = uuid.uuid5(NAMESPACE, f"{self.name}/{key}")
        guid = ifcopenshell.guid.compress(number.hex)
        return self.model.create_entity(kind, GlobalId=guid, **attributes)

    def placement(self, at: Vec3, ahead: Vec2 = (1.0, 0.0), under: Any = None) -> Any:
        """A local placement at ``at`` (m) whose x axis points ``ahead``, relative to ``under``."""
        point = self.model.createIfcCartesianPoint(at)
        axis = self.model.createIfcDirection((*ahead, 0.0))
        frame = self.model.createIfcAxis2Placement3D(point, self._up, axis)
        return self.model.createIfcLocalPlacement(under, frame)

    def prism(self, outline: Sequence[Vec2], height: float, base: float = 0.0) -> Any:
        """An upright body over a counter-clockwise ``outline`` (m) in its own placement."""
        corners = [self.model.createIfcCartesianPoint(p) for p in (*outline, outline[0])]
        corners[-1] = corners[0]
        line = self.model.createIfcPolyline(corners)
        profile = self.model.createIfcArbitraryClosedProfileDef("AREA", None, line)
        foot = self.model.createIfcCartesianPoint((0.0, 0.0, base))
        frame = self.model.createIfcAxis2Placement3D(foot)
        solid = self.model.createIfcExtrudedAreaSolid(profile, frame, self._up, height)
        shape = self.model.createIfcShapeRepresentation(self._body, "Body", "SweptSolid", [solid])
        return self.model.createIfcProductDefinitionShape(None, None, [shape])

    def box(self, width: float, depth: float, height: float) -> Any:
        """An upright box whose middle is the origin of its placement."""
        w, d = 0.5 * width, 0.5 * depth
        return self.prism([(-w, -d), (w, -d), (w, d), (-w, d)], height, -0.5 * height)

    def relate(self, kind: str, key: str, relating: Any, related: Any, ends: str) -> None:
        """A relation ``kind``; ``ends`` names its two attributes, the relating one first."""
        one, other = ends.split()
        self.rooted(kind, key, **{one: relating, other: related})

    def text(self) -> bytes:
        """The file."""
        return str(self.model.to_string()).encode()

    def _header(self, version: str) -> None:
        header = self.model.header
        header.file_description.description = ("ViewDefinition [ReferenceView_V1.2]",)
        header.file_name.name = self.name
        header.file_name.time_stamp = DATE
        header.file_name.author = ("",)
        header.file_name.organization = ("",)
        header.file_name.preprocessor_version = "situgraph"
        header.file_name.originating_system = f"situgraph {version}"
        header.file_name.authorization = ""
