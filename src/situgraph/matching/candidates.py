"""The peaks of a match: where the search finds them, and what walls and objects say of each."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from situgraph.matching.entries import find_peaks
from situgraph.matching.preparation import Inputs
from situgraph.matching.tables import Floats, Ints


class Peaks(NamedTuple):
    """What the search found."""

    place: Floats  # (k, 5) height, yaw, x, y, L
    shift: Ints  # (k,)
    alike: Ints  # (N,) how many prior rooms explain each online room in isolation
    done: Ints  # (4,) peaks, hypotheses, boxes, incomplete


class Known:
    """Peaks by the walls alone, of one online graph; its objects may change."""

    def __init__(self) -> None:
        """Nothing is known yet."""
        self._peaks: dict[tuple[bool, int], Peaks] = {}

    def by_walls(self, inputs: Inputs, least: int) -> Peaks:
        """What the search finds; from memory where it was asked before."""
        if inputs.semantics == "containment":  # there, objects decide what is found
            return _by_walls(inputs, least)
        key = (inputs.flipped, least)
        if key not in self._peaks:
            self._peaks[key] = _by_walls(inputs, least)
        return self._peaks[key]


def find(inputs: Inputs, least: int, known: Known) -> Peaks:
    """All peaks that explain at least so many rooms, objects included where they are evidence."""
    peaks = known.by_walls(inputs, least)
    place = peaks.place.copy()
    if len(place) and inputs.weighs_objects:
        at = np.ascontiguousarray(place[:, 1:4])
        place[:, 4] += inputs.evidence(inputs.views(peaks.shift, at), at)[0]
    return peaks._replace(place=place)


def _by_walls(inputs: Inputs, least: int) -> Peaks:
    rooms = len(inputs.kept)
    if not rooms or not inputs.index.rooms:
        nothing = np.zeros(rooms, dtype=np.int64)
        return Peaks(
            np.empty((0, 5)),
            np.zeros(0, dtype=np.int64),
            nothing,
            np.zeros(4, dtype=np.int64),
        )
    tables = (inputs.seen, inputs.index.table, inputs.limits, inputs.content)
    place, alike, done = find_peaks(*tables, inputs.mapping, least)
    shift = place[:, 0].astype(np.int64)
    place[:, 0] = inputs.shifts[shift]
    return Peaks(place, shift, alike, done)
