"""What stands behind a room's face: how much of its length has a wall, and which one."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import msgspec
import numpy as np
from numpy.typing import NDArray

from situgraph.geometry.poses import Array
from situgraph.plan.building import Element
from situgraph.plan.config import PlanConfig
from situgraph.plan.faces import Face, Span, vertical_faces

PARALLEL = float(np.cos(np.radians(5.0)))
STEP = 0.2  # m; a wall that begins this far above a room's floor still stands on it
HALF = 0.5  # a wall stands behind a stretch of face when it covers this share of its height


class Backing(msgspec.Struct, frozen=True):
    """``share`` of a face's length with a wall behind, the wall's ``key`` and its ``gap`` (m)."""

    share: float
    key: int | None = None
    gap: float | None = None


class WallFaces(msgspec.Struct, frozen=True):
    """The vertical faces of all walls, one row a stretch; normals leave the wall.

    ``normal`` (n, 2), ``ends`` (n, 2, 2) and ``middle`` (n, 2) in the plan, heights ``bottom`` and
    ``top`` (n,), and ``key`` (n,), the number of the wall each belongs to.
    """

    normal: Array
    ends: Array
    middle: Array
    bottom: Array
    top: Array
    key: NDArray[np.int64]

    def rows(self, chosen: NDArray[np.intp]) -> WallFaces:
        """Some of the rows."""
        return WallFaces(*(getattr(self, f)[chosen] for f in self.__struct_fields__))


def wall_faces(walls: Sequence[Element], config: PlanConfig) -> WallFaces:
    """The vertical faces of walls."""
    rows: list[tuple[float, ...]] = []
    for wall in walls:
        for f in vertical_faces(wall.mesh, config):
            rows += [
                (*f.normal, *f.point(lo), *f.point(hi), f.bottom, f.top, wall.key)
                for lo, hi in f.spans
            ]
    table = np.array(rows, dtype=float).reshape(-1, 9)
    ends = table[:, 2:6].reshape(-1, 2, 2)
    keys = table[:, 8].astype(np.int64)
    return WallFaces(table[:, :2], ends, ends.mean(axis=1), table[:, 6], table[:, 7], keys)


def backing(face: Face, walls: WallFaces, config: PlanConfig) -> Backing:
    """How much of a room's face has a wall face of the same sense within ``wall_gap``.

    A room's inward normal and the outward normal of the wall behind it point the same way. Both
    signs of the distance count: some models draw rooms to the middle of their walls.
    """
    found, along, gaps = _near(face, walls, config.wall_gap)
    if not len(gaps):
        return Backing(0.0)
    covered = 0.0
    share_of: dict[int, float] = {}
    gap_of: dict[int, float] = {}
    for lo, hi in _stretches(face.spans, along):
        over = np.flatnonzero((along[:, 0] <= lo + 1e-9) & (along[:, 1] >= hi - 1e-9))
        if not len(over) or not _stands(found, over, face, config.knee_wall):
            continue
        covered += hi - lo
        best = over[np.argmin(np.abs(gaps[over]))]
        key = int(found.key[best])
        share_of[key] = share_of.get(key, 0.0) + hi - lo
        gap_of[key] = float(gaps[best])
    if not share_of:
        return Backing(0.0)
    key = max(sorted(share_of), key=lambda k: share_of[k])
    return Backing(min(1.0, covered / face.length), key, gap_of[key])


def _near(face: Face, walls: WallFaces, gap: float) -> tuple[WallFaces, Array, Array]:
    """Wall faces within ``gap``: the rows, where they begin and end along the face, their gaps."""
    n = np.array(face.normal)
    rows = np.flatnonzero(walls.normal @ n >= PARALLEL)
    rows = rows[np.abs(walls.middle[rows] @ n + face.offset) <= gap + 1e-6]
    rows = rows[(walls.top[rows] > face.bottom) & (walls.bottom[rows] < face.top)]
    along = np.sort(walls.ends[rows] @ np.array(face.tangent), axis=1)
    beside = (along[:, 1] > face.low) & (along[:, 0] < face.high)
    found = walls.rows(rows[beside])
    return found, along[beside], -(found.middle @ n + face.offset)


def _stretches(spans: Sequence[Span], along: Array) -> list[Span]:
    """The face's stretches cut wherever a wall face begins or ends."""
    out: list[Span] = []
    for lo, hi in spans:
        inner = along[(along > lo) & (along < hi)]
        cuts = np.unique(np.concatenate([[lo, hi], inner])).tolist()
        out += [(a, b) for a, b in pairwise(cuts) if b - a > 1e-6]
    return out


def _stands(walls: WallFaces, rows: NDArray[np.intp], face: Face, knee: float) -> bool:
    """Whether these wall faces cover half of the face's height, or stand ``knee`` m on its floor.

    A knee wall below a roof is a wall; a lintel over a passage is none.
    """
    low = np.maximum(walls.bottom[rows], face.bottom)
    high = np.minimum(walls.top[rows], face.top)
    total, reached, standing = 0.0, -np.inf, face.bottom + STEP
    for k in np.argsort(low, kind="stable"):
        total += max(0.0, float(high[k] - max(low[k], reached)))
        reached = max(reached, float(high[k]))
        standing = max(standing, float(high[k])) if low[k] <= standing else standing
    return total >= HALF * face.height or standing - face.bottom >= max(knee, 2.0 * STEP)
