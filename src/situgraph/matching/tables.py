"""The flat tables the kernels work on: the online rooms, the plan, the limits, room to work in.

A room's planes stand one after the other; ``first[r]`` to ``first[r + 1]`` are the rows of room
``r``. Kernels read named tuples as ``records``; an array that is declared with its sizes is laid
out with its record (``blocks``).
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from situgraph.matching.blocks import Block

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]
Shorts = NDArray[np.int32]
Table = Annotated[Floats, None, None]
Single = NDArray[np.float32]
Singles = Annotated[NDArray[np.float32], None, None]
IntTable = Annotated[Ints, None, None]
CountTable = Annotated[NDArray[np.int16], None, None]

FIT, MOVED, MISSING = 0, 1, 2  # states of an online plane
MADE, MAPPED = range(2)  # what ``Groups.told`` tells
# What ``Sieve.told`` tells: whether it was made, how many words are left, into how many parts the
# yaws of a quarter are cut, how many of the rooms have to be marked.
SIFTED, KEPT, PARTED, NEEDED = range(4)
# What a search counts; CUT is 1 when it was cut short, LEFT and HELD are boxes of ``cover`` and
# ``region``, STAGE is one of those below, SETTLED how often a peak was.
PEAKS, TRIED, BOXES, CUT, WORK, LEFT, HELD, STAGE, SETTLED = range(9)
ANYWHERE, OUTLINING, WITHIN = range(3)  # it searches all, for the region, in the region


class Limits(NamedTuple):
    """The constants of ``docs/matching.md`` that the search needs; metres, radians, logarithms."""

    fit: float
    moved: float
    angle: float
    sine: float
    fit_peak: float  # log ratio of a plane that fits without residual
    moved_base: float  # log ratio of a moved plane in its direction
    together: float  # how many times likelier it is when its wall moved as far
    alone: float  # the probability that it moved by itself even so
    apart_weight: float  # 1 / (2 sigma^2) of the difference of two such planes
    thickness: float  # of a wall, at most
    missing: float
    missing_shared: float
    room_true: float
    room_false: float
    other_room: float  # probability that a room that is not explained is like those of the plan
    shape_gain: float  # likelihood ratio of each plane of a shape that was met before
    tied: float  # log ratio of walls that stand wall to wall, in another building
    plane_weight: float  # 1 / (2 sigma^2)
    angle_weight: float
    same_distance: float
    same_yaw: float
    smallest_step: float
    peak_step: float
    max_boxes: int
    max_work: int
    slots: Block  # in memory


class Seen(NamedTuple):
    """The online rooms that count; lengths from the mean of their centres."""

    center: Annotated[Floats, "N", 2]
    first: Annotated[Ints, "N + 1"]
    angle: Annotated[Floats, "P"]  # direction of the normal
    distance: Annotated[Floats, "P"]  # signed distance of the room's centre
    plane: Annotated[Ints, "P"]  # which distinct plane
    planes: int  # how many distinct planes
    widest: int  # most planes of one room
    strict: Annotated[Ints, "N"]  # whether every plane must fit
    flat: Annotated[Ints, "N"]  # whether all planes are parallel
    storey: Annotated[Ints, "N"]
    shape: Annotated[Floats, "N"]  # how many of its planes a similar shape would explain
    own: Annotated[Ints, "N"]  # how many of its planes are in no other room
    tied: Annotated[Ints, 1]  # how often walls stand wall to wall (``ties``); not mirrored
    crossed_first: Annotated[Ints, "N + 1"]  # pairs of a room's planes that are not parallel
    crossed: Annotated[Ints, "crossings", 2]
    probe_first: Annotated[Ints, "N + 1"]  # corners by which a room is looked up
    probe: Annotated[Ints, "probes", 2]  # two rows, the second counter-clockwise of the first
    probe_arm: Annotated[Floats, "probes", 2]  # where they meet
    probe_reach: Annotated[Floats, "probes"]  # how far the prior corner may lie off
    plain: Annotated[Floats, "N", 11]  # rooms of four directions (``plain``)
    slots: Block  # in memory


class Plan(NamedTuple):
    """The prior rooms that count, and how they are found."""

    first: Ints  # (M + 1,)
    row: Table  # (Q, 4) normal x, y, offset, direction of the normal
    storey: Ints  # (M,)
    middle: Table  # (M, 3) centre of each room, and what a metre squared from it costs (``astray``)
    corner_first: Shorts  # (cells + 1,) corners by storey, direction and cell (``corners``)
    corner_place: Singles  # (C, 2)
    corner_angle: Single  # (C,) direction of the first plane
    corner_room: Shorts  # (C,)
    corner_cells: Ints  # (2,) columns, rows
    corner_origin: Floats  # (4,) x, y in metres, cells a metre; middle of the first quarter
    large: Ints  # rooms with too many corners, tried everywhere
    bin_first: Ints  # (S + 1,) each storey's bins of lines of one direction
    bin_angle: Floats  # (B,)
    bin_spread: Floats  # (B,) largest difference of a line's direction from its bin's
    line_first: Ints  # (B + 1,) each bin's lines, by offset
    line_offset: Floats  # (Q,)
    line_room: Ints  # (Q,)
    plain: Table  # (M, 16) rooms of four directions (``plain``)
    width: Table  # (2, M) their widths, NaN of those that have not four planes
    cells: Ints  # (2,) of a map of the plan (``ground``): words of 64 cells a row, rows
    corner: Floats  # (3,) where it begins, x and y in metres, and how many cells a metre has
    home: Shorts  # by storey and cell: the plain room whose centre is there, or -1 (``homes``)
    turns: Floats  # (2,) lowest and highest direction of a wall from the first's, modulo a quarter
    widest: int  # most planes of one room
    strand_first: Ints  # (M + 1,) strands of a room of many walls (``strands``), by direction
    strand_normal: Table  # (S, 2)
    strand_angle: Floats  # (S,)
    strand_line: Ints  # (S + 1,) each strand's walls, by offset
    strand_offset: Floats  # (L,) from the room's centre
    strand_row: Ints  # (L,)
    slots: Block  # in memory


class Content(NamedTuple):
    """What the online rooms and planes hold, and what the prior's do.

    Empty when nothing is asked.
    """

    room_first: Ints  # (N + 1,)
    room_need: IntTable  # (k, 2) category, count
    row_first: Ints  # (P + 1,)
    row_need: IntTable  # (k, 2)
    room_have: CountTable  # (M, C)
    row_have: CountTable  # (Q, C)
    slots: Block  # in memory


class Aim(NamedTuple):
    """Which placements are of account."""

    least: int  # rooms they explain at least
    loss: Floats  # (N,) above zero: what each online room loses when it is not explained
    budget: float  # what the rooms that are not explained may lose together, at most


def explaining(least: int, rooms: int) -> Aim:
    """All placements that explain at least so many of the rooms."""
    return Aim(least, np.ones(rooms), rooms - least)


class Task(NamedTuple):
    """What one pass of the search is after."""

    least: int  # rooms to be explained
    budget: float  # what a placement may lose, at most
    storeys: Annotated[Ints, "U"]  # the prior storey of each online storey, -1 for none
    judged: Annotated[Ints, "N"]  # whether an earlier search knew a room
    loss: Floats  # (N,) what each online room loses when it is not explained


class View(NamedTuple):
    """The correspondences at a placement."""

    room: Annotated[Ints, "N"]  # prior room, -1 for none
    row: Annotated[Ints, "P"]  # prior row of each online row of an explained room, -1 for none
    state: Annotated[Ints, "P"]  # FIT, MOVED or MISSING; -1 in rooms that are not explained
    offset: Annotated[Floats, "P"]  # residuals, where there is a prior row
    bend: Annotated[Floats, "P"]


class Steady(NamedTuple):
    """What was found of each room where it was last looked at on a climb (``steady``)."""

    place: Annotated[Floats, "N", 3]  # yaw, and where its centre was
    reach: Annotated[Floats, "N", 2]  # how far from there it is found again: yaw, metres
    storey: Annotated[Ints, "N"]  # on which prior storey
    room: Annotated[Ints, "N"]  # prior room, -1 for none
    row: Annotated[Ints, "P"]  # of its planes
    state: Annotated[Ints, "P"]


class Finder(NamedTuple):
    """Room to work for ``find``: the rooms found, and when each was last."""

    room: Annotated[Ints, "M"]
    last: Annotated[Ints, "M"]
    turn: Annotated[Ints, 1]  # number of the present search
    home: Annotated[Floats, "N", 4]  # x, y, yaw around which it was looked up, storey from 1 on
    count: Annotated[Ints, "N"]  # type: ignore[assignment]  # how many rooms were found there
    kept: Annotated[Ints, "N", 16]  # and which


class Bench(NamedTuple):
    """Room to work for ``explain``: the counterparts each plane can have, best first."""

    row: Annotated[Ints, "n", "m"]  # prior row, -1 for none
    value: Annotated[Floats, "n", "m"]  # log ratio
    fits: Annotated[Ints, "n", "m"]  # state
    count: Annotated[Ints, "n"]  # type: ignore[assignment]
    close: Annotated[
        Ints, "m"
    ]  # prior rows that a plane may be near, or counterparts that were met
    best: Annotated[Floats, "n + 1"]  # largest sum from a plane on
    pick: Annotated[Ints, "n"]  # the choice tried
    kept: Annotated[Ints, "n"]  # the best choice's rows
    state: Annotated[Ints, "n"]  # and their states
    rent: Annotated[Floats, "n"]  # prices of planes (``assignment``)
    column: Annotated[Ints, "n"]  # their counterparts
    price: Annotated[Floats, "m"]  # of counterparts
    near: Annotated[Floats, "m"]  # length of the shortest path to one
    way: Annotated[Ints, "m"]  # the plane before it
    choice: Annotated[Ints, "m"]  # and which of its counterparts this is
    owner: Annotated[Ints, "m"]  # the plane that has it, -1 for none
    done: Annotated[Ints, "m"]  # whether it was met, and the shortest path to it is known


class Options(NamedTuple):
    """The prior rooms that explain each online room at one placement, best first, N at most.

    More than N are never needed: the other rooms take N - 1 at most.
    """

    room: Annotated[Ints, "N", "N"]
    score: Annotated[Floats, "N", "N"]
    count: Annotated[Ints, "N"]  # type: ignore[assignment]
    owner: Annotated[Ints, "M"]  # how many rooms have a prior room as an option


class Pairing(NamedTuple):
    """Room to work for the assignment of rooms that want the same prior rooms.

    Columns are the prior rooms, then one a row for none.
    """

    price: Annotated[Floats, "M + N"]  # of a column
    near: Annotated[Floats, "M + N"]  # length of the shortest path to a column
    way: Annotated[Ints, "M + N"]  # the row before it
    owner: Annotated[Ints, "M + N"]  # row of a column plus 1, 0 for none
    mark: Annotated[Ints, "M + N"]  # 0 never met, 1 met in this search, 2 done, 3 met before
    met: Annotated[Ints, "M + N"]  # the columns met in one search for a path
    used: Annotated[Ints, "M + N"]  # the columns met in any
    rent: Annotated[Floats, "N"]  # price of a row
    column: Annotated[Ints, "N"]  # of a row
    rows: Annotated[Ints, "N"]  # to be assigned


class Tally(NamedTuple):
    """Sums over the occurrences of each distinct plane."""

    # Fits, their squares: offset, bend; moved, their squares of bend, sum of their offsets; row of
    # the prior plane, 1 when its wall has been counted, what those counted spare it at most.
    sums: Annotated[Floats, "planes", 9]
    missing: Annotated[Ints, "planes"]
    held: Annotated[Ints, "P"]  # whether it stays at its limit while it is slid along; else 0


class Spans(NamedTuple):
    """For each online room, where in the box it can be explained; and its planes' spans."""

    low: Annotated[Floats, 3, "N"]  # yaw, along, across
    high: Annotated[Floats, 3, "N"]
    required: Annotated[Ints, "N"]  # rooms that must be explained
    sorted: Annotated[Floats, "N"]  # to select in
    order: Annotated[Ints, "N"]  # of rooms: those first that were nowhere in the last box
    turn_low: Annotated[Floats, "n"]  # yaws for which a plane can fit
    turn_high: Annotated[Floats, "n"]
    nu: Annotated[Floats, "n"]  # its normal in the box's axes
    nv: Annotated[Floats, "n"]
    off_low: Annotated[Floats, "n"]  # moves along its normal for which it can fit
    off_high: Annotated[Floats, "n"]
    kind: Annotated[Ints, "n"]  # 0: cannot fit, 1: one direction, 2: several
    wide: Annotated[Ints, "N"]  # rooms of which the box is too wide to say where they go
    turned: Annotated[Floats, 4, 7]  # yaws of boxes looked at last (``Reach``), by quarter


