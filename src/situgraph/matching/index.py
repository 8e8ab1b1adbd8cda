"""The plan, prepared once for any number of matches."""

from __future__ import annotations

import copy
import math
import time
from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np

from situgraph.matching.area import area_of
from situgraph.matching.blocks import Block
from situgraph.matching.cases import room_for
from situgraph.matching.config import MatchingConfig
from situgraph.matching.containment import Stock, stock_of
from situgraph.matching.corners import MOST_PLANES, corners_of
from situgraph.matching.homes import homes_of, plain_rooms
from situgraph.matching.maps import BITS, REACH
from situgraph.matching.plain import EXACT, QUARTER, widths_of
from situgraph.matching.reading import Constants, Rooms, plan_lines, read_rooms, storey_heights
from situgraph.matching.semantics import PlannedObjects, planned_objects, rates_of
from situgraph.matching.sightings import Rates
from situgraph.matching.strands import strands_of
from situgraph.matching.tables import Floats, Ints, Plan
from situgraph.scenegraph.graph import SceneGraph

MAP_MARGIN = 3.0  # metres around the room centres
CELLS_A_ROOM, LEAST_CELLS = 64, 4096
LEAST_REACH = 2.0  # metres; of a room of parallel walls it is not known how long it is
BIN = math.radians(0.25)  # lines whose directions differ less are kept together


class PlanIndex:
    """A prior graph, indexed: build it once a building and match against it any number of times.

    Memory and time to build grow linearly with the rooms. The index is never changed after it is
    built, so threads may share it.

    Attributes:
        prior: the graph.
        config: the settings it was built with; a match uses them unless told otherwise.
        seconds: how long it took to build.
    """

    def __init__(self, prior: SceneGraph, config: MatchingConfig | None = None) -> None:
        """Index ``prior``.

        Raises:
            InputError: a room names a plane that is not there.
        """
        begin = time.perf_counter()
        self.prior = prior
        self.config = config or MatchingConfig()
        rooms = read_rooms(prior, self.config.usable_tilt)
        normal, distance = plan_lines(rooms)
        heights = np.array(storey_heights(prior, range(len(prior.rooms))))
        self.kept: Ints = rooms.kept
        self.source: Ints = rooms.source
        # Numbers stay small, whatever far away origin the model has.
        self.origin: Floats = rooms.center[:, :2].mean(axis=0) if len(rooms.kept) else np.zeros(2)
        self.center: Floats = rooms.center[:, :2] - self.origin
        self.elevations: Floats = np.unique(heights[rooms.kept])
        self.area = area_of(_centers(prior), heights, self.config.plan_margin)
        self.table = self._table(rooms, normal, distance, heights[rooms.kept])
        self.room = room_for(self.table)
        self._narrower: dict[tuple[str, ...], PlanIndex] = {}
        self.room_ids = [prior.rooms[k].id for k in self.kept.tolist()]
        self.seconds = time.perf_counter() - begin

    def looked_for(self, categories: Sequence[str] | None) -> PlanIndex:
        """This index as far as it is evidence to who can find these categories (None: all).

        What nobody could have found is not missed. Walls and rooms are shared.
        """
        if categories is None or self.prior.modelled <= set(categories):
            return self
        able = tuple(sorted(self.prior.modelled & set(categories)))
        if able not in self._narrower:
            narrower = copy.copy(self)
            narrower.prior = self.prior.replace(modelled_categories=able)
            for name in ("stock", "objects", "rates"):
                narrower.__dict__.pop(name, None)
            self._narrower[able] = narrower
        return self._narrower[able]

    @cached_property
    def stock(self) -> Stock:
        """What the rooms and their planes hold, for the policy ``containment``."""
        return stock_of(self.prior, self.kept, self.table.first, self.source)

    @cached_property
    def objects(self) -> PlannedObjects:
        """The objects of the plan that are evidence."""
        return planned_objects(self.prior, self.kept, self.source, self.origin, self.config)

    @cached_property
    def rates(self) -> Rates:
        """The error rates of the plan's categories."""
        return rates_of(self.objects, self.config)

    @cached_property
    def constants(self) -> Constants:
        """The constants of searches."""
        return Constants(self.config)

    @property
    def rooms(self) -> int:
        """How many prior rooms count: those with at least two usable planes."""
        return len(self.kept)

    def _table(self, rooms: Rooms, normal: Floats, distance: Floats, heights: Floats) -> Plan:
        first, room = rooms.first, rooms.room
        row = np.empty((len(distance), 4))
        row[:, :2] = normal
        row[:, 2] = distance - np.einsum("ij,ij->i", normal, self.center[room])
        row[:, 3] = np.arctan2(normal[:, 1], normal[:, 0])
        storey = np.searchsorted(self.elevations, heights)
        large = np.flatnonzero(np.diff(first) > MOST_PLANES)
        lines = _lines(row, room, storey[room], len(self.elevations))
        widest = int(np.diff(first).max(initial=1))
        corners, cells, turns = (
            corners_of(first, row, storey, self.config),
            cells_of(self.center),
            _turns_of(row[:, 3]),
        )
        straight = not len(large) and float(turns[1] - turns[0]) <= EXACT
        plain = plain_rooms(first, row, distance, self.center, storey, corners, straight=straight)
        made: tuple[Any, ...] = (
            first,
            row,
            storey,
            _middles(self.center, distance, room),
            *corners,
            large,
            *lines,
            plain,
            widths_of(plain),
            *cells,
            homes_of(plain, storey, *cells),
            turns,
            widest,
            *strands_of(first, row, distance),
        )
        return Plan(*made, Block.of(Plan, made))  # type: ignore[call-arg]


