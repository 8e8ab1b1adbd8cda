"""Canonical category names and the one table that maps other vocabularies to them.

A name that no table holds is kept as it is, in snake case, so that further categories need no code.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from types import MappingProxyType

# What is mounted on a wall and so carries the relation *on plane*.
WALL_MOUNTED = frozenset(
    {"door", "window", "radiator", "extinguisher", "outlet", "switch", "sign", "whiteboard", "sink",
     "screen", "picture", "mirror", "clock"}
)  # fmt: skip

# Of these, what stands out of its wall: flat in the wall it is a picture.
SOLID = frozenset({"radiator", "extinguisher", "sink"})

_IFC = {
    "IfcDoor": "door", "IfcDoorStandardCase": "door", "IfcWindow": "window",
    "IfcWindowStandardCase": "window", "IfcColumn": "column", "IfcColumnStandardCase": "column",
    "IfcStair": "stairs", "IfcStairFlight": "stairs", "IfcRamp": "ramp", "IfcRampFlight": "ramp",
    "IfcSanitaryTerminal": "sink", "IfcFlowTerminal": "fixture", "IfcSpaceHeater": "radiator",
    "IfcFireSuppressionTerminal": "extinguisher", "IfcOutlet": "outlet",
    "IfcLightFixture": "light", "IfcLamp": "light", "IfcSwitchingDevice": "switch",
    "IfcFurniture": "furniture", "IfcFurnishingElement": "furniture",
    "IfcSystemFurnitureElement": "furniture", "IfcTransportElement": "elevator",
    "IfcElectricAppliance": "appliance", "IfcAirTerminal": "vent",
    "IfcRailing": "railing", "IfcChimney": "chimney", "IfcAlarm": "alarm", "IfcSensor": "sensor",
}  # fmt: skip

_ADE20K = {
    "door": "door", "double door": "door", "screen door": "door", "windowpane": "window",
    "window": "window", "column": "column", "pillar": "column", "stairs": "stairs",
    "stairway": "stairs", "staircase": "stairs", "step": "stairs", "sink": "sink",
    "toilet": "toilet", "bathtub": "bathtub", "radiator": "radiator", "cabinet": "cabinet",
    "wardrobe": "cabinet", "closet": "cabinet", "bookcase": "shelf", "shelf": "shelf",
    "desk": "desk", "table": "table", "chair": "chair", "sofa": "sofa", "bed": "bed",
    "refrigerator": "refrigerator", "stove": "stove", "fireplace": "fireplace",
    "clock": "clock", "mirror": "mirror", "painting": "picture", "light": "light",
    "escalator": "escalator", "railing": "railing", "bulletin board": "whiteboard",
    "crt screen": "screen", "monitor": "screen", "television receiver": "screen",
}  # fmt: skip

_COCO = {
    "door-stuff": "door", "door": "door", "window-blind": "window", "window-other": "window",
    "window": "window", "sink": "sink", "toilet": "toilet", "refrigerator": "refrigerator",
    "oven": "stove", "microwave": "microwave", "tv": "screen", "clock": "clock",
    "mirror-stuff": "mirror", "stairs": "stairs", "shelf": "shelf", "cabinet-merged": "cabinet",
    "table-merged": "table", "chair": "chair", "couch": "sofa", "bed": "bed",
    "dining table": "table", "light": "light",
}  # fmt: skip

_OSM = {
    "door": "door",
    "entrance": "door",
    "window": "window",
    "elevator": "elevator",
    "stairs": "stairs",
}

SCHEMES: Mapping[str, Mapping[str, str]] = MappingProxyType(
    {
        "ifc": MappingProxyType(_IFC),
        "ade20k": MappingProxyType(_ADE20K),
        "coco": MappingProxyType(_COCO),
        "osm": MappingProxyType(_OSM),
    }
)


def canonical(name: str, scheme: str) -> str:
    """The canonical name of a category of ``scheme`` (``ifc``, ``ade20k``, ``coco``, ``osm``).

    Raises:
        KeyError: no such scheme.
    """
    first = name.split(",")[0].split(";")[0].strip()
    known = SCHEMES[scheme]
    found = known.get(first) or known.get(first.lower())
    return found if found is not None else snake_case(first)


def snake_case(name: str) -> str:
    """``IfcFlowTerminal`` -> ``flow_terminal``, ``Fire hydrant`` -> ``fire_hydrant``."""
    bare = re.sub(r"^Ifc", "", name)
    words = re.sub(r"([a-z0-9])([A-Z])", r"\1_\2", bare)
    return re.sub(r"[^a-z0-9]+", "_", words.lower()).strip("_")
