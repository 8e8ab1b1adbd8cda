"""The peaks of a match: where the search finds them, and what walls and objects say of each."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

import numpy as np

from situgraph.matching.blocks import Block, Space
from situgraph.matching.calls import Peaks, find_peaks
from situgraph.matching.memory import Left, Memory
from situgraph.matching.preparation import Inputs
from situgraph.matching.tables import CUT, LEFT, Aim
from situgraph.matching.traces import Traces

COVER, MOST_COVER = 4, 1024  # boxes of a cover: for each prior room, at most


class Known:
    """What searches have found: for one match, or of an online graph that grows.

    Attributes:
        grows: whether more rooms may come; then each search leaves what the next can start from.
        inputs: of the graph as it was last, if it grows.
    """

    def __init__(self, *, grows: bool = False) -> None:
        """Nothing is known yet."""
        self.grows = grows
        self.inputs: Inputs | None = None
        self._peaks: dict[bool, tuple[Aim, Peaks]] = {}
        space = Space() if grows else None
        self._memory = {k: Memory(None, Traces(), space) for k in (False, True) if space}
        self._room: tuple[Block, Block] | None = None  # of the graph last searched: ``Peaks.room``

    def read(self, inputs: Inputs) -> None:
        """What was read of the graph as it is now."""
        if self.grows:
            self.inputs = inputs

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

    def rules_out_mirrored(self, inputs: Inputs, aim: Aim, wider: Callable[[], Aim]) -> bool:
        """Whether it is known that the mirror image has no peaks, of a graph that grows.

        If the last search found none, but does not tell, ``wider`` says what to be after so that
        later ones are told as well.
        """
        memory = self._memory.get(True)
        if memory is None or memory.left is None or not memory.left.empty:
            return False
        if memory.rules_out(inputs, aim):
            return True
        self._search_on(inputs.mirrored(), wider())
        return memory.rules_out(inputs, aim)

    def forget_peaks(self) -> None:
        """Rooms or planes are others now."""
        self._peaks, self._room = {}, None

    def _search_on(self, inputs: Inputs, aim: Aim) -> Peaks:
        """Search from where the last search left off, and leave that to the next."""
        memory = self._memory[inputs.flipped]
        row = memory.rows(inputs)
        if memory.left is not None and (row < 0).all():  # the map moves, and may go on so
            memory.left = Left(inputs, aim, False, None, None)
            memory.traces.forget()
            return self._search(inputs, aim)
        memory.traces.follow(inputs.tables, row, len(inputs.mapping))
        start, boxes = None, 1
        if not inputs.flipped:  # there, rooms lose unequally
            start = memory.start(inputs, row, aim)
            boxes = min(COVER * (inputs.index.rooms + COVER), MOST_COVER)
        searched = inputs.tables, inputs.mapping, inputs.shifts, aim, inputs.objects
        search = partial(
            find_peaks, *searched, traces=memory.traces, boxes=boxes, space=memory.space
        )
        found = search(start=start)
        if start is not None and found.done[CUT]:
            found = search()
        memory.left = _left(inputs, aim, found, boxes)
        return found

    def _search(self, inputs: Inputs, aim: Aim) -> Peaks:
        """Search; the mirror image in the memory of the search for what was seen."""
        rooms, last = inputs.count, self._room
        self._room = None
        if not rooms or not inputs.index.rooms:
            none, nothing = np.zeros(0, dtype=np.int64), np.empty(0)
            alike = np.zeros(rooms, dtype=np.int64)
            return Peaks(np.empty((0, 5)), none, nothing, alike, 0.0, [0] * 5, None)
        searched = inputs.tables, inputs.mapping, inputs.shifts, aim, inputs.objects
        if inputs.flipped:
            same = last is not None and last[0] is inputs.draft
            return find_peaks(*searched, room=last[1] if last and same else None)
        found = find_peaks(*searched)
        if found.room:
            self._room = inputs.draft, found.room
        return found


def _left(inputs: Inputs, aim: Aim, found: Peaks, boxes: int) -> Left:
    """What a search left, of at most so many boxes."""
    assert found.room is not None
    count, whole = found.done[LEFT], not found.done[CUT]
    cover = shift = None
    if whole and count <= boxes:
        cover = found.room.array("left")[:count].copy()
        shift = found.room.array("left_shift")[:count].copy()
    return Left(inputs, aim, whole and not len(found.place) and not count, cover, shift)


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