class Groups(NamedTuple):
    """``member[first[g]:first[g + 1]]`` are the rooms of group ``g``, its anchor first."""

    first: Annotated[Ints, "N + 2"]
    member: Annotated[Ints, "N"]
    group: Annotated[Ints, "N"]  # of each room
    anchor: Annotated[Ints, "N"]  # of each group
    order: Annotated[Ints, "N"]  # rooms that have a map, the nearest to the group's anchor first
    apart: Annotated[Floats, "N"]  # how far they are
    arm: Annotated[Floats, "N", 2]  # and in which direction, from the anchor
    told: Annotated[Ints, 2]  # how many groups, and how many rooms that have a map


class Ground(NamedTuple):
    """Where in the plan each online room may lie (``ground``)."""

    marks: Annotated[Ints, "words"]  # bits of cells, by room, shift, quarter turn, row of cells
    base: float  # yaw of the first quarter
    layers: int  # of how many shifts of the storeys maps are kept
    known: Annotated[Ints, "N"]  # whether a room has a map
    drawn: Annotated[Ints, "maps"]  # by room and shift: whether a map has been drawn
    part: Annotated[Ints, 1]  # which of these shifts is the present one
    halves: Annotated[Floats, 4, 9]  # by quarter: yaw and its half width, and their halves
    # For the mirror image, what rooms of four walls mark in each map; before that, of which rooms.
    shared: Annotated[Ints, "shared"]
    former: Ints  # the same, of the search for what was seen