def _centers(prior: SceneGraph) -> Floats:
    """The centre of each room in the plan (n, 2), counted or not."""
    return np.array([x for r in prior.rooms for x in r.center]).reshape(-1, 3)[:, :2]


def cells_of(center: Floats) -> tuple[Ints, Floats]:
    """A map of cells over the rooms of a plan: ``Plan.cells`` and ``Plan.corner``.

    Cells are a metre wide, wider where the rooms are few and far between.
    """
    if not len(center):
        return np.zeros(2, dtype=np.int64), np.zeros(3)
    low, high = center.min(axis=0) - MAP_MARGIN, center.max(axis=0) + MAP_MARGIN
    x, y = (high - low).tolist()
    cell = max(REACH, math.sqrt(x * y / (CELLS_A_ROOM * len(center) + LEAST_CELLS)))
    wide, tall = math.ceil(x / cell / BITS), math.ceil(y / cell)
    return np.array([wide, tall], dtype=np.int64), np.array([*low, 1.0 / cell])


def _turns_of(angle: Floats) -> Floats:
    """The lowest and the highest direction (2,), each to the nearest quarter turn of the first."""
    turn = angle - angle[0] if len(angle) else np.zeros(1)
    turn -= np.rint(turn / QUARTER) * QUARTER
    return np.array([turn.min(), turn.max()])


def _middles(center: Floats, distance: Floats, room: Ints) -> Floats:
    """``Plan.middle`` (M, 3): what was seen of a room has its centre within that room, about.

    With a standard deviation of half as far as its farthest wall is from its centre.
    """
    reach = np.full(len(center), LEAST_REACH)
    np.maximum.at(reach, room, np.abs(distance))
    return np.column_stack([center, 2.0 / reach**2])


def _lines(row: Floats, room: Ints, storey: Ints, storeys: int) -> tuple[Floats | Ints, ...]:
    """All planes as lines by storey, direction and offset."""
    bins = np.floor((row[:, 3] + math.pi) / BIN).astype(np.int64)
    order = np.lexsort((row[:, 2], bins, storey))
    key = storey[order] * (10 + round(2 * math.pi / BIN)) + bins[order]
    begins = np.flatnonzero(np.diff(key, prepend=-1)) if len(key) else np.zeros(0, dtype=np.int64)
    line_first = np.append(begins, len(key)).astype(np.int64)
    angle = row[order, 3]
    low = np.minimum.reduceat(angle, begins) if len(begins) else np.zeros(0)
    high = np.maximum.reduceat(angle, begins) if len(begins) else np.zeros(0)
    bin_first = np.searchsorted(storey[order][begins], np.arange(storeys + 1))
    return (
        bin_first.astype(np.int64),
        (low + high) / 2,
        (high - low) / 2,
        line_first,
        row[order, 2].copy(),
        room[order].copy(),
    )
