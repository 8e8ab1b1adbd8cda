"""Other objects in the rooms, and how many objects there are: density and symmetry."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from situgraph.geometry.poses import Array
from situgraph.plan.contacts import Faces, Index
from situgraph.plan.layout_items import (
    KINDS,
    OTHERS,
    Items,
    all_of,
    make_items,
    nothing,
    second_none,
)

Rng = np.random.Generator

# Other objects keep this distance (m) from each other and from openings where there is room.
ELBOW_ROOM = 0.9


def draw_others(
    count: int, faces: Faces, taken: Items, rng: Rng, fold: Callable[[Items], Items] | None = None
) -> Items:
    """``count`` objects in random rooms, clear of ``taken`` and of each other where possible.

    Wall-mounted ones hang on a random face of their room, the rest stand inside it. ``fold`` moves
    the drawn objects to the half of the floor that is drawn (global symmetry).
    """
    if count == 0:
        return nothing()
    drawn = _candidates(count + count // 2 + 8, faces, rng)
    drawn = fold(drawn) if fold else drawn
    together = all_of([taken, drawn])
    clear = _clear_of_earlier(together.center[:, :2])[taken.count :]
    order = np.concatenate([np.flatnonzero(clear), np.flatnonzero(~clear)])
    return drawn.rows(order[:count])


def thinned(items: Items, count: int, rng: Rng) -> Items:
    """``count`` of the objects, drawn evenly, in their old order."""
    return items.rows(np.sort(rng.choice(items.count, count, replace=False)))


def _candidates(count: int, faces: Faces, rng: Rng) -> Items:
    kind = rng.integers(len(KINDS) - len(OTHERS), len(KINDS), count)
    on_wall = np.array([k.on_wall for k in KINDS])[kind]
    width = np.array([k.width for k in KINDS])[kind]
    depth = np.array([k.depth for k in KINDS])[kind]
    # A room by lot, then one of its faces; the room's first face gives the frame inside it.
    first = np.searchsorted(faces.room, np.arange(int(faces.room.max()) + 2))
    room = rng.integers(0, len(first) - 1, count)
    sides = first[room + 1] - first[room]
    face = first[room] + (rng.random(count) * sides).astype(np.int64)
    direction, normal, length = faces.direction[face], faces.normal[face], faces.length[face]
    margin = np.minimum(0.5 * width + 0.1, 0.5 * length)
    along = margin + rng.random(count) * (length - 2.0 * margin)
    off = np.where(on_wall, 0.5 * depth, 0.0)
    center = faces.start[face] + along[:, None] * direction + off[:, None] * normal
    inside = _inside(faces, first, room, rng)
    center = np.where(on_wall[:, None], center, inside)
    pairs = second_none(np.where(on_wall, face, -1))
    return make_items(kind, center, direction, width, second_none(room), pairs)


def _inside(faces: Faces, first: Index, room: Index, rng: Rng) -> Array:
    """A random point well inside each room: between its middle and a point of one of its faces.

    The middle is that of the room's largest rectangle corner fan, so points of L-shaped rooms stay
    inside: a face is only aimed at from a point that sees all of it.
    """
    sides = first[room + 1] - first[room]
    face = first[room] + (rng.random(len(room)) * sides).astype(np.int64)
    target = faces.start[face] + rng.uniform(0.15, 0.85, len(room))[:, None] * (
        faces.end[face] - faces.start[face]
    )
    # Step in from the face by part of the clear depth in front of it.
    depth = _clear_depth(faces, first, room, target, faces.normal[face])
    step = np.sqrt(rng.random(len(room))) * 0.5 * depth
    return target + np.maximum(step, np.minimum(0.5, 0.5 * depth))[:, None] * faces.normal[face]


def _clear_depth(faces: Faces, first: Index, room: Index, point: Array, direction: Array) -> Array:
    """Distance (n,) from a point on a face straight through the room to the next face."""
    most = int(np.max(first[1:] - first[:-1]))
    best = np.full(len(room), np.inf)
    for k in range(most):
        face = np.minimum(first[room] + k, first[room + 1] - 1)
        normal, start = faces.normal[face], faces.start[face]
        toward = np.einsum("ij,ij->i", normal, direction)
        height = np.einsum("ij,ij->i", normal, point - start)
        with np.errstate(divide="ignore", invalid="ignore"):
            t = -height / toward
        hit = point + np.where(np.isfinite(t), t, 0.0)[:, None] * direction
        along = np.einsum("ij,ij->i", hit - start, faces.direction[face])
        ok = (toward < -1e-9) & (t > 1e-9) & (along > -1e-9) & (along < faces.length[face] + 1e-9)
        best = np.where(ok & (t < best), t, best)
    return np.where(np.isfinite(best), best, 0.0)


def _clear_of_earlier(center: Array) -> np.ndarray:
    """Which points have none of the kept points before them within ``ELBOW_ROOM``."""
    from scipy.spatial import cKDTree

    pairs = cKDTree(center).query_pairs(ELBOW_ROOM, output_type="ndarray")
    clear = np.ones(len(center), dtype=bool)
    clear[pairs[:, 1]] = False
    return clear


def arrangement(count: int, faces: Faces, rng: Rng) -> Items:
    """Local symmetry: the same ``count`` objects in every rectangular room.

    The arrangement is the same relative to each room's longer walls and maps onto itself by the
    room's half turn, so objects say neither which room nor which way round. Places are fractions of
    the walls. Rooms that are no rectangles stay empty. Every object belongs to one room: a door of
    the arrangement is that room's own.
    """
    first = np.searchsorted(faces.room, np.arange(int(faces.room.max()) + 2))
    rectangular = np.flatnonzero(np.diff(first) == 4)
    if count == 0 or len(rectangular) == 0:
        return nothing()
    base = first[rectangular]
    base = base + (faces.length[base + 1] > faces.length[base] + 1e-6)
    parts = [_slot(*slot, rectangular, base, first, faces) for slot in _slots(count, rng)]
    return all_of(parts)


def _slots(count: int, rng: Rng) -> list[tuple[int, int, float, float]]:
    """Kind, side and place (two fractions) of each object of an arrangement, by half-turn pairs."""
    slots: list[tuple[int, int, float, float]] = []
    if count % 2:
        slots.append((_kind_of("column"), -1, 0.5, 0.5))
    allowed = [k for k, kind in enumerate(KINDS) if kind.category != "stairs"]
    # A door and windows first, then anything; the pairs of one side share its length out.
    kinds = [n if n < 2 else int(rng.choice(allowed)) for n in range(count // 2)]
    sides = [int(rng.integers(2)) if KINDS[k].on_wall else -1 for k in kinds]
    placed = dict.fromkeys((-1, 0, 1), 0)
    for kind, side in zip(kinds, sides, strict=True):
        strip = (placed[side] + rng.uniform(0.35, 0.65)) / sides.count(side)
        placed[side] += 1
        u, v = 0.1 + 0.8 * strip, rng.uniform(0.2, 0.4)
        slots.append((kind, side, u, v))
        slots.append((kind, side + 2, u, v) if side >= 0 else (kind, -1, 1.0 - u, 1.0 - v))
    return slots


def _slot(
    kind: int, side: int, u: float, v: float, room: Index, base: Index, first: Index, faces: Faces
) -> Items:
    measures = KINDS[kind]
    start = first[room]
    face = start + (base - start + max(side, 0)) % 4
    direction, normal = faces.direction[face], faces.normal[face]
    length = faces.length[face][:, None]
    if side < 0:
        next_length = faces.length[start + (face - start + 1) % 4][:, None]
        center = faces.start[face] + u * length * direction + v * next_length * normal
        pairs = np.full((len(room), 2), -1)
    else:
        opening = measures.category in ("door", "window")
        off = 0.0 if opening else 0.5 * measures.depth
        center = faces.start[face] + u * length * direction + off * normal
        pairs = second_none(face)
    kinds = np.full(len(room), kind)
    width = np.full(len(room), measures.width)
    return make_items(kinds, center, direction, width, second_none(room), pairs)


def _kind_of(category: str) -> int:
    return next(i for i, kind in enumerate(KINDS) if kind.category == category)
