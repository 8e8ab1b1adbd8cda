"""What the robot knows, as factors: its own factor graph, or a scene graph from anywhere."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from situgraph.coupling.config import CouplingConfig
from situgraph.geometry.poses import Array, pose_to_matrix
from situgraph.scenegraph.graph import Plane, SceneGraph

if TYPE_CHECKING:
    from situgraph.slam.graph import FactorGraph

FIXED = 1e-5  # m and rad; a frame that does not move


@dataclass(frozen=True, eq=False)
class Evidence:
    """A gtsam graph of the map and its estimate; keys of planes and keyframes by online id."""

    factors: Any
    values: Any
    planes: Mapping[str, int]
    keyframes: Mapping[str, int]


def from_slam(graph: FactorGraph, online: SceneGraph) -> Evidence:
    """The factors of our own SLAM: its map bends where the plan says so.

    Args:
        graph: the factor graph behind ``online``; it is read, not changed.
        online: the S-Graph it gave: planes ``p7``, keyframes ``k7``.
    """
    import gtsam

    values = graph.values()
    every, kept = graph.factors(), gtsam.NonlinearFactorGraph()
    for slot in range(every.size()):
        if every.exists(slot):
            kept.push_back(every.at(slot))
    planes = {p.id: graph.key(("p", int(p.id[1:]))) for p in online.planes}
    frames = {k.id: graph.key(("x", int(k.id[1:]))) for k in online.keyframes}
    return Evidence(
        kept,
        gtsam.Values(values),
        {name: key for name, key in planes.items() if values.exists(key)},
        {name: key for name, key in frames.items() if values.exists(key)},
    )


def from_scene(online: SceneGraph, config: CouplingConfig) -> Evidence:
    """A scene graph of any source: each plane was measured by itself, keyframes stay in the map.

    A plane's attributes ``sigma_offset`` (m, at the wall) and ``sigma_angle`` (rad) are used where
    it has them. Each plane is measured from a frame at its own middle, so that an error of its
    angle does not swing it about a far origin.
    """
    import gtsam

    factors, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
    fixed = gtsam.noiseModel.Isotropic.Sigma(6, FIXED)
    planes: dict[str, int] = {}
    frames: dict[str, int] = {}
    places = _places(online)
    for number, plane in enumerate(online.planes):
        frame, key = gtsam.symbol("f", number), gtsam.symbol("p", number)
        n = np.asarray(plane.normal, dtype=float)
        n = n / np.linalg.norm(n)
        middle = places[plane.id]
        here = gtsam.Pose3(gtsam.Rot3(), middle)
        angle, offset = _sigmas(plane, config)
        noise = gtsam.noiseModel.Diagonal.Sigmas(np.array([angle, angle, offset]))
        seen = np.array([*n, plane.offset + n @ middle])
        values.insert(frame, here)
        values.insert(key, gtsam.OrientedPlane3(np.array([*n, plane.offset])))
        factors.push_back(gtsam.PriorFactorPose3(frame, here, fixed))
        factors.push_back(gtsam.OrientedPlane3Factor(seen, noise, frame, key))
        planes[plane.id] = key
    for number, keyframe in enumerate(online.keyframes):
        key = gtsam.symbol("x", number)
        pose = gtsam.Pose3(pose_to_matrix(keyframe.pose))
        values.insert(key, pose)
        factors.push_back(gtsam.PriorFactorPose3(key, pose, fixed))
        frames[keyframe.id] = key
    return Evidence(factors, values, planes, frames)


def _sigmas(plane: Plane, config: CouplingConfig) -> tuple[float, float]:
    found = []
    for name, usual in (
        ("sigma_angle", config.plane_angle_sigma),
        ("sigma_offset", config.plane_sigma),
    ):
        value = plane.attributes.get(name)
        given = isinstance(value, int | float) and 0.0 < value < 10.0
        found.append(float(value) if given and value is not None else usual)
    return found[0], found[1]


def _places(graph: SceneGraph) -> dict[str, Array]:
    """A point (3,) on each plane, near where it was seen."""
    return {p.id: place_of(graph, p) for p in graph.planes}


def place_of(graph: SceneGraph, plane: Plane) -> Array:
    """The middle (3,) of a face: of its extent, else below the first room it bounds."""
    n = np.asarray(plane.normal, dtype=float)
    n = n / np.linalg.norm(n)
    rooms = graph.rooms_by_plane.get(plane.id, ())
    centre = np.zeros(3) if not rooms else np.asarray(graph.room_by_id[rooms[0]].center)
    if plane.extent is not None:
        (ax, ay), (bx, by) = plane.extent
        centre = np.array([(ax + bx) / 2, (ay + by) / 2, centre[2]])
    out: Array = centre - (n @ centre + plane.offset) * n
    return out
