"""A VLP-16: 16 beams that fire one after the other while the head turns and the robot moves."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from situgraph.geometry.poses import Array
from situgraph.io.vlp16 import vlp16
from situgraph.sim.config import LidarConfig
from situgraph.sim.rays import RayCaster
from situgraph.sim.world import World

_SPECULAR = 0.6  # share of a surface's reflectivity that does not depend on incidence


class Lidar:
    """Measures ranges in a world, with noise, losses and glass as ``config`` says."""

    def __init__(self, world: World, caster: RayCaster, config: LidarConfig) -> None:
        self._caster = caster
        self._config = config
        self._origin = world.origin
        self._normals = world.mesh.normals.astype(np.float32)
        self._reflect = np.array([m.reflectivity for m in world.materials])[world.mesh.part]
        self._panes = world.panes
        self.pattern = vlp16(config.rate)

    def scan(
        self, poses: Array, rng: np.random.Generator
    ) -> tuple[NDArray[np.uint16], NDArray[np.uint8]]:
        """Measure one turn.

        Args:
            poses: (c, 4, 4) lidar in the building at each cycle of the turn; (1, 4, 4) for a
                sensor at rest.
            rng: source of noise.

        Returns:
            Ranges (16, c) in multiples of ``config.range_step``, 0 for no return, and
            intensities (16, c).
        """
        c = self._config
        turn = poses[:, :3, :3].astype(np.float32)
        rays = np.einsum("cij,rcj->rci", np.broadcast_to(turn, (self.pattern.columns, 3, 3)),
                         self.pattern.directions)  # fmt: skip
        start = np.broadcast_to(
            (poses[:, :3, 3] - self._origin).astype(np.float32), rays.shape
        ).reshape(-1, 3)
        flat = rays.reshape(-1, 3)
        distance, triangle = self._caster.cast(start, flat)
        lot = rng.random((3, len(flat)), dtype=np.float32)
        noise = rng.standard_normal(len(flat), dtype=np.float32)
        lost = lot[0] < c.dropout
        on_pane = np.flatnonzero(self._panes[triangle] & (triangle >= 0))
        lost[on_pane] |= lot[1][on_pane] >= c.glass_pass + c.glass_return
        through = on_pane[lot[1][on_pane] < c.glass_pass]
        if len(through):
            beyond = self._caster.cast(start[through], flat[through], panes=False)
            distance[through], triangle[through] = beyond
        cosine = np.abs(np.einsum("ni,ni->n", self._normals[triangle], flat))
        lost |= lot[2] < np.exp(-cosine * (np.log(2.0) / max(c.grazing, 1e-6)))
        measured = distance + c.range_noise * noise
        lost |= ~((measured >= c.range_low) & (measured <= c.range_high)) | (triangle < 0)
        steps = np.where(lost, 0, np.rint(np.where(lost, 0, measured) / c.range_step))
        bright = self._reflect[triangle] * (_SPECULAR + (1 - _SPECULAR) * cosine)
        light = np.where(lost, 0, np.rint(255 * bright))
        shape = self.pattern.times.shape
        return steps.astype(np.uint16).reshape(shape), light.astype(np.uint8).reshape(shape)
