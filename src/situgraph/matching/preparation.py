"""An online graph and a plan as the tables a match works on."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from situgraph.matching.blocks import Laid
from situgraph.matching.cases import Tables, room_of
from situgraph.matching.config import MatchingConfig
from situgraph.matching.containment import content_of, no_content
from situgraph.matching.index import PlanIndex
from situgraph.matching.posterior import log_spread
from situgraph.matching.reading import Constants, Rooms, read_rooms, seen_tables, storey_heights
from situgraph.matching.semantics import SeenObjects, rates_of, seen_objects
from situgraph.matching.sightings import Rates
from situgraph.matching.sights import views_at, weigh
from situgraph.matching.storeys import storey_shifts
from situgraph.matching.tables import Aim, Content, Floats, Ints, Limits, Seen, View, explaining
from situgraph.scenegraph.graph import SceneGraph


@dataclass(frozen=True, eq=False)
class Inputs:
    """What is matched."""

    online: SceneGraph
    index: PlanIndex
    config: MatchingConfig
    semantics: str
    flipped: bool  # whether it is the mirror image (x to -x) of the online graph
    rooms: Rooms  # the online rooms that count; not mirrored
    storeys: Ints  # (N,) of each of them
    drawn: tuple[Tables, Tables]  # of the online graph and of its mirror image
    sigma: float  # of the offset of a wall that fits, metres
    middles: Floats  # (2, 2) the means of their room centres, map frame
    shifts: Floats  # in height
    mapping: Ints  # prior storey of each online storey, by shift

    @property
    def kept(self) -> Ints:
        """The online rooms that count."""
        return self.rooms.kept

    @property
    def source(self) -> Ints:
        """The online plane of each row."""
        return self.rooms.source

    @property
    def tables(self) -> Tables:
        """The tables of a search."""
        return self.drawn[self.flipped]

    @property
    def seen(self) -> Seen:
        """The online rooms."""
        return self.tables.seen

    @property
    def limits(self) -> Limits:
        """The constants."""
        return self.tables.limits

    @property
    def content(self) -> Content:
        """What rooms and planes hold, where that is asked."""
        return self.tables.content

    @property
    def middle(self) -> Floats:
        """The mean of the room centres, map frame."""
        middle: Floats = self.middles[int(self.flipped)]
        return middle

    @property
    def least(self) -> int:
        """K: how many rooms a candidate explains at least."""
        return self.config.least_rooms(len(self.kept))

    @property
    def aim(self) -> Aim:
        """What a candidate has to explain."""
        return explaining(self.least, len(self.kept))

    @property
    def log_spread(self) -> float:
        """Ln of the share of all placements that one candidate stands for."""
        return log_spread(self.index.area, self.sigma)

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
        if self.config is self.index.config:
            return self.index.rates
        return rates_of(self.index.objects, self.config)

    def mirrored(self) -> Inputs:
        """The same of the mirror image (x to -x) of the online graph."""
        return replace(self, flipped=True)

    def views(self, shift: Ints, at: Floats) -> View:
        """What is explained at placements (k,), (k, 3): ``View``'s fields, a placement a row."""
        return views_at(self.tables, self.mapping, shift, at)

    def evidence(self, shift: Ints, at: Floats, case: Laid | None = None) -> tuple[Floats, Ints]:
        """What the objects say of placements, and which prior object each online one is (k, n).

        ``case``, where there is one, is that of a search.
        """
        objects = (self.objects.table, self.index.objects.table, self.rates)
        return weigh(self.tables, self.mapping, *objects, shift, at, case)


def prepare(online: SceneGraph, index: PlanIndex, semantics: str, config: MatchingConfig) -> Inputs:
    """The tables of a match.

    Raises:
        InputError: a room names a plane that is not there.
    """
    constants = index.constants if config is index.config else Constants(config)
    rooms = read_rooms(online, config.usable_tilt)
    level = storey_heights(online)
    levels = [level[r] for r in rooms.kept.tolist()]
    heights = sorted(set(levels))
    storeys = np.array([heights.index(z) for z in levels], dtype=np.int64)
    seen, image, middles, spread = seen_tables(rooms, storeys, constants.limits(config.plane_sigma))
    sigma = config.sigma_of(spread)
    limits = constants.limits(sigma)
    shifts, mapping = storey_shifts(np.array(heights), index.elevations, config.storey_tolerance)
    content = no_content()
    if semantics == "containment":
        content = content_of(online, index.stock, rooms.kept, rooms.first, rooms.source)
    tables = Tables(seen, index.table, limits, content, room_of(seen, index.table, len(heights)))
    drawn = tables, tables._replace(seen=image)
    common = online, index, config, semantics, False, rooms, storeys, drawn
    return Inputs(*common, sigma, middles, shifts, mapping)
