"""An RGB-D camera: pictures as the sensor gives them, with noise, steps and losses.

Depth comes from a stereo pair, so its noise and steps are those of disparity f b / z: the standard
deviation of z is z^2 s / (f b) with s that of the disparity (Intel RealSense D400 data sheet).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from situgraph.geometry.poses import Array
from situgraph.io.recording import Intrinsics
from situgraph.sim.config import CameraConfig
from situgraph.sim.mesh import Float32
from situgraph.sim.renderer import Renderer, View
from situgraph.sim.world import World

_STEP = 0.04  # of the depth: neighbouring pixels that differ more lie on an edge
_GRAZING = 0.08  # cosine of incidence below which stereo finds nothing
_EXPOSURE = 0.5  # mean brightness the exposure control aims at
_GAIN = (0.8, 2.6)  # its limits
_GAMMA = 0.8
_DIM = 1e-3  # brightness of a picture that is black


class Picture(NamedTuple):
    """``rgb`` (h, w, 3) uint8, ``depth`` (h, w) float32 m (0: none), ``ids`` (h, w) uint16."""

    rgb: NDArray[np.uint8]
    depth: Float32
    ids: NDArray[np.uint16]


class Camera:
    """Takes pictures with a renderer; smaller ones where that is the slow one."""

    def __init__(self, world: World, renderer: Renderer, config: CameraConfig, width: int) -> None:
        self._renderer = renderer
        self._config = config
        self._panes = np.array([m.pane for m in world.materials])
        self.width = width
        self.height = round(config.height * width / config.width)
        focal = config.focal * width / 640.0
        self.intrinsics = Intrinsics(focal, focal, (width - 1) / 2, (self.height - 1) / 2)

    def take(self, pose: Array, rng: np.random.Generator) -> Picture:
        """A picture from ``pose`` (4, 4), the optical frame (z forward) in the building."""
        view = self._renderer.view(pose, self.intrinsics, self.width, self.height)
        return Picture(self._colour(view, rng), self._depth(view, rng), view.ids)

    def _colour(self, view: View, rng: np.random.Generator) -> NDArray[np.uint8]:
        """Exposure, gamma and noise."""
        c = self._config
        mean = max(float(view.rgb[::4, ::4].mean()) / 255.0, _DIM)
        gain = float(np.clip(_EXPOSURE / mean * rng.uniform(0.8, 1.2), *_GAIN))
        table = 255.0 * np.clip(np.arange(256) / 255.0 * gain, 0, 1) ** _GAMMA
        noise = rng.standard_normal(view.ids.shape, dtype=np.float32) * c.rgb_noise
        bright = table.astype(np.float32)[view.rgb] + noise[..., None]
        return np.clip(bright, 0, 255).astype(np.uint8)

    def _depth(self, view: View, rng: np.random.Generator) -> Float32:
        """Stereo noise, steps of disparity and of a millimetre, and what stereo misses."""
        c = self._config
        # The matcher works on the sensor's own pixels whatever the size of the picture.
        strength = c.focal * c.baseline
        z = view.depth
        seen = z > 0
        disparity = strength / np.where(seen, z, 1.0)
        disparity += c.disparity_noise * _blocks(rng, z.shape)
        steps = np.maximum(np.rint(disparity / c.disparity_step), 1.0)
        depth = np.rint(1000.0 * strength / (steps * c.disparity_step)) / 1000.0
        lot = rng.random(z.shape, dtype=np.float32)
        lost = lot < c.dropout
        lost |= self._panes[view.ids] & (lot >= c.glass_depth)
        lost |= _edges(z) & (lot < c.edge_loss)
        lost |= view.slant < _GRAZING
        lost |= ~seen | (depth < c.depth_low) | (depth > c.depth_high)
        return np.where(lost, 0.0, depth).astype(np.float32)


def _blocks(rng: np.random.Generator, shape: tuple[int, ...]) -> Float32:
    """Unit noise (h, w) that 2x2 pixels share: a stereo matcher compares blocks, not pixels."""
    half = rng.standard_normal([(n + 1) // 2 for n in shape], dtype=np.float32)
    return np.repeat(np.repeat(half, 2, axis=0), 2, axis=1)[: shape[0], : shape[1]]


def _edges(z: Float32) -> NDArray[np.bool_]:
    """Pixels (h, w) with a step in depth beside them."""
    near = np.zeros(z.shape, dtype=bool)
    for a, b in (
        ((slice(None), slice(1, None)), (slice(None), slice(None, -1))),
        ((slice(1, None), slice(None)), (slice(None, -1), slice(None))),
    ):
        step = np.abs(z[a] - z[b]) > _STEP * np.minimum(z[a], z[b])
        near[a] |= step
        near[b] |= step
    return near
