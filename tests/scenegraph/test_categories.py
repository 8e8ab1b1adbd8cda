from __future__ import annotations

import pytest

from situgraph.scenegraph.categories import canonical


@pytest.mark.parametrize(
    ("name", "scheme", "expected"),
    [
        ("IfcDoor", "ifc", "door"),
        ("IfcWindowStandardCase", "ifc", "window"),
        ("IfcUnitaryEquipment", "ifc", "unitary_equipment"),
        ("windowpane;window", "ade20k", "window"),
        ("screen door, screen", "ade20k", "door"),
        ("door-stuff", "coco", "door"),
        ("Fire hydrant", "osm", "fire_hydrant"),
    ],
)
def test_one_table_maps_all_vocabularies(name, scheme, expected) -> None:
    assert canonical(name, scheme) == expected


def test_an_unknown_scheme_is_an_error() -> None:
    with pytest.raises(KeyError):
        canonical("door", "nyu")
