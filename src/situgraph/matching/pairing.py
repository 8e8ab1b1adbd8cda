"""Which online room goes to which prior room: most rooms, then the largest sum of scores."""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

from typing import NamedTuple

import numpy as np

from situgraph.matching.compiled import kernel
from situgraph.matching.pointers import read
from situgraph.matching.tables import Floats, Ints

TIE = 1e-9  # share of a score by which smaller prior indices are preferred


class Options(NamedTuple):
    """The prior rooms that explain each online room at one placement, best first, N at most.

    More than N are never needed: the other rooms take N - 1 at most.
    """

    room: Ints  # (N, N)
    score: Floats  # (N, N)
    count: Ints  # type: ignore[assignment]  # (N,)
    owner: Ints  # (M,) how many rooms have a prior room as an option


@kernel
def new_options(rooms, prior_rooms):
    """No options yet."""
    return Options(
        np.empty((rooms, rooms), dtype=np.int64),
        np.empty((rooms, rooms)),
        np.zeros(rooms, dtype=np.int64),
        np.zeros(prior_rooms, dtype=np.int64),
    )


@kernel
def add_option(case, r, a, score):
    """Insert an option by descending score, then ascending index."""
    options = read(case.options)
    n = options.count[r]
    most = options.room.shape[1]
    if n == most:
        if score <= options.score[r, n - 1]:
            return
        n -= 1
    k = n
    while k > 0 and (
        options.score[r, k - 1] < score
        or (options.score[r, k - 1] == score and options.room[r, k - 1] > a)
    ):
        options.room[r, k] = options.room[r, k - 1]
        options.score[r, k] = options.score[r, k - 1]
        k -= 1
    options.room[r, k] = a
    options.score[r, k] = score
    options.count[r] = n + 1


@kernel
def pair_up(case, chosen):
    """Set ``chosen[r]`` to the prior room of each online room, -1 for none.

    Returns how many have one.
    """
    options = read(case.options)
    rooms = len(options.count)
    for r in range(rooms):
        for k in range(options.count[r]):
            options.owner[options.room[r, k]] += 1
    conflicts, pairs = 0, 0
    for r in range(rooms):
        chosen[r] = -1
        if options.count[r] == 0:
            continue
        # A room whose best option nobody else wants takes it.
        if options.owner[options.room[r, 0]] == 1:
            chosen[r] = options.room[r, 0]
            pairs += 1
        else:
            chosen[r] = -2
            conflicts += 1
    if conflicts > 0:
        pairs += _settle(case, chosen, conflicts)
    for r in range(rooms):
        for k in range(options.count[r]):
            options.owner[options.room[r, k]] = 0
    return pairs


@kernel
def _settle(case, chosen, conflicts):
    """Assign the rooms marked -2 among the prior rooms they have as options."""
    options = read(case.options)
    rows = np.empty(conflicts, dtype=np.int64)
    n = 0
    for r in range(len(chosen)):
        if chosen[r] == -2:
            rows[n] = r
            n += 1
    columns = np.empty(conflicts * options.room.shape[1], dtype=np.int64)
    m, spread = 0, 1.0
    for i in range(conflicts):
        r = rows[i]
        for k in range(options.count[r]):
            spread += abs(options.score[r, k])
            a = options.room[r, k]
            if options.owner[a] > 0:  # not met yet: from here on its column, negative
                columns[m] = a
                m += 1
                options.owner[a] = -m
    cost = np.zeros((conflicts, m + conflicts))
    bonus, tie = 4 * spread, TIE / len(options.owner)
    for i in range(conflicts):
        r = rows[i]
        for k in range(options.count[r]):
            a = options.room[r, k]
            cost[i, -options.owner[a] - 1] = -(bonus + options.score[r, k] - tie * a)
    taken = _cheapest(cost)
    pairs = 0
    for i in range(conflicts):
        if taken[i] < m and cost[i, taken[i]] < 0:
            chosen[rows[i]] = columns[taken[i]]
            pairs += 1
        else:
            chosen[rows[i]] = -1
    return pairs


@kernel
def _cheapest(cost):
    """The column of each row in the cheapest assignment (shortest augmenting paths)."""
    n, m = cost.shape
    row_price, column_price = np.zeros(n + 1), np.zeros(m + 1)
    owner, way = np.zeros(m + 1, dtype=np.int64), np.zeros(m + 1, dtype=np.int64)
    for i in range(1, n + 1):
        owner[0] = i
        at = 0
        least, used = np.full(m + 1, np.inf), np.zeros(m + 1, dtype=np.bool_)
        while owner[at] != 0:
            used[at] = True
            row, delta, following = owner[at], np.inf, -1
            for j in range(1, m + 1):
                if not used[j]:
                    value = cost[row - 1, j - 1] - row_price[row] - column_price[j]
                    if value < least[j]:
                        least[j] = value
                        way[j] = at
                    if least[j] < delta:
                        delta, following = least[j], j
            for j in range(m + 1):
                if used[j]:
                    row_price[owner[j]] += delta
                    column_price[j] -= delta
                else:
                    least[j] -= delta
            at = following
        while at != 0:
            owner[at] = owner[way[at]]
            at = way[at]
    column = np.empty(n, dtype=np.int64)
    for j in range(1, m + 1):
        if owner[j] > 0:
            column[owner[j] - 1] = j - 1
    return column
