"""Section 2 of ``docs/matching.md``: whether a prior room explains an online room, and how.

Both tests take a box of placements: the yaw within ``turn`` of ``yaw``, the room's centre near
``(x, y)``. ``Slack`` says by how much a residual can change inside the box; with no slack the
tests are strict.
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math

from situgraph.matching.assignment import assign_planes
from situgraph.matching.compiled import part
from situgraph.matching.containment import plane_allowed
from situgraph.matching.effort import exhausted
from situgraph.matching.plain import COS, SIN, may_plain, plain_pair
from situgraph.matching.slack import SLACK, give, wrapped
from situgraph.matching.strands import MANY, row_at, rows_near
from situgraph.matching.tables import FIT, MISSING, MOVED, WORK

MOST_STEPS = 1_000  # of a search among the counterparts of all planes at once
FORCE = 1e6  # by which a plane is kept from what does not fit
MOST_TOGETHER = 8  # planes of a room of which that is tried


@part
def may_explain(case, r, a, yaw, x, y, slack):
    """A quick necessary test: counterparts and fitting planes are counted, not assigned."""
    seen, plan, limits = case.seen, case.plan, case.limits
    missing = 0
    case.found.count[WORK] += min(plan.first[a + 1] - plan.first[a], MANY)
    if plain_pair(case, r, a):
        c, s = plan.plain[a, COS], plan.plain[a, SIN]
        along, across = give(slack, c, s), give(slack, -s, c)
        return may_plain(case, r, a, yaw, slack.turn, x, y, along, across)
    first_fit = 0.0
    fits, crossed = 0, False
    begin, end = seen.first[r], seen.first[r + 1]
    allowed = 0 if seen.strict[r] else 1
    for i in range(begin, end):
        near, fit = False, False
        top, rows = rows_near(case, a, i, yaw, x, y, limits.moved, slack)
        for c in range(rows):
            j = row_at(case, top, c)
            bend = wrapped(seen.angle[i] + yaw - plan.row[j, 3])
            if abs(bend) > limits.angle + slack.turn + SLACK:
                continue
            nx, ny = plan.row[j, 0], plan.row[j, 1]
            off = abs(seen.distance[i] - (nx * x + ny * y + plan.row[j, 2]))
            off -= give(slack, nx, ny) + SLACK
            if off <= limits.fit:
                near, fit = True, True
                break
            if off <= limits.moved:
                near = True
        if fit:
            if fits == 0:
                first_fit = seen.angle[i]
            elif abs(math.sin(seen.angle[i] - first_fit)) >= limits.sine:
                crossed = True
            fits += 1
        if not near or (seen.strict[r] and not fit):
            missing += 1
            if missing > allowed:
                return False
    if seen.strict[r]:
        return True
    return crossed or (fits >= 2 and _any_crossed(case, r, a, yaw, x, y, slack))


@part
def _any_crossed(case, r, a, yaw, x, y, slack):
    """Whether two planes that may fit are not parallel, the first one aside."""
    seen, limits = case.seen, case.limits
    for i in range(seen.first[r], seen.first[r + 1]):
        if not _may_fit(case, i, a, yaw, x, y, slack):
            continue
        for k in range(i + 1, seen.first[r + 1]):
            if abs(math.sin(seen.angle[i] - seen.angle[k])) >= limits.sine and _may_fit(
                case, k, a, yaw, x, y, slack
            ):
                return True
    return False


@part
def _may_fit(case, i, a, yaw, x, y, slack):
    seen, plan, limits = case.seen, case.plan, case.limits
    top, rows = rows_near(case, a, i, yaw, x, y, limits.fit, slack)
    for c in range(rows):
        j = row_at(case, top, c)
        bend = wrapped(seen.angle[i] + yaw - plan.row[j, 3])
        if abs(bend) > limits.angle + slack.turn + SLACK:
            continue
        nx, ny = plan.row[j, 0], plan.row[j, 1]
        off = abs(seen.distance[i] - (nx * x + ny * y + plan.row[j, 2]))
        if off - give(slack, nx, ny) <= limits.fit + SLACK:
            return True
    return False


@part
def explain(case, r, a, yaw, x, y, slack):
    """The room score of the best assignment that explains ``r`` by ``a``; -inf when none does.

    The assignment is left in ``bench.kept`` (prior rows, -1 for missing) and ``bench.state``.
    """
    seen, limits, bench = case.seen, case.limits, case.bench
    begin = seen.first[r]
    n = seen.first[r + 1] - begin
    bare = 0
    strict = seen.strict[r]
    for i in range(n):
        count = _counterparts(case, begin + i, i, a, yaw, x, y, slack, strict)
        if count == 0:
            bare += 1
            if strict or bare > 1:
                return -math.inf
        if not strict:
            _insert(case, i, count, -1, limits.missing, MISSING)
            count += 1
        bench.count[i] = count
    bench.best[n] = 0.0
    for i in range(n - 1, -1, -1):
        bench.best[i] = bench.best[i + 1] + bench.value[i, 0]
    for i in range(n):
        bench.pick[i] = 0
    if _holds(case, begin, n, strict):
        return _keep(case, n)
    if n <= MOST_TOGETHER:
        score = _search(case, begin, n, strict)
        if score < math.inf:
            return score
    if not (strict or _can_cross(case, begin, n)) or not assign_planes(case, n, a):
        return -math.inf
    # With residuals widened it only has to be possible.
    if slack.turn > 0 or slack.hu > 0 or _holds(case, begin, n, strict):
        return _keep(case, n)
    return _best_held(case, begin, n, a)


@part
def _counterparts(case, plane, i, a, yaw, x, y, slack, strict):
    """List the prior planes that plane ``i`` can correspond to, the likeliest first."""
    seen, plan, limits = case.seen, case.plan, case.limits
    count = 0
    top, rows = rows_near(case, a, plane, yaw, x, y, limits.moved, slack)
    for c in range(rows):
        j = row_at(case, top, c)
        bend = wrapped(seen.angle[plane] + yaw - plan.row[j, 3])
        if abs(bend) > limits.angle + slack.turn + SLACK:
            continue
        nx, ny = plan.row[j, 0], plan.row[j, 1]
        off = seen.distance[plane] - (nx * x + ny * y + plan.row[j, 2])
        short = abs(off) - give(slack, nx, ny) - SLACK
        if short > limits.moved or (strict and short > limits.fit):
            continue
        if not plane_allowed(case, plane, j):
            continue
        tilt = bend * bend * limits.angle_weight
        if short <= limits.fit:
            value = limits.fit_peak - off * off * limits.plane_weight - tilt
            _insert(case, i, count, j, value, FIT)
        else:
            _insert(case, i, count, j, limits.moved_base - tilt, MOVED)
        count += 1
    return count


@part
def _insert(case, i, count, row, value, state):
    """Insert by descending value; equal values stay in order."""
    bench = case.bench
    k = count
    while k > 0 and bench.value[i, k - 1] < value:
        bench.row[i, k] = bench.row[i, k - 1]
        bench.value[i, k] = bench.value[i, k - 1]
        bench.fits[i, k] = bench.fits[i, k - 1]
        k -= 1
    bench.row[i, k] = row
    bench.value[i, k] = value
    bench.fits[i, k] = state


@part
def _holds(case, begin, n, strict):
    """Whether the picked counterparts are distinct and meet the conditions."""
    seen, limits, bench = case.seen, case.limits, case.bench
    missing = 0
    for i in range(n):
        row = bench.row[i, bench.pick[i]]
        if row < 0:
            missing += 1
            if missing > 1:
                return False
            continue
        for k in range(i):
            if bench.row[k, bench.pick[k]] == row:
                return False
    if strict:
        return True
    for i in range(n):
        if bench.fits[i, bench.pick[i]] != FIT:
            continue
        for k in range(i):
            if bench.fits[k, bench.pick[k]] == FIT and (
                abs(math.sin(seen.angle[begin + i] - seen.angle[begin + k])) >= limits.sine
            ):
                return True
    return False


@part
def _best_held(case, begin, n, a):
    """The best of the assignments in which two planes fit and cross; -inf when there is none.

    For when the best of all lacks them: each such pair is made to fit in turn.
    """
    seen, limits, bench, best = case.seen, case.limits, case.bench, -math.inf
    for i in range(n):
        if not _can_fit(bench, i) or exhausted(case):
            continue
        _force(bench, i, FORCE)
        if assign_planes(case, n, a) and bench.fits[i, bench.pick[i]] == FIT:
            for k in range(i):
                turn = abs(math.sin(seen.angle[begin + i] - seen.angle[begin + k]))
                if turn < limits.sine or not _can_fit(bench, k) or exhausted(case):
                    continue
                _force(bench, k, FORCE)
                if assign_planes(case, n, a) and _holds(case, begin, n, False):
                    score = 0.0
                    for p in range(n):
                        score += bench.value[p, bench.pick[p]]
                    if score > best:
                        best = _keep(case, n)
                _force(bench, k, -FORCE)
        _force(bench, i, -FORCE)
    return best


@part
def _force(bench, i, by):
    """Keep plane ``i`` from what does not fit, or no longer."""
    for k in range(bench.count[i]):
        if bench.fits[i, k] != FIT:
            bench.value[i, k] -= by


@part
def _can_cross(case, begin, n):
    """Whether two planes that are not parallel have counterparts that fit."""
    seen, limits, bench = case.seen, case.limits, case.bench
    case.found.count[WORK] += n * n // 2
    for i in range(n):
        if not _can_fit(bench, i):
            continue
        for k in range(i):
            turn = abs(math.sin(seen.angle[begin + i] - seen.angle[begin + k]))
            if turn >= limits.sine and _can_fit(bench, k):
                return True
    return False


@part
def _can_fit(bench, i):
    for k in range(bench.count[i]):  # noqa: SIM110
        if bench.fits[i, k] == FIT:
            return True
    return False


@part
def _keep(case, n):
    """Keep the picked counterparts; returns the sum of their values."""
    bench = case.bench
    score = 0.0
    for i in range(n):
        score += bench.value[i, bench.pick[i]]
        bench.kept[i] = bench.row[i, bench.pick[i]]
        bench.state[i] = bench.fits[i, bench.pick[i]]
    return score


@part
def _search(case, begin, n, strict):
    """Depth first over the counterparts, cut by the best sum that the rest can add.

    Returns the best sum, -inf for none, inf when the steps did not do to find it.
    """
    bench = case.bench
    best, depth, total, missing = -math.inf, 0, 0.0, 0
    for i in range(n):
        bench.pick[i] = -1
    for _ in range(MOST_STEPS):
        case.found.count[WORK] += 1
        if bench.pick[depth] >= 0:  # take back the choice that was tried
            k = bench.pick[depth]
            total -= bench.value[depth, k]
            missing -= bench.row[depth, k] < 0
        bench.pick[depth] += 1
        k = bench.pick[depth]
        if k >= bench.count[depth] or total + bench.value[depth, k] + bench.best[depth + 1] <= best:
            bench.pick[depth] = -1
            depth -= 1
            if depth < 0:
                return best
            continue
        total += bench.value[depth, k]
        missing += bench.row[depth, k] < 0
        if missing > 1 or _taken(case, depth):
            continue
        if depth + 1 < n:
            depth += 1
        elif _holds(case, begin, n, strict):
            best = total
            _keep(case, n)
    return math.inf


@part
def _taken(case, depth):
    bench = case.bench
    row = bench.row[depth, bench.pick[depth]]
    if row < 0:
        return False
    for k in range(depth):  # noqa: SIM110
        if bench.row[k, bench.pick[k]] == row:
            return True
    return False
