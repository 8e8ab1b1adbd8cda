"""The placement of the largest L for correspondences that are held: least squares."""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math

from situgraph.matching.compiled import part
from situgraph.matching.records import scratch
from situgraph.matching.slack import SLACK, wrapped
from situgraph.matching.tables import FIT, MOVED, WORK
from situgraph.matching.views import count_planes

STEPS = 6  # of Gauss-Newton: only the rotation is not linear, and hardly
AT_LIMIT = 1e-4  # metres from a limit, at which a plane can be what ends a way
# Which planes are kept from going over a limit: none, those at it, all.
KEPT_NONE, KEPT_AT_LIMITS, KEPT_ALL = range(3)
MOST_HELD = 3  # planes at once: a placement has no more freedom
STIFF = 1e6  # times the weight of a plane that is held
SOLVED = 60  # comparisons of planes that the steps from given sums are worth, about
SUMS = 16  # over the planes, of which all pulls are made


@part
def arm_of(seen, r, c, s):
    """From the mean room centre to that of room ``r``, turned by a yaw of this cosine and sine."""
    cx, cy = seen.center[r, 0], seen.center[r, 1]
    return c * cx - s * cy, s * cx + c * cy


@part
def offset_of(case, i, j, x, y):
    """By how much plane ``i`` is off from prior row ``j`` when its room's centre is at (x, y)."""
    row = case.plan.row
    return case.seen.distance[i] - (row[j, 0] * x + row[j, 1] * y + row[j, 2])


@part
def slide(case, at, inside, kept, out):
    """Into ``out`` the optimum for ``case.one`` where no plane that is ``kept`` goes over a limit.

    Those that would are held so far ``inside`` of it, one after the other. A straight way leaves
    such a limit when it turns; farther inside it can be longer. None is held afterwards. Where a
    plane would turn over the angle tolerance, the yaw is held.
    """
    view, sums, turn = case.one, scratch(SUMS), math.nan
    sum_pulls(case, view, at, inside, sums)
    _solve_at(sums, at, turn, out)
    for _ in range(MOST_HELD):
        worst = _most_over(case, view, kept, out)
        if worst >= 0:
            case.tally.held[worst] = 1
        elif math.isnan(turn):
            turn = _most_turned(case, view, wrapped(out[0] - at[0]), inside)
            if math.isnan(turn):
                break
        else:
            break
        sum_pulls(case, view, at, inside, sums)
        _solve_at(sums, at, turn, out)
    for i in range(len(view.state)):
        case.tally.held[i] = 0


@part
def _most_turned(case, view, turn, inside):
    """The turn at which the yaw is held, where planes at the limit would turn over it; else NaN.

    That is so far ``inside`` of the limit, but no farther than the middle of the yaws at which all
    planes are within the tolerance: those may be few.
    """
    low, high = -math.inf, math.inf
    for i in range(len(view.state)):
        if view.state[i] == FIT or view.state[i] == MOVED:
            low = max(low, -case.limits.angle - view.bend[i])
            high = min(high, case.limits.angle - view.bend[i])
    if turn > high + SLACK and high < AT_LIMIT:
        return max(high - inside, (low + high) / 2)
    if turn < low - SLACK and low > -AT_LIMIT:
        return min(low + inside, (low + high) / 2)
    return math.nan


@part
def _most_over(case, view, kept, goal):
    """The plane that is ``kept`` and would be farthest over a limit at ``goal``, -1 for none."""
    seen, limits = case.seen, case.limits
    if kept == KEPT_NONE:
        return -1
    worst, most = -1, SLACK
    c, s = math.cos(goal[0]), math.sin(goal[0])
    for r in range(len(view.room)):
        if view.room[r] < 0:
            continue
        ax, ay = arm_of(seen, r, c, s)
        for i in range(seen.first[r], seen.first[r + 1]):
            state, j = view.state[i], view.row[i]
            stop = limits.fit if state == FIT else limits.moved
            if (
                (state != FIT and state != MOVED)
                or case.tally.held[i]
                or (kept != KEPT_ALL and stop - abs(view.offset[i]) >= AT_LIMIT)
            ):
                continue
            over = abs(offset_of(case, i, j, goal[1] + ax, goal[2] + ay)) - stop
            if over > most:
                worst, most = i, over
    return worst


@part
def optimum(case, spot, at, inside, out):
    """Into ``out`` the placement (yaw, x, y) of the largest L for the correspondences in ``spot``.

    That must be the view at ``at``. Planes that are held stay so far ``inside`` of their limits.
    """
    sums = scratch(SUMS)
    sum_pulls(case, spot, at, inside, sums)
    _solve_at(sums, at, math.nan, out)


