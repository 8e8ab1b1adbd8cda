"""The placement of the largest L for correspondences that are held: least squares."""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math

from situgraph.matching.compiled import part
from situgraph.matching.records import scratch
from situgraph.matching.slack import SLACK, wrapped
from situgraph.matching.tables import FIT, MOVED
from situgraph.matching.views import tally_planes

STEPS = 6  # of Gauss-Newton: only the rotation is not linear, and hardly
AT_LIMIT = 1e-4  # metres from a limit, at which a plane can be what ends a way
MOST_HELD = 3  # planes at once: a placement has no more freedom
STIFF = 1e6  # times the weight of a plane that is held


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
def slide(case, at, inside, out):
    """Into ``out`` the optimum for ``case.one`` where no plane that is at a limit goes over it.

    Those that would are held so far ``inside`` of it, one after the other. A straight way leaves
    such a limit when it turns; farther inside it can be longer. None is held afterwards.
    """
    view = case.one
    optimum(case, view, at, inside, out)
    for _ in range(MOST_HELD):
        worst = _most_over(case, view, out)
        if worst < 0:
            break
        case.tally.held[worst] = 1
        optimum(case, view, at, inside, out)
    for i in range(len(view.state)):
        case.tally.held[i] = 0


@part
def _most_over(case, view, goal):
    """The plane at a limit that would be farthest over it at ``goal``, -1 for none."""
    seen, limits = case.seen, case.limits
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
                or (stop - abs(view.offset[i]) >= AT_LIMIT)
            ):
                continue
            over = abs(offset_of(case, i, j, goal[1] + ax, goal[2] + ay)) - stop
            if over > most:
                worst, most = i, over
    return worst


@part
def optimum(case, spot, at, inside, out):
    """Into ``out`` the placement (yaw, x, y) of the largest L for the correspondences in ``spot``.

    Planes that are held stay so far ``inside`` of their limits.
    """
    tally_planes(case, spot)
    yaw, x, y = at[0], at[1], at[2]
    system, step = scratch(9), scratch(3)
    for _ in range(STEPS):
        pull_of(case, spot, yaw, x, y, inside, system)
        if not solve(system, system[6], system[7], system[8], step):
            break
        yaw -= step[0]
        x -= step[1]
        y -= step[2]
        if abs(step[0]) + abs(step[1]) + abs(step[2]) < 1e-12:
            break
    out[0] = wrapped(yaw)
    out[1] = x
    out[2] = y


@part
def pull_of(case, view, yaw, x, y, inside, system):
    """How the planes pull at a placement: the symmetric matrix (upper half), then the slope (3).

    Of half of what is subtracted from L, along (yaw, x, y).
    """
    seen, plan, limits, tally = case.seen, case.plan, case.limits, case.tally
    c, s = math.cos(yaw), math.sin(yaw)
    for k in range(9):
        system[k] = 0.0
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
                bend = wrapped(seen.angle[i] + yaw - plan.row[j, 3])
                weight = limits.angle_weight / tally.sums[p, 0 if fit else 3]
                system[0] += weight
                system[6] += weight * bend
            if not (fit or stiff):
                continue
            nx, ny = plan.row[j, 0], plan.row[j, 1]
            off = offset_of(case, i, j, x + ax, y + ay)
            if stiff:
                weight = limits.plane_weight * STIFF
                off -= math.copysign(stop - inside, view.offset[i])
            else:
                weight = limits.plane_weight / tally.sums[p, 0]
            turn = ny * ax - nx * ay
            system[0] += weight * turn * turn
            system[1] += weight * turn * nx
            system[2] += weight * turn * ny
            system[3] += weight * nx * nx
            system[4] += weight * nx * ny
            system[5] += weight * ny * ny
            system[6] -= weight * turn * off
            system[7] -= weight * nx * off
            system[8] -= weight * ny * off


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
