"""The paper's filter: a pair is allowed when the prior node has at least the online node's objects.

Paper, section 'Object-semantic Filtering'; counts by category, at room and at plane level. A plane
may bound several rooms in one graph and not in the other, so like is compared with like: a row is
a plane as one room sees it, and holds those objects on the plane that are in the room.
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

from functools import cache
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from situgraph.matching.blocks import Block
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
    """Whether the prior row ``j`` holds what the online row ``i`` holds."""
    content = case.content
    if len(content.row_need) == 0:
        return True
    for k in range(content.row_first[i], content.row_first[i + 1]):
        if content.row_have[j, content.row_need[k, 0]] < content.row_need[k, 1]:
            return False
    return True


def stock_of(prior: SceneGraph, kept: Ints, first: Ints, source: Ints) -> Stock:
    """Counts of the prior rooms ``kept`` and of their rows.

    Rows ``first[k]`` to ``first[k + 1]`` are the planes ``source`` of room ``kept[k]``.
    """
    categories = tuple(sorted(prior.modelled))
    by_room, by_row = _counts(prior, kept, first, source, categories)
    return Stock(categories, by_room, by_row)


@cache
def no_content() -> Content:
    """Nothing is asked of any pair."""
    nothing = np.zeros((0, 2), dtype=np.int64)
    counts = np.zeros((0, 0), dtype=np.int16)
    first = np.zeros(0, dtype=np.int64)
    return _content(first, nothing, first, nothing, counts, counts)


def content_of(online: SceneGraph, stock: Stock, kept: Ints, first: Ints, source: Ints) -> Content:
    """What the online rooms and rows must find in the prior; arguments as those of ``stock_of``."""
    by_room, by_row = _counts(online, kept, first, source, stock.categories)
    return _content(*_needs(by_room), *_needs(by_row), stock.room_have, stock.row_have)


def _content(*values: Ints | Counts) -> Content:
    return Content(*values, Block.of(Content, values))  # type: ignore[call-arg, arg-type]


def _counts(
    graph: SceneGraph, kept: Ints, first: Ints, source: Ints, categories: tuple[str, ...]
) -> tuple[Counts, Counts]:
    """How many objects of each category (columns) rooms and rows have."""
    column = {c: k for k, c in enumerate(categories)}
    rooms = [graph.rooms[k].id for k in kept]
    room_at = {room: k for k, room in enumerate(rooms)}
    row_at = {
        (room, graph.planes[source[row]].id): row
        for room, begin, end in zip(rooms, first, first[1:])
        for row in range(begin, end)
    }
    by_room = np.zeros((len(rooms), len(column)), dtype=np.int16)
    by_row = np.zeros((len(source), len(column)), dtype=np.int16)
    for o in graph.objects:
        if o.category in column:
            by_room[[room_at[r] for r in o.rooms if r in room_at], column[o.category]] += 1
            faces = product(o.rooms, o.planes)
            by_row[[row_at[f] for f in faces if f in row_at], column[o.category]] += 1
    return by_room, by_row


def _needs(counts: Counts) -> tuple[Ints, Ints]:
    """Where the needs of each begin (n + 1,), and they: category, count (k, 2)."""
    at, category = np.nonzero(counts)
    first = np.searchsorted(at, np.arange(len(counts) + 1))
    need = np.stack([category, counts[at, category]], axis=1)
    return first.astype(np.int64), need.astype(np.int64)
