"""Which IFC classes become objects, and their canonical category."""

from __future__ import annotations

from typing import Any

from situgraph.plan.ifc_links import many, one
from situgraph.scenegraph.categories import canonical

# Fixed elements and furniture, by class, subclasses included. Pipes, ducts and their fittings are
# left out: they are many, hidden, and no detector tells them apart.
FIXTURES = (
    "IfcColumn", "IfcStair", "IfcStairFlight", "IfcRamp", "IfcRampFlight", "IfcRailing",
    "IfcFurnishingElement", "IfcFlowTerminal", "IfcEnergyConversionDevice", "IfcFlowController",
    "IfcTransportElement", "IfcBuildingElementProxy", "IfcChimney", "IfcAlarm", "IfcSensor",
)  # fmt: skip

# predefined type of a sanitary terminal -> category; the class alone does not say which it is
_SANITARY = {
    "BATH": "bathtub", "BIDET": "bidet", "CISTERN": "cistern", "SHOWER": "shower",
    "SINK": "sink", "WASHHANDBASIN": "sink", "TOILETPAN": "toilet", "WCSEAT": "toilet",
    "URINAL": "urinal", "SANITARYFOUNTAIN": "drinking_fountain",
}  # fmt: skip


def category_of(entity: Any) -> str:
    """The canonical category of a product: by its own class, or its type's where that says more.

    In IFC2x3 a wash basin is an ``IfcFlowTerminal`` whose type is an ``IfcSanitaryTerminalType``.
    """
    kind = entity.is_a()
    described = _type_of(entity)
    if described is not None and kind in ("IfcFlowTerminal", "IfcEnergyConversionDevice"):
        kind = described.is_a().removesuffix("Type")
    if kind == "IfcSanitaryTerminal":
        for holder in (entity, described):
            predefined = str(getattr(holder, "PredefinedType", None) or "")
            if predefined in _SANITARY:
                return _SANITARY[predefined]
    return canonical(kind, "ifc")


def _type_of(entity: Any) -> Any | None:
    for relation in (*many(entity, "IsTypedBy"), *many(entity, "IsDefinedBy")):
        if relation.is_a("IfcRelDefinesByType"):
            return one(relation, "RelatingType")
    return None
