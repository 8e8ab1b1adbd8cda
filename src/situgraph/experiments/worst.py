"""The worst runs of experiments that drive the whole system: what became of them, and how.

Ranked by what became of a run (wrong, never located, ambiguous, right), then by how far its
placement is off at the end, then by how often it changed its mind. ``scripts/failures.py`` writes
them into docs/results/failures.md.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import msgspec

RANK = ("wrong", "never", "ambiguous", "right")
WORST = 10


class Case(msgspec.Struct, frozen=True):
    """A run: where it comes from, what was wrong with it on purpose, and what became of it.

    ``error`` (m) is that of the placement at the end, at the middle of the rooms seen; None where
    there is none. ``located`` (s) is when the match was found that is adopted at the end. ``story``
    tells all that was adopted, doubted or withdrawn.
    """

    experiment: str
    building: str
    seed: int
    made: str
    rooms: int
    outcome: str
    error: float | None
    located: float | None
    trajectory: float | None
    story: tuple[str, ...]

    @property
    def order(self) -> tuple[int, float, int]:
        """The worst case is the least."""
        return RANK.index(self.outcome), -(self.error or 0.0), -len(self.story)


def worst(results: Iterable[Mapping[str, Any]], count: int = WORST) -> list[Case]:
    """The worst runs of some experiments (their JSON), the worst first."""
    cases = [case_of(str(r["name"]), row) for r in results for row in r["rows"]]
    return sorted(cases, key=lambda c: c.order)[:count]


def case_of(experiment: str, row: Mapping[str, Any]) -> Case:
    """A row of the experiments ``system`` or ``localization`` as a case."""
    return Case(
        experiment=experiment,
        building=str(row["building"]),
        seed=int(row["seed"]),
        made=made(row),
        rooms=int(row["rooms"]),
        outcome=str(row["outcome"]),
        error=row.get("placement_error_m"),
        located=row.get("located_s"),
        trajectory=row.get("ate_building_m"),
        story=tuple(_event(e) for e in row.get("events", ())),
    )


def made(row: Mapping[str, Any]) -> str:
    """What was made difficult on purpose."""
    said = []
    if row.get("moved_walls"):
        said.append("a wall moved")
    if row.get("moved_by"):
        said.append(f"walls moved by {100 * row['moved_by']:.0f} cm")
    if row.get("fault"):
        said.append(str(row["fault"]))
    if row.get("detector") == "none":
        said.append("no camera")
    return ", ".join(said) or "nothing"


def _event(event: Mapping[str, Any] | str) -> str:
    if isinstance(event, str):
        return event
    rooms = "1 room" if event["rooms"] == 1 else f"{event['rooms']} rooms"
    return f"{event['s']:.1f} s, {rooms}, {event['what']}: {event['why']}"