@part
def _solve_at(sums, at, held, out):
    """Into ``out`` the placement at which so much pulls nowhere; a turn that is not NaN is held."""
    system, step = scratch(9), scratch(3)
    turn, x, y = 0.0, 0.0, 0.0
    if not math.isnan(held):
        turn = held
        pull_of(sums, turn, x, y, system)
        x, y = _solve_held(system)
    for _ in range(STEPS if math.isnan(held) else 0):
        pull_of(sums, turn, x, y, system)
        if not solve(system, system[6], system[7], system[8], step):
            break
        turn -= step[0]
        x -= step[1]
        y -= step[2]
        if abs(step[0]) + abs(step[1]) + abs(step[2]) < 1e-12:
            break
    out[0] = wrapped(at[0] + turn)
    out[1] = at[1] + x
    out[2] = at[2] + y


@part
def _solve_held(system):
    """The step along x and y that a ``pull_of`` asks for at its yaw; none when singular."""
    a, b, c = system[3], system[4], system[5]
    det = a * c - b * b
    if not det > 1e-12 * abs(a * c):
        return 0.0, 0.0
    return (b * system[8] - c * system[7]) / det, (b * system[7] - a * system[8]) / det


@part
def sum_pulls(case, spot, at, inside, sums):
    """What each placement's ``pull_of`` is made of: weighted sums of products over the planes.

    A plane's offset is linear in what a step changes, ``o - x nx - y ny - (cos - 1) f - sin t``:
    from its room's centre, turned as ``at`` is, ``f`` leads along its normal and ``t`` across.
    """
    view = spot
    seen, plan, limits, tally = case.seen, case.plan, case.limits, case.tally
    case.found.count[WORK] += SOLVED + 3 * len(view.state)
    count_planes(case, spot)
    c, s = math.cos(at[0]), math.sin(at[0])
    for k in range(SUMS):
        sums[k] = 0.0
    for r in range(len(view.room)):
        if view.room[r] < 0:
            continue
        ax, ay = arm_of(seen, r, c, s)
        for i in range(seen.first[r], seen.first[r + 1]):
            state, p, j = view.state[i], seen.plane[i], view.row[i]
            fit, stop = state == FIT, limits.fit if state == FIT else limits.moved
            if not fit and state != MOVED:
                continue
            stiff = tally.held[i] == 1
            if fit or tally.sums[p, 0] == 0:
                weight = limits.angle_weight / tally.sums[p, 0 if fit else 3]
                sums[14] += weight
                sums[15] += weight * view.bend[i]
            if not (fit or stiff):
                continue
            o, weight = view.offset[i], limits.plane_weight
            if stiff:
                weight *= STIFF
                o -= math.copysign(stop - inside, o)
            else:
                weight /= tally.sums[p, 0]
            nx, ny = plan.row[j, 0], plan.row[j, 1]
            f, t = nx * ax + ny * ay, ny * ax - nx * ay
            wx, wy, wf, wt = weight * nx, weight * ny, weight * f, weight * t
            sums[0] += wx * o
            sums[1] += wy * o
            sums[2] += wf * o
            sums[3] += wt * o
            sums[4] += wx * nx
            sums[5] += wx * ny
            sums[6] += wx * f
            sums[7] += wx * t
            sums[8] += wy * ny
            sums[9] += wy * f
            sums[10] += wy * t
            sums[11] += wf * f
            sums[12] += wf * t
            sums[13] += wt * t


@part
def pull_of(sums, turn, x, y, system):
    """How the planes pull a step away: the symmetric matrix (upper half), then the slope (3).

    Of half of what is subtracted from L, along (yaw, x, y).
    """
    c, s = 1.0, 0.0
    if turn != 0.0:
        c, s = math.cos(turn), math.sin(turn)
    c1 = c - 1.0
    tx, ty = c * sums[7] - s * sums[6], c * sums[10] - s * sums[9]
    tf, tt = c * sums[12] - s * sums[11], c * sums[13] - s * sums[12]
    system[0] = sums[14] + c * tt - s * tf
    system[1], system[2] = tx, ty
    system[3], system[4], system[5] = sums[4], sums[5], sums[8]
    system[6] = sums[15] + sums[14] * turn
    system[6] -= c * sums[3] - s * sums[2] - x * tx - y * ty - c1 * tf - s * tt
    system[7] = x * sums[4] + y * sums[5] + c1 * sums[6] + s * sums[7] - sums[0]
    system[8] = x * sums[5] + y * sums[8] + c1 * sums[9] + s * sums[10] - sums[1]


@part
def solve(h, g0, g1, g2, out):
    """Solve the symmetric system ``h`` (upper half) for ``g``; False when singular."""
    a, b, c, d, e, f = h[0], h[1], h[2], h[3], h[4], h[5]
    m0, m1, m2 = d * f - e * e, c * e - b * f, b * e - c * d
    det = a * m0 + b * m1 + c * m2
    if not det > 1e-12 * abs(a * d * f):
        return False
    out[0] = (m0 * g0 + m1 * g1 + m2 * g2) / det
    out[1] = (m1 * g0 + (a * f - c * c) * g1 + (b * c - a * e) * g2) / det
    out[2] = (m2 * g0 + (b * c - a * e) * g1 + (a * d - b * b) * g2) / det
    return True
