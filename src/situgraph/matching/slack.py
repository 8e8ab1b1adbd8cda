"""What may change inside a box of placements."""

# mypy: allow-untyped-defs, allow-untyped-calls
# (the types of kernels are those of the tables; numba infers them)
from __future__ import annotations

import math
from typing import NamedTuple

from situgraph.matching.compiled import part

SLACK = 1e-9  # equality at a limit


class Slack(NamedTuple):
    """What may change inside a box of placements, as one room sees it."""

    turn: float  # half width of the yaw
    ux: float  # the box's first axis
    uy: float
    hu: float  # half widths along the first and second axis
    hv: float
    wx: float  # from the box's anchor to the room's centre
    wy: float
    bend: float  # 1 - cos(turn)
    swing: float  # sin(turn)


@part
def no_slack():
    """The slack of a single placement."""
    return Slack(0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@part
def wrapped(angle):
    """An angle in [-pi, pi]."""
    return angle - 2 * math.pi * round(angle / (2 * math.pi))


@part
def give(slack, nx, ny):
    """By how much the offset of a plane with this normal can change inside the box."""
    along = abs(nx * slack.ux + ny * slack.uy) * slack.hu
    across = abs(ny * slack.ux - nx * slack.uy) * slack.hv
    bend = abs(nx * slack.wx + ny * slack.wy) * slack.bend
    swing = abs(ny * slack.wx - nx * slack.wy) * slack.swing
    return along + across + bend + swing


@part
def residuals(case, i, j, yaw, x, y):
    """By how much plane ``i`` is turned against prior row ``j``, and off; its room is at (x, y)."""
    seen, row = case.seen, case.plan.row
    bend = wrapped(seen.angle[i] + yaw - row[j, 3])
    return bend, seen.distance[i] - (row[j, 0] * x + row[j, 1] * y + row[j, 2])
