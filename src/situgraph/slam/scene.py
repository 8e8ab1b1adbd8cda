"""The map as a scene graph."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from situgraph.geometry.poses import matrix_to_pose
from situgraph.scenegraph.graph import Keyframe as KeyframeNode
from situgraph.scenegraph.graph import Plane, SceneGraph, Warning
from situgraph.slam.graph import FactorGraph
from situgraph.slam.keyframes import Keyframe
from situgraph.slam.planemap import MapPlane, PlaneMap


def scene_graph(
    keyframes: Sequence[Keyframe],
    graph: FactorGraph,
    planes: PlaneMap,
    warnings: tuple[Warning, ...],
) -> SceneGraph:
    """Everything observable, in the map frame; planes with ``sightings`` and ``length`` (m)."""
    poses = graph.poses([k.number for k in keyframes])
    return SceneGraph(
        kind="online",
        planes=tuple(_plane(p) for p in planes.planes.values()),
        keyframes=tuple(
            KeyframeNode(f"k{k.number}", k.stamp, tuple(float(v) for v in pose))  # type: ignore[arg-type]
            for k, pose in zip(keyframes, matrix_to_pose(poses) if len(poses) else poses)
        ),
        warnings=warnings,
    )


def _plane(plane: MapPlane) -> Plane:
    n = plane.plane[:3] / np.linalg.norm(plane.plane[:3])
    (ax, ay), (bx, by) = plane.ends()
    return Plane(
        f"p{plane.number}",
        (float(n[0]), float(n[1]), float(n[2])),
        float(plane.plane[3]),
        extent=((float(ax), float(ay)), (float(bx), float(by))),
        attributes={"sightings": plane.sightings, "length": round(plane.length, 3)},
    )
