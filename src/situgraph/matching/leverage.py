"""What one plane more or less does to a peak, by its leverage: no placement is looked at."""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math

from situgraph.matching.compiled import part
from situgraph.matching.effort import count_pairs
from situgraph.matching.optimum import arm_of, offset_of, solve
from situgraph.matching.slack import wrapped
from situgraph.matching.tables import FIT, MOVED, WORK
from situgraph.matching.views import PARALLEL, one_wall

LEAST_REST = 1e-3  # share of what a plane says that others say as well, to go by its leverage
LEAST_EASE = 1e-9  # square metres by which a plane gives way to one unit of L


@part
def measure_margins(case, at, margin):
    """The least change of an offset, and of an angle, by which a plane fits, is moved or missing.

    Third the longest lever arm. Of rooms that are explained in ``case.root``, the view at ``at``,
    with the planes of their prior rooms.
    """
    view, seen, plan, limits = case.root, case.seen, case.plan, case.limits
    margin[0], margin[1], margin[2] = math.inf, math.inf, 0.0
    c, s = math.cos(at[0]), math.sin(at[0])
    for r in range(len(view.room)):
        a = view.room[r]
        if a < 0:
            continue
        ax, ay = arm_of(seen, r, c, s)
        margin[2] = max(margin[2], math.hypot(ax, ay))
        count_pairs(case, r, a)
        for i in range(seen.first[r], seen.first[r + 1]):
            for j in range(plan.first[a], plan.first[a + 1]):
                bend = abs(wrapped(seen.angle[i] + at[0] - plan.row[j, 3]))
                margin[1] = min(margin[1], abs(bend - limits.angle))
                if bend > limits.angle:
                    continue
                off = abs(offset_of(case, i, j, at[1] + ax, at[2] + ay))
                margin[0] = min(margin[0], abs(off - limits.fit), abs(off - limits.moved))


@part
def nearly_moved(case, at, r, i):
    """The wall nearest by of those beyond which missing plane ``i`` would be moved, or -1.

    Just beyond: by offset or by angle.
    """
    seen, plan, limits, a = case.seen, case.plan, case.limits, case.one.room[r]
    nearest, found = limits.moved + limits.fit, -1
    ax, ay = arm_of(seen, r, math.cos(at[0]), math.sin(at[0]))
    for j in range(plan.first[a], plan.first[a + 1]):
        bend = abs(wrapped(seen.angle[i] + at[0] - plan.row[j, 3]))
        if bend > 2.0 * limits.angle:
            continue
        off = abs(offset_of(case, i, j, at[1] + ax, at[2] + ay))
        if off < nearest and (off > limits.moved or bend > limits.angle):
            nearest, found = off, j
    return found


@part
def stays_low(case, at, r, i, j, system, margin, step):
    """Whether letting plane ``i`` go, holding it or not missing it leads no higher than the peak.

    That is at ``at``, an optimum. It follows from the plane's leverage, unless another plane
    changes its state on the way. ``j`` is its prior row.
    """
    view, limits = case.one, case.limits
    state = view.state[i]
    turned = abs(wrapped(case.seen.angle[i] + at[0] - case.plan.row[j, 3])) > limits.angle
    if turned or not _by_itself(case, i):
        return False
    offset, ease = _lever(case, at, r, i, j, system, step)
    weight, worth = limits.plane_weight, limits.fit_peak - limits.moved_base
    off, spared = abs(offset), _most_spared(case, j)
    if state == FIT:
        rest = 1.0 - weight * ease
        if rest < LEAST_REST or weight * off * off / rest > worth - spared:
            return False
        push = -weight * off / rest
    else:
        pull, gain = off - limits.moved, limits.moved_base - limits.missing + spared
        if state == MOVED:
            pull = off - min(limits.fit, off / (1.0 + weight * ease))
            gain = worth - weight * (off - pull) ** 2
        if ease < LEAST_EASE or pull * pull / ease < gain:
            return False
        push = pull / ease
    push *= math.copysign(1.0, offset)
    for k in range(3):
        step[k] *= push
    return _within(step, margin) or _keeps_states(case, at, step, i, j)


@part
def leads_back(case, at, r, i, system, margin, far, step):
    """Whether plane ``i``, which fits, once let go leads to a placement whose view is the root.

    And no farther than ``far`` (``far_apart``) from ``at``, which is the optimum with all planes.
    """
    j, weight = case.one.row[i], case.limits.plane_weight
    if not _by_itself(case, i):
        return False
    offset, ease = _lever(case, at, r, i, j, system, step)
    rest = 1.0 - weight * ease
    if rest < LEAST_REST:
        return False
    for k in range(3):
        step[k] *= -weight * offset / rest
    if _against(step, margin) > far:
        return False
    return _within(step, margin) or _keeps_states(case, at, step, -1, -1)


