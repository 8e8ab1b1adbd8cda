"""Pictures of the world without sensor noise: colour, depth and part numbers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from situgraph.errors import SituGraphError
from situgraph.geometry.poses import Array
from situgraph.io.recording import Intrinsics
from situgraph.sim.mesh import Float32
from situgraph.sim.world import World, room_numbers

Wanted = Literal["auto", "gl", "cpu"]
SKY = (178, 204, 242)


class View(NamedTuple):
    """A picture of height h and width w.

    ``rgb`` (h, w, 3) uint8, ``depth`` (h, w) float32 m along the optical axis (0: nothing), ``ids``
    (h, w) uint16 part numbers (0: nothing), ``slant`` (h, w) float32 cosine of incidence.
    """

    rgb: NDArray[np.uint8]
    depth: Float32
    ids: NDArray[np.uint16]
    slant: Float32


class Renderer(Protocol):
    """Draws what a pinhole camera sees."""

    @property
    def name(self) -> str:
        """Which renderer it is, as runs report it."""
        ...

    def view(self, pose: Array, intrinsics: Intrinsics, width: int, height: int) -> View:
        """The picture from ``pose`` (4, 4), the optical frame (z forward) in the building."""
        ...


@dataclass(frozen=True, eq=False)
class Shading:
    """The world's looks as plain arrays, the same for every renderer.

    ``parts`` (k, 8): texture layer, tiles a metre, gloss, pane (0 or 1), red, green, blue, and the
    room's number of each part; part 0 is the sky. Triangles have ``rooms`` (m,), numbers of the
    rooms they face. ``lamps`` (l, 6): position relative to the world's origin and colour, sorted
    by room; ``first`` (r + 1,): where each room's lamps begin.
    """

    parts: Float32
    rooms: NDArray[np.int32]
    lamps: Float32
    first: NDArray[np.int32]


def shading(world: World) -> Shading:
    """The looks of a world; a triangle without a room is lit by the nearest one's lamps."""
    numbers = room_numbers(world)
    parts = np.array(
        [
            [m.layer, 1.0 / m.scale, m.gloss, m.pane, *m.color, numbers.get(p.room or "", 0)]
            for p, m in zip(world.parts, world.materials)
        ],
        dtype=np.float32,
    )
    lamps = sorted(world.lamps, key=lambda lamp: numbers[lamp.room])
    table = np.array([[*(lamp.position - world.origin), *lamp.color] for lamp in lamps])
    owner = np.array([numbers[lamp.room] for lamp in lamps])
    first = np.searchsorted(owner, np.arange(len(numbers) + 2)).astype(np.int32)
    rooms = _rooms_faced(world, parts[:, 7].astype(np.int32), table[:, :3], owner)
    return Shading(parts, rooms, table.astype(np.float32), first)


def _rooms_faced(
    world: World, own: NDArray[np.int32], lamps: Array, owner: NDArray[np.int64]
) -> NDArray[np.int32]:
    """The room each triangle is lit in: its part's, else that of the nearest lamp it faces."""
    rooms = own[world.mesh.part]
    open_ = np.flatnonzero(rooms == 0)
    middle, normal = world.mesh.corners.mean(axis=1)[open_], world.mesh.normals[open_]
    for start in range(0, len(open_), 4096):
        rows = slice(start, start + 4096)
        to = lamps[None] - middle[rows][:, None]
        away = np.linalg.norm(to, axis=2)
        away = np.where(np.einsum("mli,mi->ml", to, normal[rows]) > 0, away, away + 1e3)
        rooms[open_[rows]] = owner[np.argmin(away, axis=1)]
    return rooms.astype(np.int32)


def make_renderer(world: World, wanted: Wanted) -> Renderer:
    """The renderer asked for; ``auto`` takes OpenGL where there is any.

    Raises:
        SituGraphError: ``gl`` is wanted and there is no OpenGL.
    """
    from situgraph.sim.render_cpu import CpuRenderer

    if wanted == "cpu":
        return CpuRenderer(world)
    from situgraph.sim.render_gl import GlRenderer, GlUnavailableError

    try:
        return GlRenderer(world)
    except GlUnavailableError as error:
        if wanted == "gl":
            raise SituGraphError(
                f"no OpenGL here ({error}); install libegl1 and libgl1-mesa-dri or use cpu"
            ) from error
        return CpuRenderer(world)
