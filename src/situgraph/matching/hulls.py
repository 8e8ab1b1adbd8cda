"""Where in a box a room can be explained: hulls on the three axes of the box.

Of each plane the turns and the moves along its normal are measured for which it can fit; two that
cross, or all of a room of parallel planes, say where the room can be.
"""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math

from situgraph.matching.compiled import part
from situgraph.matching.plain import SHARP, facing, plain_pair
from situgraph.matching.slack import SLACK, wrapped
from situgraph.matching.strands import row_at, rows_near
from situgraph.matching.tables import WORK


@part
def plane_spans(case, r, a, yaw, x, y, slack):
    """For each plane of ``r``: for which turns, and which moves along its normal.

    It can fit in ``a``.
    """
    seen, spans = case.seen, case.spans
    begin = seen.first[r]
    case.found.count[WORK] += 4 * (seen.first[r + 1] - begin)
    for k in range(seen.first[r + 1] - begin):
        spans.kind[k] = 0
        spans.turn_low[k], spans.turn_high[k] = math.inf, -math.inf
    if plain_pair(case, r, a) and 2 * case.limits.angle + slack.turn < SHARP:
        for k in range(4):
            i, j = facing(case, r, a, k, yaw)
            if i >= 0 and j >= 0:
                _add_span(case, i - begin, i, j, yaw, x, y, slack)
        return
    for i in range(begin, seen.first[r + 1]):
        top, rows = rows_near(case, a, i, yaw, x, y, case.limits.fit, slack)
        for c in range(rows):
            _add_span(case, i - begin, i, row_at(case, top, c), yaw, x, y, slack)


@part
def _add_span(case, k, i, j, yaw, x, y, slack):
    """Add where plane ``i``, number ``k`` of its room, fits the prior row ``j``."""
    seen, plan, limits, spans = case.seen, case.plan, case.limits, case.spans
    bend = wrapped(seen.angle[i] + yaw - plan.row[j, 3])
    if abs(bend) > limits.angle + slack.turn + SLACK:
        return
    nx, ny = plan.row[j, 0], plan.row[j, 1]
    off = seen.distance[i] - (nx * x + ny * y + plan.row[j, 2])
    nu, nv = nx * slack.ux + ny * slack.uy, ny * slack.ux - nx * slack.uy
    shift = abs(nu) * slack.hu + abs(nv) * slack.hv
    bent = abs(nx * slack.wx + ny * slack.wy) * slack.bend
    lever = ny * slack.wx - nx * slack.wy
    reach = limits.fit + SLACK + bent
    if abs(off) > reach + shift + abs(lever) * slack.swing:
        return
    low = max(-slack.turn, -limits.angle - SLACK - bend)
    high = min(slack.turn, limits.angle + SLACK - bend)
    if abs(lever) > 1e-9:
        one = (off - reach - shift) / lever
        two = (off + reach + shift) / lever
        low = max(low, _arcsine(min(one, two), slack.swing) - 1e-12)
        high = min(high, _arcsine(max(one, two), slack.swing) + 1e-12)
    if low > high:
        return
    spans.turn_low[k] = min(spans.turn_low[k], low)
    spans.turn_high[k] = max(spans.turn_high[k], high)
    width = reach + abs(lever) * slack.swing
    if spans.kind[k] == 0:
        spans.kind[k] = 1
        spans.nu[k], spans.nv[k] = nu, nv
        spans.off_low[k], spans.off_high[k] = off - width, off + width
    elif spans.nu[k] == nu and spans.nv[k] == nv:
        spans.off_low[k] = min(spans.off_low[k], off - width)
        spans.off_high[k] = max(spans.off_high[k], off + width)
    else:
        spans.kind[k] = 2


@part
def _arcsine(value, most):
    """The angle of a sine, cut to the box."""
    return math.asin(min(max(value, -most), most))


