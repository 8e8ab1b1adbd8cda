"""Plans, views of them with known errors, and pairs that are right."""

from __future__ import annotations

from collections.abc import Mapping

import msgspec
import numpy as np

from situgraph.coupling.located import Pairs
from situgraph.geometry.poses import Placement, matrix_to_pose
from situgraph.plan.six_rooms import six_rooms
from situgraph.scenegraph.graph import Keyframe, SceneGraph
from situgraph.scenegraph.transform import transformed

MAP = Placement(12.0, -7.0, 0.5, 2.0)  # of the map in the building


def seen(
    prior: SceneGraph,
    moved: Mapping[str, float] | None = None,
    noise: float = 0.0,
    seed: int = 0,
    frame: Placement = MAP,
) -> SceneGraph:
    """``prior`` as seen from the map: faces ``moved`` along their normals, the rest with noise."""
    rng = np.random.default_rng(seed)
    planes = tuple(
        msgspec.structs.replace(
            p, offset=p.offset - (moved or {}).get(p.id, 0.0) + float(rng.normal(0.0, noise))
        )
        for p in prior.planes
    )
    frames = tuple(
        Keyframe(f"k{i}", float(i), tuple(matrix_to_pose(_standing(r.center)).tolist()))
        for i, r in enumerate(prior.rooms)
    )
    built = prior.replace(planes=planes, keyframes=frames, kind="online")
    return transformed(built, frame.inverse())


def _standing(center: tuple[float, float, float]) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, 3] = center
    return pose


def all_pairs(graph: SceneGraph, placement: Placement = MAP) -> Pairs:
    """Everything corresponds to what has its id."""
    return Pairs(
        placement,
        {r.id: r.id for r in graph.rooms},
        {p.id: p.id for p in graph.planes},
        {o.id: o.id for o in graph.objects},
        {s.id: s.id for s in graph.storeys},
    )


PRIOR = six_rooms()
