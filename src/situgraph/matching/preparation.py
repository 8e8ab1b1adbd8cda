"""An online graph and a plan as the tables a match works on."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from situgraph.matching.config import MatchingConfig
from situgraph.matching.containment import content_of, no_content
from situgraph.matching.entries import views_at
from situgraph.matching.index import PlanIndex
from situgraph.matching.reading import limits_of, plan_lines, raw_rooms, seen_table, storey_heights
from situgraph.matching.semantics import SeenObjects, rates_of, seen_objects
from situgraph.matching.sightings import Rates, weigh
from situgraph.matching.storeys import storey_shifts
from situgraph.matching.tables import Aim, Content, Floats, Ints, Limits, Seen, View, explaining
from situgraph.scenegraph.graph import SceneGraph


class Lines(NamedTuple):
    """The online rooms that count, as lines of the map."""

    center: Floats  # (R, 3) of all rooms
    first: Ints  # (N + 1,)
    normal: Floats  # (P, 2)
    distance: Floats  # (P,)
    storeys: Ints  # (R,)


@dataclass(frozen=True, eq=False)
class Inputs:
    """What is matched."""

    online: SceneGraph
    index: PlanIndex
    config: MatchingConfig
    semantics: str
    flipped: bool  # whether it is the mirror image (x to -x) of the online graph
    kept: Ints  # the online rooms that count
    source: Ints  # the online plane of each row
    lines: Lines
    seen: Seen
    middle: Floats  # the mean of the room centres, map frame
    content: Content
    shifts: Floats  # in height
    mapping: Ints  # prior storey of each online storey, by shift
    limits: Limits

    @property
    def least(self) -> int:
        """K: how many rooms a candidate explains at least."""
        return self.config.least_rooms(len(self.kept))

    @property
    def aim(self) -> Aim:
        """What a candidate has to explain."""
        return explaining(self.least, len(self.kept))

    @property
    def weighs_objects(self) -> bool:
        """Whether objects are evidence, and there are any."""
        return (
            self.semantics == "likelihood"
            and bool(self.online.objects)
            and bool(self.index.objects.column)
        )

    @cached_property
    def objects(self) -> SeenObjects:
        """The online objects that are evidence."""
        tables = (self.kept, self.source, self.middle, self.index.objects)
        return seen_objects(self.online, *tables, self.flipped)

    @cached_property
    def rates(self) -> Rates:
        """The error rates of the plan's categories."""
        return rates_of(self.index.objects, self.config)

    def mirrored(self) -> Inputs:
        """The same of the mirror image (x to -x) of the online graph."""
        lines = self.lines._replace(
            center=self.lines.center * (-1.0, 1.0, 1.0), normal=self.lines.normal * (-1.0, 1.0)
        )
        seen, middle = _seen(lines, self.kept, self.source, self.limits)
        return replace(self, flipped=True, lines=lines, seen=seen, middle=middle)

    def views(self, shift: Ints, at: Floats) -> View:
        """What is explained at placements (k,), (k, 3): ``View``'s fields, a placement a row."""
        tables = (self.seen, self.index.table, self.limits, self.content)
        views: View = views_at(*tables, self.mapping, shift, np.ascontiguousarray(at))
        return views

    def evidence(self, views: View, at: Floats) -> tuple[Floats, Ints]:
        """What the objects say of placements (k, 3), and which prior object each online one is."""
        claims = np.empty((len(at), len(self.objects.ids)), dtype=np.int64)
        tables = (self.objects.table, self.index.objects.table, self.rates, self.index.source)
        where = np.ascontiguousarray(at)
        value: Floats = weigh(*tables, views.room, views.row, where, claims)
        return value, claims


def prepare(online: SceneGraph, index: PlanIndex, semantics: str, config: MatchingConfig) -> Inputs:
    """The tables of a match.

    Raises:
        InputError: a room names a plane that is not there.
    """
    limits = limits_of(config)
    centers, planes, names, counts = raw_rooms(online)
    kept, first, normal, distance, source = plan_lines(
        centers, planes, names, counts, config.usable_tilt
    )
    heights, storeys = np.unique(storey_heights(online)[kept], return_inverse=True)
    every = np.zeros(len(counts), dtype=np.int64)
    every[kept] = storeys
    lines = Lines(centers, first, normal, distance, every)
    seen, middle = _seen(lines, kept, source, limits)
    shifts, mapping = storey_shifts(heights, index.elevations, config.storey_tolerance)
    content = no_content()
    if semantics == "containment":
        content = content_of(online, index.stock, kept, first, source)
    return Inputs(
        online, index, config, semantics, False, kept, source, lines, seen, middle, content,
        shifts, mapping, limits,
    )  # fmt: skip


def _seen(lines: Lines, kept: Ints, source: Ints, limits: Limits) -> tuple[Seen, Floats]:
    center, first, normal, distance, storeys = lines
    return seen_table(center, kept, first, normal, distance, source, storeys, limits)