@part
def hull(case, half, r):
    """Widen the room's spans by where the planes just measured let it be explained.

    False if nowhere.
    """
    seen, spans = case.seen, case.spans
    begin = seen.first[r]
    if seen.flat[r]:
        return _flat_hull(case, half, r, seen.first[r + 1] - begin)
    some = False
    case.found.count[WORK] += 2 * (seen.crossed_first[r + 1] - seen.crossed_first[r])
    for c in range(seen.crossed_first[r], seen.crossed_first[r + 1]):
        i, k = seen.crossed[c, 0] - begin, seen.crossed[c, 1] - begin
        if spans.kind[i] == 0 or spans.kind[k] == 0:
            continue
        low = max(spans.turn_low[i], spans.turn_low[k])
        high = min(spans.turn_high[i], spans.turn_high[k])
        if low > high:
            continue
        u0, u1, v0, v1 = -half[1], half[1], -half[2], half[2]
        det = spans.nu[i] * spans.nv[k] - spans.nv[i] * spans.nu[k]
        if spans.kind[i] == 1 and spans.kind[k] == 1 and abs(det) > 0.05:
            mi, hi = (
                (spans.off_low[i] + spans.off_high[i]) / 2,
                (spans.off_high[i] - spans.off_low[i]) / 2,
            )
            mk, hk = (
                (spans.off_low[k] + spans.off_high[k]) / 2,
                (spans.off_high[k] - spans.off_low[k]) / 2,
            )
            u = (mi * spans.nv[k] - mk * spans.nv[i]) / det
            du = (hi * abs(spans.nv[k]) + hk * abs(spans.nv[i])) / abs(det)
            v = (mk * spans.nu[i] - mi * spans.nu[k]) / det
            dv = (hk * abs(spans.nu[i]) + hi * abs(spans.nu[k])) / abs(det)
            u0, u1 = max(u0, u - du), min(u1, u + du)
            v0, v1 = max(v0, v - dv), min(v1, v + dv)
            if u0 > u1 or v0 > v1:
                continue
        some = True
        _widen(case, r, low, high, u0, u1, v0, v1)
        if _is_whole(spans, half, r):
            break
    return some


@part
def _is_whole(spans, half, r):
    """Whether the room's spans are all of the box, so that they cannot be wider."""
    for side in range(3):
        if spans.low[side, r] > -half[side] or spans.high[side, r] < half[side]:
            return False
    return True


@part
def _flat_hull(case, half, r, n):
    """The same for a room of parallel planes: all must fit, and they bound one direction only."""
    spans = case.spans
    low, high = -half[0], half[0]
    u0, u1, v0, v1 = -half[1], half[1], -half[2], half[2]
    for k in range(n):
        if spans.kind[k] == 0:
            return False
        low, high = max(low, spans.turn_low[k]), min(high, spans.turn_high[k])
        if spans.kind[k] == 2:
            continue
        middle = (spans.off_low[k] + spans.off_high[k]) / 2
        width = (spans.off_high[k] - spans.off_low[k]) / 2
        if abs(spans.nu[k]) >= abs(spans.nv[k]):
            reach = (width + abs(spans.nv[k]) * half[2]) / abs(spans.nu[k])
            u0, u1 = max(u0, middle / spans.nu[k] - reach), min(u1, middle / spans.nu[k] + reach)
        else:
            reach = (width + abs(spans.nu[k]) * half[1]) / abs(spans.nv[k])
            v0, v1 = max(v0, middle / spans.nv[k] - reach), min(v1, middle / spans.nv[k] + reach)
    if low > high or u0 > u1 or v0 > v1:
        return False
    _widen(case, r, low, high, u0, u1, v0, v1)
    return True


@part
def _widen(case, r, low, high, u0, u1, v0, v1):
    spans = case.spans
    spans.low[0, r], spans.high[0, r] = min(spans.low[0, r], low), max(spans.high[0, r], high)
    spans.low[1, r], spans.high[1, r] = min(spans.low[1, r], u0), max(spans.high[1, r], u1)
    spans.low[2, r], spans.high[2, r] = min(spans.low[2, r], v0), max(spans.high[2, r], v1)