class Sieve(NamedTuple):
    """Where all rooms together may lie, told for all cells of the plan at once (``sieve``)."""

    room: Annotated[Ints, "N"]  # those that are counted, or of a group
    counted: Annotated[Ints, "N"]  # whether each room is
    shift: Annotated[Ints, 2, "N"]  # columns and rows from the mean room centre to each, turned
    open: Annotated[Ints, "N"]  # on which sides of its map each may lie outside of it
    sums: Annotated[Ints, "sums", "height"]  # cells of a column of words: counts (``counting``)
    left: Annotated[Ints, "left", 4]  # what is left: quarter and yaw, column, row, 64 cells
    word: Annotated[Ints, "map"]  # where the anchor of a group is then, by quarter
    block: Annotated[Ints, "blocks"]  # in which blocks of 8 x 8 cells that is, at any quarter
    turn: Annotated[Floats, 2]  # yaws from that of the quarter: the lowest, half width of a part
    told: Annotated[Ints, 4]


class Found(NamedTuple):
    """Peaks (k, 4): yaw, x, y of the mean room centre in the plan, L; and what the search did."""

    peak: Annotated[Floats, "peaks", 4]
    settled: Annotated[Floats, "peaks", 2]  # metres, radians around each that it stands for alone
    bucket: Annotated[Ints, "buckets"]  # number + 1 of the last peak of each cell (``nearby``)
    linked: Annotated[Ints, "peaks"]  # and of the one before each
    close: Annotated[Ints, "peaks"]  # those near a place
    rest: Annotated[Floats, "peaks"]  # what the rooms say that a peak does not explain, or NaN
    count: Annotated[Ints, 9]  # type: ignore[assignment]  # ``PEAKS`` to ``SETTLED``
    ward: Annotated[Floats, "peaks", "sides"]  # what each peak stood for (``wards``)
    since: Annotated[Ints, "peaks"]  # how many peaks there were when it first did, 0: it did not
    alike: Annotated[Ints, "N"]  # how many prior rooms explain each online room in isolation
    other: Annotated[Floats, "N"]  # log ratio of each online room where it is not explained
    stack: Annotated[Floats, "depth", "sides"]  # boxes to be searched
    waiting: Annotated[Floats, "waiting", "sides"]  # those in which an anchor finds one prior room
    like: Annotated[Ints, "N", "like"]  # bit a: whether prior room a explains it in isolation
    along: Annotated[Floats, 2, 4]  # where a plain room finds another, along two directions
    cover: Annotated[Floats, "boxes", "sides"]  # hold all feasible placements; 0 where nobody asks
    region: Annotated[Floats, "boxes", "sides"]  # are known to do so before the search
    near: Annotated[Floats, "boxes", 3]  # where each takes an anchor, and how near to there


class Case(NamedTuple):
    """All a kernel may need: tables, and room to work in."""

    seen: Seen
    plan: Plan
    limits: Limits
    content: Content
    task: Task
    finder: Finder
    bench: Bench
    options: Options
    pairing: Pairing
    tally: Tally
    spans: Spans
    groups: Groups
    found: Found
    ground: Ground
    sieve: Sieve
    one: View
    two: View
    steady: Steady
    kept: View  # that of the peak that is climbed on from
    root: View  # that from which it is counted what one plane changes (``leverage``)
