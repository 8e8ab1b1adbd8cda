"""The peaks of a match: where the search finds them, and what walls and objects say of each."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from situgraph.matching.blocks import Laid
from situgraph.matching.entries import find_peaks
from situgraph.matching.memory import Memory, stands, start_of
from situgraph.matching.preparation import Inputs
from situgraph.matching.tables import CUT, Aim, Floats, Ints


class Peaks(NamedTuple):
    """What the search found."""

    place: Floats  # (k, 5) height, yaw, x, y, L
    shift: Ints  # (k,)
    alike: Ints  # (N,) how many prior rooms explain each online room in isolation
    done: Ints  # (4,) peaks, hypotheses, boxes, incomplete
    case: Laid | None = None  # of the search, to look at the peaks in


class Known:
    """What searches by the walls alone have found: of an online graph that grows.

    Attributes:
        grows: whether more rooms may come; then each search leaves what the next can start from.
    """

    def __init__(self, *, grows: bool = False) -> None:
        """Nothing is known yet."""
        self.grows = grows
        self._peaks: dict[bool, tuple[Aim, Peaks]] = {}
        self._memories: dict[bool, Memory] = {}
        self._maps: Laid | None = None  # the case of what was seen, for its mirror image

    def by_walls(self, inputs: Inputs, aim: Aim) -> Peaks:
        """What the search finds; from memory where as much was asked before."""
        if inputs.semantics == "containment":  # there, objects decide what is found
            return self._search(inputs, aim, False)
        before = self._peaks.get(inputs.flipped)
        if before is not None and _holds(before[0], aim):
            return before[1]
        found = self._search(inputs, aim, self.grows)
        self._peaks[inputs.flipped] = aim, found._replace(case=None)  # which is large
        return found

    def forget_peaks(self) -> None:
        """Rooms or planes are others now."""
        self._peaks, self._maps = {}, None

    def _search(self, inputs: Inputs, aim: Aim, traced: bool) -> Peaks:
        rooms = len(inputs.kept)
        if not rooms or not inputs.index.rooms:
            nothing = np.zeros(rooms, dtype=np.int64)
            return Peaks(
                np.empty((0, 5)),
                np.zeros(0, dtype=np.int64),
                nothing,
                np.zeros(4, dtype=np.int64),
            )
        before = self._memories.get(inputs.flipped) if traced else None
        kept = traced and stands(before, inputs)
        start = start_of(before, inputs, aim) if kept else None
        former = self._maps.record("ground").shared if self._maps and inputs.flipped else None
        shared = not (kept or inputs.flipped) and len(inputs.mapping) == 1
        asked: dict[str, Any] = {"traced": kept, "former": former, "shared": shared}
        found = find_peaks(inputs.tables, inputs.mapping, aim, start, **asked)
        if start is not None and start.on and found[3][CUT]:
            start = start._replace(on=False)
            found = find_peaks(inputs.tables, inputs.mapping, aim, start, **asked)
        place, shift, alike, done, case, traces = found
        if traced:
            self._memories[inputs.flipped] = Memory(inputs, aim.least, traces)
        self._maps = case if shared else None
        place[:, 0] = inputs.shifts[shift]
        return Peaks(place, shift, alike, done, case)


def _holds(one: Aim, two: Aim) -> bool:
    """Whether all placements that the second aim is after are what the first is after too."""
    share = one.budget / two.budget if two.budget > 0 else math.inf
    return one.least <= two.least and bool((one.loss <= two.loss * share).all())


def find(inputs: Inputs, aim: Aim, known: Known) -> Peaks:
    """All peaks that are of account, objects included where they are evidence."""
    peaks = known.by_walls(inputs, aim)
    place = peaks.place.copy()
    if len(place) and inputs.weighs_objects:
        place[:, 4] += inputs.evidence(peaks.shift, place[:, 1:4], peaks.case)[0]
    return peaks._replace(place=place, case=None)
