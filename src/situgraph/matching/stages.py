"""How many pairs of rooms and of planes each stage kept, as the match JSON counts them."""

from __future__ import annotations

import numpy as np

from situgraph.matching.preparation import Inputs
from situgraph.matching.tables import FIT, MOVED, Floats, Ints

MOST_VIEWS = 200  # candidates whose plane pairs are counted


def room_candidates(inputs: Inputs, alike: Ints) -> dict[str, int]:
    """Room pairs by type, after the semantic stage, and alike in shape.

    Rooms without a shape (two planes, or parallel ones) stay pairs with all rooms they may have.
    """
    allowed = _allowed_rooms(inputs)
    shaped = inputs.seen.shape > 0
    return {
        "type": len(inputs.kept) * inputs.index.rooms,
        "semantic": int(allowed.sum()),
        "geometric": int(np.where(shaped, alike, allowed).sum()),
    }


def plane_candidates(inputs: Inputs, shift: Ints, at: Floats) -> dict[str, int]:
    """Plane pairs of all room pairs, those the semantic stage allows, and those of the candidates.

    ``shift`` (k,) and ``at`` (k, 3: yaw, x, y) are the candidates.
    """
    rows, columns = len(inputs.source), len(inputs.index.source)
    content = inputs.content
    semantic = rows * columns
    for i in range(len(content.row_first) - 1):
        need = content.row_need[content.row_first[i] : content.row_first[i + 1]]
        if len(need):
            enough = (content.row_have[:, need[:, 0]] >= need[:, 1]).all(axis=1)
            semantic -= columns - int(enough.sum())
    pairs: set[tuple[int, int]] = set()
    views = inputs.views(shift[:MOST_VIEWS], at[:MOST_VIEWS])
    places, held = np.nonzero((views.state == FIT) | (views.state == MOVED))
    pairs.update(zip(held.tolist(), views.row[places, held].tolist()))
    return {"type": rows * columns, "semantic": semantic, "geometric": len(pairs)}


def _allowed_rooms(inputs: Inputs) -> Ints:
    """For each online room how many prior rooms the semantic stage allows."""
    rooms, content = len(inputs.kept), inputs.content
    allowed = np.full(rooms, inputs.index.rooms, dtype=np.int64)
    for r in range(len(content.room_first) - 1):
        need = content.room_need[content.room_first[r] : content.room_first[r + 1]]
        if len(need):
            enough = (content.room_have[:, need[:, 0]] >= need[:, 1]).all(axis=1)
            allowed[r] = int(enough.sum())
    return allowed
