"""What searches of a growing graph know of its rooms, each by itself: kept from one to the next."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from situgraph.matching.cases import Tables
from situgraph.matching.tables import Floats, Ints


class Start(NamedTuple):
    """What is known before a search of where it has to look."""

    wanted: int  # groups of new rooms, one of which is explained where the cover holds nothing
    cover: Floats  # (k, SIDES) anchored for this search
    first: Ints  # (shifts + 1,) where that of each shift begins


class Traces:
    """Tables that grow with the rooms; a search works in them, and leaves them to the next."""

    def __init__(self) -> None:
        """Nothing is known."""
        self._rows: dict[str, Ints] = {}  # by field, a row for each room and some to spare
        self._base, self._judged = 0.0, np.zeros(0, dtype=np.int64)

    def follow(self, tables: Tables, row: Ints, layers: int) -> None:
        """Make place for the rooms of a search: ``row`` (N,) is where each was before, -1 if new.

        Maps are kept of so many shifts of the storeys, which are those of before.
        """
        room, rows = tables.room, self._rows
        known = np.flatnonzero(row >= 0) if rows else np.zeros(0, dtype=np.int64)
        self._judged = np.zeros(len(row), dtype=np.int64)
        self._judged[known] = 1
        if not rows or len(row) > len(rows["alike"]) or not np.array_equal(row[known], known):
            words = {"alike": 1, "like": room["like"], "drawn": layers}
            words["marks"] = layers * room["map"] // 2
            self._rows = {
                name: np.zeros((2 * len(row), width), dtype=np.int64)
                for name, width in words.items()
            }
            if len(known):
                for name, kept in self._rows.items():
                    kept[known] = rows[name][row[known]]
        if tables.turn != self._base:
            self._base = tables.turn
            self._rows["drawn"].fill(0)

    def forget(self) -> None:
        """Nothing is known any longer."""
        self._rows = {}

    def given(self) -> dict[str, Any]:
        """What the block of a ``Search`` is given of them; of new rooms nothing is known."""
        rows, judged = self._rows, self._judged
        for name in ("alike", "like", "drawn"):
            rows[name][: len(judged)][judged == 0] = 0
        return {
            "case.task.judged": judged,
            "case.found.alike": rows["alike"].reshape(-1),
            "case.found.like": rows["like"],
            "case.ground.drawn": rows["drawn"].reshape(-1),
            "case.ground.marks": rows["marks"].reshape(-1),
            "layers": rows["drawn"].shape[1],
        }
