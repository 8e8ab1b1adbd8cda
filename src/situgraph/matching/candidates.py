"""The peaks of a match: where the search finds them, and what walls and objects say of each."""

from __future__ import annotations

import math

import numpy as np

from situgraph.matching.blocks import Block
from situgraph.matching.calls import Peaks, find_peaks
from situgraph.matching.memory import Memory, stands, start_of
from situgraph.matching.preparation import Inputs
from situgraph.matching.tables import CUT, Aim
from situgraph.matching.traces import Start, traces_of


class Known:
    """What searches have found: for one match, or of an online graph that grows.

    Attributes:
        grows: whether more rooms may come; then each search leaves what the next can start from.
    """

    def __init__(self, *, grows: bool = False) -> None:
        """Nothing is known yet."""
        self.grows = grows
        self._peaks: dict[bool, tuple[Aim, Peaks]] = {}
        self._memories: dict[bool, Memory] = {}
        self._room: tuple[Block, Block] | None = None  # of the graph last searched: ``Peaks.room``

    def find(self, inputs: Inputs, aim: Aim) -> Peaks:
        """All peaks that are of account; from memory where as much was asked before.

        They are weighed by objects where those are evidence.
        """
        # There, objects decide what is found, or there is nothing to find.
        bare = inputs.semantics == "containment" or not inputs.count or not inputs.index.rooms
        if not self.grows or bare:
            return self._search(inputs, aim)
        before = self._peaks.get(inputs.flipped)
        if before is not None and _holds(before[0], aim):
            return _weighed_anew(before[1], inputs)
        found = self._search_on(inputs, aim)
        self._peaks[inputs.flipped] = aim, found._replace(room=None)  # which is large
        return found

    def forget_peaks(self) -> None:
        """Rooms or planes are others now."""
        self._peaks, self._room = {}, None

    def _search_on(self, inputs: Inputs, aim: Aim) -> Peaks:
        """Search from where the last search left off, and leave that to the next."""
        before = self._memories.get(inputs.flipped)
        traced = stands(before, inputs)
        start = start_of(before, inputs, aim) if traced else None
        found = self._search(inputs, aim, start, traced)
        if start is not None and start.on and found.done[CUT]:
            found = self._search(inputs, aim, start._replace(on=False), traced)
        traces = traces_of(found.room, len(inputs.shifts)) if traced and found.room else None
        self._memories[inputs.flipped] = Memory(inputs, aim.least, traces)
        return found

    def _search(
        self, inputs: Inputs, aim: Aim, start: Start | None = None, traced: bool = False
    ) -> Peaks:
        """Search; the mirror image in the memory of the search for what was seen."""
        rooms, last = inputs.count, self._room
        self._room = None
        if not rooms or not inputs.index.rooms:
            none, nothing = np.zeros(0, dtype=np.int64), np.empty(0)
            alike = np.zeros(rooms, dtype=np.int64)
            return Peaks(np.empty((0, 5)), none, nothing, alike, 0.0, [0] * 4, None)
        searched = inputs.tables, inputs.mapping, inputs.shifts, aim, inputs.objects
        if traced:
            return find_peaks(*searched, start=start, traced=True)
        if inputs.flipped:
            same = last is not None and last[0] is inputs.draft
            return find_peaks(*searched, room=last[1] if last and same else None)
        found = find_peaks(*searched)
        if found.room:
            self._room = inputs.draft, found.room
        return found


def _holds(one: Aim, two: Aim) -> bool:
    """Whether all placements that the second aim is after are what the first is after too."""
    share = one.budget / two.budget if two.budget > 0 else math.inf
    return one.least <= two.least and bool((one.loss <= two.loss * share).all())


def _weighed_anew(peaks: Peaks, inputs: Inputs) -> Peaks:
    """The same peaks, where objects may be others."""
    place = peaks.place.copy()
    place[:, 4] = peaks.walls
    if len(place) and inputs.objects is not None:
        place[:, 4] += inputs.evidence(peaks.shift, place[:, 1:4])[0]
    return peaks._replace(place=place)
