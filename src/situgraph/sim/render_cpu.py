"""Pictures by ray casting where there is no OpenGL: the same looks, slower."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from situgraph.geometry.poses import Array
from situgraph.io.recording import Intrinsics
from situgraph.sim.mesh import Float32
from situgraph.sim.rays import RayCaster
from situgraph.sim.renderer import SKY, View, shading
from situgraph.sim.world import World


class CpuRenderer:
    """Casts a ray for each pixel and shades what it hits."""

    def __init__(self, world: World) -> None:
        self._world = world
        self._caster = RayCaster(world)
        self._looks = shading(world)
        self._normals = world.mesh.normals.astype(np.float32)
        self._corners = world.mesh.corners.astype(np.float32)
        self._uv = world.mesh.uv.astype(np.float32)
        self._textures = world.textures.astype(np.float32) / 255.0

    @property
    def name(self) -> str:
        """Says that there was no OpenGL."""
        return "CPU ray casting (Embree)"

    def view(self, pose: Array, intrinsics: Intrinsics, width: int, height: int) -> View:
        """See ``Renderer.view``."""
        v, u = np.mgrid[0:height, 0:width].astype(np.float32)
        k = intrinsics
        local = np.stack([(u - k.cx) / k.fx, (v - k.cy) / k.fy, np.ones_like(u)], axis=-1)
        rays = local.reshape(-1, 3) @ pose[:3, :3].T.astype(np.float32)
        stretch = np.linalg.norm(rays, axis=1)
        rays = (rays / stretch[:, None]).astype(np.float32)
        eye = (pose[:3, 3] - self._world.origin).astype(np.float32)
        distance, triangle = self._caster.cast(np.broadcast_to(eye, rays.shape), rays)
        hit = triangle >= 0
        colour = np.empty((len(rays), 3), dtype=np.float32)
        colour[~hit] = np.array(SKY) / 255
        colour[hit], slant = self._shade(eye, rays[hit], distance[hit], triangle[hit])
        depth = np.where(hit, distance / stretch, 0).astype(np.float32)
        ids = np.where(hit, self._world.mesh.part[triangle], 0).astype(np.uint16)
        cosine = np.zeros(len(rays), dtype=np.float32)
        cosine[hit] = slant
        shape = (height, width)
        rgb = np.rint(np.clip(colour, 0, 1) * 255).astype(np.uint8).reshape(*shape, 3)
        return View(rgb, depth.reshape(shape), ids.reshape(shape), cosine.reshape(shape))

    def _shade(
        self, eye: Float32, rays: Float32, distance: Float32, triangle: NDArray[np.int32]
    ) -> tuple[Float32, Float32]:
        """Colours (n, 3) and cosines of incidence (n,) of hits."""
        looks = self._looks.parts[self._world.mesh.part[triangle]]
        at = eye + rays * distance[:, None]
        normal = self._normals[triangle]
        slant = -np.einsum("ni,ni->n", normal, rays)
        normal = np.where(slant[:, None] < 0, -normal, normal)
        albedo = looks[:, 4:7] * self._texture(triangle, at, looks) * 1.25
        light = np.repeat((0.22 + 0.06 * normal[:, 2])[:, None], 3, axis=1)
        shine = np.zeros(len(rays), dtype=np.float32)
        rooms = self._looks.rooms[triangle]
        for room in np.unique(rooms):
            rows = np.flatnonzero(rooms == room)
            for lamp in self._looks.lamps[self._looks.first[room] : self._looks.first[room + 1]]:
                to = lamp[:3] - at[rows]
                square = np.einsum("ni,ni->n", to, to)
                to /= np.sqrt(square)[:, None]
                facing = np.einsum("ni,ni->n", normal[rows], to)
                fall = 2.6 / (2.0 + square)
                light[rows] += lamp[3:] * (fall * (np.maximum(facing, 0) + 0.12))[:, None]
                bounced = np.einsum(
                    "ni,ni->n", 2 * facing[:, None] * normal[rows] - to, -rays[rows]
                )
                shine[rows] += np.maximum(bounced, 0) ** 24 * fall
        colour = albedo * light + (looks[:, 2] * shine)[:, None]
        pane = looks[:, 3] > 0.5
        mirror = (0.04 + 0.5 * (1 - np.abs(slant[pane])) ** 4)[:, None]
        colour[pane] = _outside(rays[pane]) * (1 - mirror) + 0.75 * mirror
        return colour.astype(np.float32), np.abs(slant).astype(np.float32)

    def _texture(self, triangle: NDArray[np.int32], at: Float32, looks: Float32) -> Float32:
        """Texture values (n, 3) at points: barycentric coordinates, then the nearest pixel."""
        a, b, c = np.moveaxis(self._corners[triangle], 1, 0)
        ab, ac, ap = b - a, c - a, at - a
        d00, d01, d11 = (np.einsum("ni,ni->n", p, q) for p, q in ((ab, ab), (ab, ac), (ac, ac)))
        d20, d21 = np.einsum("ni,ni->n", ap, ab), np.einsum("ni,ni->n", ap, ac)
        scale = 1.0 / np.maximum(d00 * d11 - d01 * d01, 1e-20)
        s, t = (
            ((d11 * d20 - d01 * d21) * scale)[:, None],
            ((d00 * d21 - d01 * d20) * scale)[:, None],
        )
        uv = self._uv[triangle]
        tile = (uv[:, 0] * (1 - s - t) + uv[:, 1] * s + uv[:, 2] * t) * looks[:, 1:2]
        size = self._textures.shape[1]
        column, row = np.floor(tile % 1.0 * size).astype(int).T % size
        return np.asarray(self._textures[looks[:, 0].astype(int), row, column])


def _outside(rays: Float32) -> Float32:
    """The colours (n, 3) behind a window in directions ``rays`` (n, 3): sky, hedge, lawn."""
    up, azimuth = rays[:, 2:], np.arctan2(rays[:, 1:2], rays[:, :1])
    high = np.clip(2 * up, 0, 1)
    sky = np.array([0.92, 0.95, 1.0]) * (1 - high) + np.array([0.45, 0.65, 0.95]) * high
    hedge = 0.05 + 0.03 * np.sin(9 * azimuth) + 0.02 * np.sin(31 * azimuth)
    x = np.clip((up + 0.12) / 0.12, 0, 1)
    near = x * x * (3 - 2 * x)
    ground = np.array([0.42, 0.47, 0.33]) * (1 - near) + np.array([0.25, 0.36, 0.18]) * near
    return np.where(up > hedge, sky, ground).astype(np.float32)
