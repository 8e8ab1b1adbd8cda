"""Ray casting against the world, by Embree."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from situgraph.sim.mesh import Float32
from situgraph.sim.world import World


class Hits(NamedTuple):
    """First hits of n rays: ``distance`` (n,) m (inf: none) and ``triangle`` (n,) (-1: none)."""

    distance: Float32
    triangle: NDArray[np.int32]


class RayCaster:
    """The world's triangles in search trees: everything, and everything but window glass."""

    def __init__(self, world: World) -> None:
        self._all = _Scene(world, np.ones(len(world.mesh.part), dtype=bool))
        solid = ~world.panes
        self._solid = self._all if solid.all() else _Scene(world, solid)

    def cast(self, origins: Float32, directions: Float32, *, panes: bool = True) -> Hits:
        """First hits of rays from ``origins`` (n, 3) along unit ``directions`` (n, 3).

        Coordinates are the mesh's own (relative to ``world.origin``), metres. With ``panes``
        false, glass is not there.
        """
        return (self._all if panes else self._solid).cast(origins, directions)


class _Scene:
    """One Embree scene over some of the mesh's triangles."""

    def __init__(self, world: World, keep: NDArray[np.bool_]) -> None:
        from embreex.mesh_construction import TriangleMesh
        from embreex.rtcore_scene import EmbreeScene

        corners = world.mesh.corners[keep].astype(np.float32)
        self._index = np.flatnonzero(keep).astype(np.int32)
        # Robust: beams along the seams of triangles must not slip through.
        self._scene: Any = EmbreeScene(robust=True)
        faces = np.arange(3 * len(corners), dtype=np.int32).reshape(-1, 3)
        self._mesh = TriangleMesh(self._scene, corners.reshape(-1, 3), faces)

    def cast(self, origins: Float32, directions: Float32) -> Hits:
        """See ``RayCaster.cast``."""
        found = self._scene.run(
            np.ascontiguousarray(origins, dtype=np.float32),
            np.ascontiguousarray(directions, dtype=np.float32),
            output=True,
        )
        number = found["primID"]
        hit = (number >= 0) & (found["geomID"] >= 0)
        triangle = np.where(hit, self._index[np.where(hit, number, 0)], -1).astype(np.int32)
        return Hits(np.where(hit, found["tfar"], np.inf).astype(np.float32), triangle)
