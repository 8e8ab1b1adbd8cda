"""One difference between a building and its plan."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import msgspec
import numpy as np

from situgraph.geometry.poses import Array
from situgraph.scenegraph.graph import Plane, SceneGraph, Vec3

Kind = Literal[
    "moved-wall", "missing-wall", "extra-wall", "moved-object", "missing-object", "extra-object"
]


class Deviation(msgspec.Struct, frozen=True, omit_defaults=True):
    """One difference between the building and its plan, in the building frame.

    Attributes:
        kind: what differs.
        category: ``wall``, or the object's.
        place: where (m).
        online: id of what was seen; None for what was not.
        prior: id of what was planned; None for what was not.
        rooms: the planned rooms concerned.
        offset: how far it lies from its planned place (m); of a wall positive along the planned
            normal into the room, of an object along its wall.
        sigma: standard deviation of ``offset`` (m).
        tilt: how far a wall is turned in the plan (rad).
        tilt_sigma: its standard deviation (rad).
        element: GlobalId of the planned element, where the plan names it.
        message: all of this in a sentence.
    """

    kind: Kind
    category: str
    place: Vec3
    message: str
    online: str | None = None
    prior: str | None = None
    rooms: tuple[str, ...] = ()
    offset: float | None = None
    sigma: float | None = None
    tilt: float | None = None
    tilt_sigma: float | None = None
    element: str | None = None


def along_of(face: Plane) -> Array:
    """The direction (2,) of a face in the plan."""
    n = np.asarray(face.normal[:2], dtype=float)
    along: Array = np.array([-n[1], n[0]], dtype=float)
    along /= np.hypot(n[0], n[1])
    return along


def names_of(graph: SceneGraph, rooms: Sequence[str]) -> str:
    """Rooms by name, for a sentence."""
    names = [str(graph.room_by_id[r].name or r) for r in rooms if r in graph.room_by_id]
    return " and ".join(names) if names else "the building"