@part
def far_apart(case, fall, margin, step):
    """How far a step may lead, at most, to where L is not ``fall`` higher than at its end.

    As ``_against`` counts it, in the view ``case.root``, of which that is the optimum; ``step``
    leads there. L is lower by what walls say one by one; but those that moved as one may say more.
    """
    limits, view, paired = case.limits, case.root, 0
    case.found.count[WORK] += len(view.state) ** 2 // 4
    for i in range(len(view.state)):
        for k in range(len(view.state)):
            both = i != k and view.state[i] == MOVED and view.state[k] == MOVED
            if both and one_wall(case, view.row[i], view.row[k]) != 0.0:
                paired += 1
                break
    likeliest = limits.together + limits.alone
    if paired < 2 or likeliest <= 1.0:
        return math.inf
    # Of what one pair says, where it says anything.
    steepest = 2.0 * math.sqrt(limits.apart_weight * math.log(limits.together / (1 - limits.alone)))
    return fall / (steepest * (paired - 1)) - _against(step, margin)


@part
def _by_itself(case, i):
    """Whether row ``i`` is the only one of its plane."""
    tally, p = case.tally, case.seen.plane[i]
    return tally.sums[p, 0] + tally.sums[p, 3] + tally.missing[p] == 1


@part
def _lever(case, at, r, i, j, system, step):
    """How far plane ``i`` is off, and by how much it gives way to one unit of pull.

    Into ``step`` goes the step to which that pull leads.
    """
    ax, ay = arm_of(case.seen, r, math.cos(at[0]), math.sin(at[0]))
    nx, ny = case.plan.row[j, 0], case.plan.row[j, 1]
    turn = ny * ax - nx * ay
    if not solve(system, turn, nx, ny, step):
        return 0.0, math.inf
    offset = offset_of(case, i, j, at[1] + ax, at[2] + ay)
    return offset, turn * step[0] + nx * step[1] + ny * step[2]


@part
def _most_spared(case, j):
    """What a plane with the prior row ``j`` spares at most when it moves: its wall has moved."""
    view, limits = case.one, case.limits
    case.found.count[WORK] += len(view.state) // 4
    for i in range(len(view.state)):
        if view.state[i] == MOVED and one_wall(case, view.row[i], j):
            return max(0.0, math.log(limits.together + limits.alone))
    return 0.0


@part
def _span(step, margin):
    """By how much a step changes an offset, at most."""
    return abs(step[1]) + abs(step[2]) + abs(step[0]) * margin[2]


@part
def _against(step, margin):
    """By how much the offsets of two faces of one wall change against each other, at most."""
    return PARALLEL * (abs(step[1]) + abs(step[2])) + 2.0 * abs(step[0]) * margin[2]


@part
def _within(step, margin):
    """Whether no plane can change its state on a step."""
    return abs(step[0]) < margin[1] and _span(step, margin) < margin[0]


@part
def _keeps_states(case, at, step, changed, row):
    """Whether all planes but the one that is changed stay within their limits on a step, or beyond.

    Those of rooms that are explained in the root, towards each plane of their prior rooms.
    """
    view, seen, plan, limits = case.root, case.seen, case.plan, case.limits
    c, s = math.cos(at[0]), math.sin(at[0])
    for r in range(len(view.room)):
        a = view.room[r]
        if a < 0:
            continue
        ax, ay = arm_of(seen, r, c, s)
        count_pairs(case, r, a)
        for i in range(seen.first[r], seen.first[r + 1]):
            for j in range(plan.first[a], plan.first[a + 1]):
                if i == changed and j == row:
                    continue
                bend = wrapped(seen.angle[i] + at[0] - plan.row[j, 3])
                near = abs(bend) <= limits.angle
                if near != (abs(bend + step[0]) <= limits.angle):
                    return False
                if not near:
                    continue
                nx, ny = plan.row[j, 0], plan.row[j, 1]
                off = offset_of(case, i, j, at[1] + ax, at[2] + ay)
                then = abs(off - nx * step[1] - ny * step[2] - (ny * ax - nx * ay) * step[0])
                off = abs(off)
                if (off <= limits.fit) != (then <= limits.fit):
                    return False
                if (off <= limits.moved) != (then <= limits.moved):
                    return False
    return True
