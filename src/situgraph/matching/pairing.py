"""Which online room goes to which prior room: most rooms, then the largest sum of scores.

Walls are lines without ends, so those of one corridor are those of the next in line as well: the
score of a pair is what its walls say, less for a room whose centre is far from the prior one's.
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

from situgraph.matching.compiled import part
from situgraph.matching.tables import WORK

TIE = 1e-9  # share of a score by which smaller prior indices are preferred


@part
def astray(case, a, x, y):
    """What a room whose centre is at ``(x, y)`` loses as one explained by ``a``."""
    middle = case.plan.middle
    dx, dy = x - middle[a, 0], y - middle[a, 1]
    return (dx * dx + dy * dy) * middle[a, 2]


@part
def add_option(case, r, a, score):
    """Insert an option by descending score, then ascending index."""
    options = case.options
    n = options.count[r]
    most = len(options.count)
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


@part
def contested(case):
    """Whether a prior room is an option of two rooms."""
    options, twice = case.options, False
    for r in range(len(options.count)):
        for k in range(options.count[r]):
            options.owner[options.room[r, k]] += 1
            twice = twice or options.owner[options.room[r, k]] > 1
    for r in range(len(options.count)):
        for k in range(options.count[r]):
            options.owner[options.room[r, k]] = 0
    return twice


@part
def pair_up(case, chosen):
    """Set ``chosen[r]`` to the prior room of each online room, -1 for none.

    Returns how many have one.
    """
    options = case.options
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


@part
def _settle(case, chosen, conflicts):
    """Assign the rooms marked -2 among the prior rooms they have as options: shortest paths.

    Each row is added by the cheapest path of exchanges (Jonker and Volgenant's method, on the
    options alone). Going without costs nothing, a room brings more than all scores together.
    """
    options, work = case.options, case.pairing
    rows, n, spread = work.rows, 0, 1.0
    for r in range(len(chosen)):
        if chosen[r] == -2:
            rows[n] = r
            n += 1
            for k in range(options.count[r]):
                spread += abs(options.score[r, k])
    bonus, used = 4 * spread, 0
    for i in range(n):
        used = _add_row(case, i, bonus, used)
    pairs = 0
    for i in range(n):
        if work.column[i] < len(options.owner):
            chosen[rows[i]] = work.column[i]
            pairs += 1
        else:
            chosen[rows[i]] = -1
    for k in range(used):  # leave it as it was found
        j = work.used[k]
        work.mark[j] = 0
        work.price[j] = 0.0
        work.owner[j] = 0
    return pairs


@part
def _add_row(case, start, bonus, used):
    """Find the cheapest path from row ``start`` to a free column, and exchange along it.

    ``owner`` is kept one higher, so that zero means none. Returns how many columns have been met
    in all.
    """
    options, work = case.options, case.pairing
    prior, tie = len(options.owner), TIE / len(options.owner)
    met, i, length, end = 0, start, 0.0, -1
    work.rent[start] = 0.0
    while end < 0:
        r = work.rows[i]
        for k in range(options.count[r] + 1):
            j, cost = prior + i, 0.0
            if k < options.count[r]:
                j = options.room[r, k]
                cost = -(bonus + options.score[r, k] - tie * j)
            if work.mark[j] == 2:
                continue
            reach = length + cost - work.rent[i] - work.price[j]
            if work.mark[j] != 1:
                if work.mark[j] == 0:
                    work.used[used] = j
                    used += 1
                work.mark[j] = 1
                work.met[met] = j
                met += 1
            elif reach >= work.near[j]:
                continue
            work.near[j] = reach
            work.way[j] = i
        best = -1
        for k in range(met):
            j = work.met[k]
            if work.mark[j] == 1 and (best < 0 or work.near[j] < work.near[best]):
                best = j
        case.found.count[WORK] += met + options.count[r]
        length = work.near[best]
        work.mark[best] = 2
        if work.owner[best] == 0:
            end = best
        else:
            i = work.owner[best] - 1
    work.rent[start] += length
    for k in range(met):
        j = work.met[k]
        if work.mark[j] == 2 and j != end:
            work.rent[work.owner[j] - 1] += length - work.near[j]
            work.price[j] -= length - work.near[j]
        work.mark[j] = 3
    i = -1
    while i != start:
        i = work.way[end]
        work.owner[end] = i + 1
        following = work.column[i]
        work.column[i] = end
        end = following
    return used
