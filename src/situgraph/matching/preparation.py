"""An online graph and a plan as the tables a match works on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import cast

import numpy as np

from situgraph.matching.blocks import Block
from situgraph.matching.calls import Objects, views_at, weigh
from situgraph.matching.cases import Tables, room_of
from situgraph.matching.config import MatchingConfig
from situgraph.matching.containment import content_of, no_content
from situgraph.matching.drafting import drafted
from situgraph.matching.index import PlanIndex
from situgraph.matching.posterior import log_spread
from situgraph.matching.reading import Constants, Listed, Rooms, list_rooms, storey_heights
from situgraph.matching.semantics import list_objects, rates_of
from situgraph.matching.storeys import storey_shifts
from situgraph.matching.tables import Aim, Content, Floats, Ints, Limits, Seen, View, explaining
from situgraph.scenegraph.graph import SceneGraph


@dataclass(eq=False)
class Inputs:
    """What is matched."""

    online: SceneGraph
    index: PlanIndex
    config: MatchingConfig
    semantics: str
    flipped: bool  # whether it is the mirror image (x to -x) of the online graph
    count: int  # of the online rooms that count
    draft: Block  # of a ``Drafting``
    tables: Tables  # of the online graph, or of its mirror image
    objects: Objects | None  # that are evidence, where there are any
    listed: Listed
    object_ids: list[str]
    sigma: float  # of the offset of a wall that fits, metres
    shifts: Floats  # in height
    mapping: Ints  # prior storey of each online storey, by shift

    @property
    def rooms(self) -> Rooms:
        """The online rooms that count; not mirrored."""
        return Rooms(*map(self.draft.array, Rooms._fields))

    @property
    def kept(self) -> Ints:
        """Which rooms of the online graph they are."""
        kept: Ints = self.draft.array("kept")
        return kept

    @property
    def source(self) -> Ints:
        """The online plane of each row."""
        source: Ints = self.draft.array("source")
        return source

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
        middle: Floats = self.draft.array("middle")[int(self.flipped)]
        return middle

    @property
    def least(self) -> int:
        """K: how many rooms a candidate explains at least."""
        return self.config.least_rooms(self.count)

    @property
    def aim(self) -> Aim:
        """What a candidate has to explain."""
        return explaining(self.least, self.count)

    @property
    def log_spread(self) -> float:
        """Ln of the share of all placements that one candidate stands for."""
        return log_spread(self.index.area, self.sigma)

    @property
    def weighs_objects(self) -> bool:
        """Whether objects are evidence, and there are any."""
        return self.objects is not None

    def mirrored(self) -> Inputs:
        """The same of the mirror image (x to -x) of the online graph."""
        tables = self.tables._replace(seen=cast(Seen, self.draft.record("image")))
        objects = self.objects and self.objects._replace(side=-1.0)
        return Inputs(**vars(self) | {"flipped": True, "tables": tables, "objects": objects})

    def views(self, shift: Ints, at: Floats) -> View:
        """What is explained at placements (k,), (k, 3): ``View``'s fields, a placement a row."""
        return views_at(self.tables, self.mapping, shift, at)

    def evidence(self, shift: Ints, at: Floats) -> tuple[Floats, Ints]:
        """What the objects say of placements, and which prior object each online one is (k, n)."""
        assert self.objects is not None
        return weigh(self.tables, self.mapping, self.objects, shift, at)


def prepare(
    online: SceneGraph,
    index: PlanIndex,
    semantics: str,
    config: MatchingConfig,
    before: Inputs | None = None,
) -> Inputs:
    """The tables of a match; what was read ``before``, of the same settings, is not read again.

    Raises:
        InputError: a room names a plane that is not there, an id is there twice, a number is not
            finite.
    """
    constants = index.constants if config is index.config else Constants(config)
    listed = list_rooms(online, config.usable_tilt, before.listed if before else None)
    heights = storey_heights(online, listed.kept)
    levels = sorted(set(heights))
    column: dict[str, int] = {}
    rates = None
    if semantics == "likelihood" and online.objects and index.objects.column:
        column = index.objects.column
        rates = index.rates if config is index.config else rates_of(index.objects, config)
    things = list_objects(online, listed.kept, listed.row, column)
    spots = [levels.index(z) for z in heights]
    limits = constants.limits(config.plane_sigma)
    draft, sizes = drafted(online, listed, spots, things, limits, rates)
    sigma = config.sigma_of(draft.number("spread"))
    shifts, mapping = storey_shifts(np.array(levels), index.elevations, config.storey_tolerance)
    content = no_content()
    if semantics == "containment":
        rooms = map(draft.array, ("kept", "first", "source"))
        content = content_of(online, index.stock, *rooms)
    room = room_of(sizes, index.room, len(levels))
    seen = cast(Seen, draft.record("seen"))
    tables = Tables(seen, index.table, constants.limits(sigma), content, room)
    objects = None
    if rates is not None:
        objects = Objects(len(things.ids), draft.record("sighted"), 1.0, index.objects.table, rates)
    what = online, index, config, semantics, False, len(listed.kept)
    return Inputs(*what, draft, tables, objects, listed, things.ids, sigma, shifts, mapping)
