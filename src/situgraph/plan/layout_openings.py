"""Doors between rooms, doors to the outside and windows of a floor."""

from __future__ import annotations

import numpy as np

from situgraph.plan.contacts import Contacts, Faces, Index, free_stretches
from situgraph.plan.layout_config import LayoutConfig
from situgraph.plan.layout_items import (
    DOOR,
    KINDS,
    WINDOW,
    Items,
    all_of,
    make_items,
    second_none,
)

Rng = np.random.Generator

# A door needs its width and this much wall on both sides of it (m).
DOOR_MARGIN = 0.15
# One window for each such length of outer wall (m), at most three.
WINDOW_PITCH = 2.4


def draw_openings(
    faces: Faces, contacts: Contacts, thickness: np.ndarray, config: LayoutConfig, rng: Rng
) -> Items:
    """Doors and windows: inner doors first, then exits, then windows.

    Inner doors join all rooms that share walls long enough for one (a random spanning tree) and a
    share of the other shared walls. Centres stand in the middle of the wall; ``thickness`` (n,) is
    that of the walls around each room.
    """
    inner = _inner_doors(faces, contacts, config, rng)
    face, low, high = free_stretches(faces, contacts)
    outside = 0.5 * thickness[faces.room[face]]
    is_exit = _choose_exits(high - low, len(thickness), config, rng)
    exits = _on_outside(
        np.full(int(is_exit.sum()), KINDS.index(DOOR)),
        faces,
        face[is_exit],
        _within(low[is_exit], high[is_exit], 0.5 * DOOR.width + DOOR_MARGIN, rng),
        outside[is_exit],
        np.full(int(is_exit.sum()), DOOR.width),
    )
    keep = ~is_exit
    windows = _windows(faces, face[keep], low[keep], high[keep], outside[keep], config, rng)
    return all_of([inner, exits, windows])


def _inner_doors(faces: Faces, contacts: Contacts, config: LayoutConfig, rng: Rng) -> Items:
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import minimum_spanning_tree

    need = DOOR.width + 2.0 * DOOR_MARGIN
    wide = np.flatnonzero(contacts.high - contacts.low >= need)
    a, b = faces.room[contacts.a[wide]], faces.room[contacts.b[wide]]
    # Two rooms may share several faces; the heaviest of random weights decides, one each.
    weight = 1.0 + rng.random(len(wide))
    count = int(faces.room.max()) + 1 if len(faces.room) else 0
    order = np.lexsort((weight, np.maximum(a, b), np.minimum(a, b)))
    pair = np.minimum(a, b)[order] * count + np.maximum(a, b)[order]
    one = order[np.concatenate([[True], pair[1:] != pair[:-1]])] if len(order) else order
    graph = coo_array((weight[one], (a[one], b[one])), shape=(count, count))
    tree = minimum_spanning_tree(graph.tocsr()).tocoo()
    in_tree = np.isin(a[one] * count + b[one], tree.row.astype(np.int64) * count + tree.col)
    chosen = one[in_tree | (rng.random(len(one)) < config.loop_doors)]
    at = wide[chosen]
    along = _within(contacts.low[at], contacts.high[at], 0.5 * DOOR.width + DOOR_MARGIN, rng)
    face = contacts.a[at]
    direction, normal = faces.direction[face], faces.normal[face]
    center = faces.start[face] + along[:, None] * direction
    center = center - 0.5 * contacts.gap[at][:, None] * normal
    pairs = np.stack([face, contacts.b[at]], axis=1)
    kind = np.full(len(at), KINDS.index(DOOR))
    width = np.full(len(at), DOOR.width)
    return make_items(kind, center, direction, width, faces.room[pairs], pairs)


def _choose_exits(length: np.ndarray, rooms: int, config: LayoutConfig, rng: Rng) -> np.ndarray:
    """A mask of the free stretches that get a door to the outside."""
    fits = np.flatnonzero(length >= DOOR.width + 2.0 * DOOR_MARGIN)
    number = min(len(fits), max(1, round(rooms / config.rooms_per_exit)))
    mask = np.zeros(len(length), dtype=bool)
    mask[rng.choice(fits, number, replace=False)] = True
    return mask


def _windows(
    faces: Faces,
    face: Index,
    low: np.ndarray,
    high: np.ndarray,
    outside: np.ndarray,
    config: LayoutConfig,
    rng: Rng,
) -> Items:
    """One to three windows on each free stretch, spread evenly with some play."""
    number = np.clip(np.floor((high - low) / WINDOW_PITCH + 0.1), 0, 3).astype(np.int64)
    row = np.repeat(np.arange(len(face)), number)
    first = np.cumsum(number) - number
    k = np.arange(len(row)) - first[row]
    kept = rng.random(len(row)) < config.window_share
    width = rng.uniform(1.2, 1.6, len(row))
    pitch = (high - low)[row] / np.maximum(number[row], 1)
    play = np.maximum(0.5 * (pitch - width) - DOOR_MARGIN, 0.0)
    along = low[row] + (k + 0.5) * pitch + play * rng.uniform(-1.0, 1.0, len(row))
    row, along, width = row[kept], along[kept], width[kept]
    kind = np.full(len(row), KINDS.index(WINDOW))
    return _on_outside(kind, faces, face[row], along, outside[row], width)


def _on_outside(
    kind: Index,
    faces: Faces,
    face: Index,
    along: np.ndarray,
    outside: np.ndarray,
    width: np.ndarray,
) -> Items:
    direction = faces.direction[face]
    center = faces.start[face] + along[:, None] * direction
    center = center - outside[:, None] * faces.normal[face]
    room = second_none(faces.room[face])
    return make_items(kind, center, direction, width, room, second_none(face))


def _within(low: np.ndarray, high: np.ndarray, margin: float, rng: Rng) -> np.ndarray:
    """A random place in each stretch, at least ``margin`` m from its ends."""
    spare = np.maximum(high - low - 2.0 * margin, 0.0)
    return np.asarray(low + margin + rng.random(len(low)) * spare)
