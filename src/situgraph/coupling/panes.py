"""Shut doors and window panes: they stand in the depth of a wall and are not its face."""

from __future__ import annotations

import math

import numpy as np

from situgraph.coupling.deviation import along_of
from situgraph.geometry.ellipsoids import shape_matrix
from situgraph.geometry.poses import Array
from situgraph.scenegraph.graph import Ellipsoid, Object, Plane, SceneGraph

OPENINGS = ("door", "window")  # what a wall has, and what detectors are made for
MOSTLY = 0.5  # a pane lies in openings over at least this share of what was seen of it
SILL = 0.3  # m; below an opening that begins no higher no wall is seen


def is_pane(
    span: tuple[float, float], behind: float, face: Plane, prior: SceneGraph, bounds: bool
) -> bool:
    """Whether a plane behind a planned face is rather that of shut doors or panes in it.

    It is, where most of what was seen of it is planned as openings, no deeper than the wall. A
    plane that bounds a room may be a moved wall, seen below the sills of its windows; so for such a
    plane only openings down to the floor count.

    Args:
        span: first and last metre of the plane along the face.
        behind: how far (m) it stands behind the face.
        face: of the plan.
        prior: the plan.
        bounds: whether the plane bounds a room.
    """
    openings = _to_the_floor(face, prior) if bounds else _openings(face, prior)
    depth = max((_depth(o, face) for o in openings), default=0.0)
    covered = _covered(openings, along_of(face), span)
    return behind <= 2.0 * depth and covered >= MOSTLY * (span[1] - span[0])


def opened(face: Plane, span: tuple[float, float], prior: SceneGraph) -> float:
    """Metres of a face between two places along it where no wall was planned, only openings."""
    return _covered(_to_the_floor(face, prior), along_of(face), span)


def reach(ellipsoid: Ellipsoid, along: Array) -> float:
    """How far (m) an ellipsoid reaches from its middle along a direction (2,) of the plan."""
    shape = shape_matrix(ellipsoid.axes, ellipsoid.rotation)
    return math.sqrt(float(along @ shape[:2, :2] @ along))


def _covered(openings: list[Object], along: Array, span: tuple[float, float]) -> float:
    total = 0.0
    for item in openings:
        at = float(along @ item.center[:2])
        half = 0.0 if item.ellipsoid is None else reach(item.ellipsoid, along)
        total += max(min(at + half, span[1]) - max(at - half, span[0]), 0.0)
    return total


def _depth(item: Object, face: Plane) -> float:
    """How far (m) the middle of an opening lies from a face."""
    return abs(float(np.asarray(face.normal) @ item.center) + face.offset)


def _openings(face: Plane, prior: SceneGraph) -> list[Object]:
    return [o for o in prior.objects_by_plane.get(face.id, ()) if o.category in OPENINGS]


def _to_the_floor(face: Plane, prior: SceneGraph) -> list[Object]:
    """The planned doors in a face, and the windows that reach down to the floor."""
    openings = _openings(face, prior)
    return [o for o in openings if o.category == "door" or _sill(o, prior) <= SILL]


def _sill(item: Object, prior: SceneGraph) -> float:
    """How high (m) over the floor an opening begins; infinite where no storey tells."""
    storeys = [prior.room_by_id[r].storey for r in item.rooms]
    floors = [prior.storey_by_id[s].elevation for s in storeys if s is not None]
    if item.ellipsoid is None or not floors:
        return math.inf
    return item.center[2] - item.ellipsoid.axes[2] - max(floors)
