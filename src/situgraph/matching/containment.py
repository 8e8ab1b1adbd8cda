"""The paper's filter: a pair is allowed when the prior node has at least the online node's objects.

Paper, section 'Object-semantic Filtering'; counts by category, at room and at plane level.
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from situgraph.matching.compiled import part
from situgraph.matching.tables import Content, Ints
from situgraph.scenegraph.graph import SceneGraph

Counts = NDArray[np.int16]


class Stock(NamedTuple):
    """The prior's side of ``Content``: its modelled categories in order, and their counts."""

    categories: tuple[str, ...]
    room_have: Counts  # (M, C)
    row_have: Counts  # (Q, C)


@part
def room_allowed(case, r, a):
    """Whether prior room ``a`` holds what online room ``r`` holds."""
    content = case.content
    if len(content.room_need) == 0:
        return True
    for k in range(content.room_first[r], content.room_first[r + 1]):
        if content.room_have[a, content.room_need[k, 0]] < content.room_need[k, 1]:
            return False
    return True


@part
def may_be(case, r, a):
    """Whether prior room ``a`` is allowed for ``r``, and explains it in isolation."""
    return (case.found.like[r, a >> 6] >> (a & 63)) & 1 == 1


@part
def plane_allowed(case, i, j):
    """Whether the prior plane of row ``j`` holds what the online plane of row ``i`` holds."""
    content = case.content
    if len(content.row_need) == 0:
        return True
    for k in range(content.row_first[i], content.row_first[i + 1]):
        if content.row_have[j, content.row_need[k, 0]] < content.row_need[k, 1]:
            return False
    return True


def stock_of(prior: SceneGraph, rooms: Ints, rows: Ints) -> Stock:
    """Counts of the prior rooms (indices) and of the planes of its rows (indices)."""
    categories = tuple(sorted(prior.modelled))
    column = {c: k for k, c in enumerate(categories)}
    room_row = {r.id: k for k, r in enumerate(prior.rooms)}
    plane_row = {p.id: k for k, p in enumerate(prior.planes)}
    by_room = np.zeros((len(prior.rooms), len(categories)), dtype=np.int16)
    by_plane = np.zeros((len(prior.planes), len(categories)), dtype=np.int16)
    for o in prior.objects:
        c = column.get(o.category)
        if c is not None:
            for room in o.rooms:
                by_room[room_row[room], c] += 1
            for plane in o.planes:
                by_plane[plane_row[plane], c] += 1
    return Stock(categories, by_room[rooms], by_plane[rows])


def no_content() -> Content:
    """Nothing is asked of any pair."""
    nothing = np.zeros((0, 2), dtype=np.int64)
    counts = np.zeros((0, 0), dtype=np.int16)
    first = np.zeros(0, dtype=np.int64)
    return Content(first, nothing, first, nothing, counts, counts)


def content_of(online: SceneGraph, stock: Stock, rooms: list[str], rows: list[str]) -> Content:
    """What the online rooms (ids) and the planes of the rows (ids) must find in the prior."""
    column = {c: k for k, c in enumerate(stock.categories)}
    room_first, room_need = _needs(online.objects_by_room, rooms, column)
    row_first, row_need = _needs(online.objects_by_plane, rows, column)
    return Content(room_first, room_need, row_first, row_need, stock.room_have, stock.row_have)


def _needs(held: object, names: list[str], column: dict[str, int]) -> tuple[Ints, Ints]:
    first, need = [0], []
    for name in names:
        counts: dict[int, int] = {}
        for o in held.get(name, ()):  # type: ignore[attr-defined]
            if o.category in column:
                counts[column[o.category]] = counts.get(column[o.category], 0) + 1
        need += sorted(counts.items())
        first.append(len(need))
    return np.array(first, dtype=np.int64), np.array(need, dtype=np.int64).reshape(-1, 2)
