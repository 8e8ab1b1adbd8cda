"""The match JSON (DESIGN.md section 3) as records: what the pictures of a match are drawn from."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any, Literal, Protocol, runtime_checkable

import msgspec

from situgraph.errors import InputError
from situgraph.geometry.poses import Placement

FORMAT = "situgraph/match"
_REMEDY = "give the JSON that `situgraph match` writes"


class Deviation(msgspec.Struct, frozen=True):
    """A wall found beside its planned place: ``offset`` (m) along the planned inward normal."""

    plane: str
    offset: float
    tilt: float | None = None
    sigma: float | None = None


class Part(msgspec.Struct, frozen=True):
    """Online rooms of a bent map, and the placement that is theirs."""

    rooms: tuple[str, ...]
    transform: Placement


class Solution(msgspec.Struct, frozen=True):
    """A placement of the online graph in the prior one; mappings go from S-ids to A-ids."""

    transform: Placement
    storeys: dict[str, str] = {}
    rooms: dict[str, str] = {}
    also_covers: dict[str, list[str]] = {}
    planes: dict[str, str] = {}
    objects: dict[str, str] = {}
    score: float | None = None
    probability: float | None = None
    rms: float | None = None
    deviations: tuple[Deviation, ...] = ()
    parts: tuple[Part, ...] = ()


class Advice(msgspec.Struct, frozen=True):
    """What to look for; ids are the prior's, ``splits`` holds indices of solutions told apart."""

    look_for: str
    on_plane: str | None = None
    in_room: str | None = None
    splits: tuple[tuple[int, ...], ...] = ()


class MatchRecord(msgspec.Struct, frozen=True):
    """A match: verdict, solutions best first, advice, and the search's figures."""

    verdict: Literal["unique", "ambiguous", "none"]
    unique: bool
    reason: str = ""
    certified: bool = False
    count: int = 0
    truncated: bool = False
    probability_outside: float | None = None
    solutions: tuple[Solution, ...] = ()
    disambiguation: tuple[Advice, ...] = ()
    stats: dict[str, Any] = {}
    online: str | None = None
    prior: str | None = None


@runtime_checkable
class HasDict(Protocol):
    """A match result: anything that gives the match JSON as a dict."""

    def to_dict(self) -> Mapping[str, Any]:
        """The match JSON."""


Match = Mapping[str, Any] | HasDict | MatchRecord


def read_record(match: Match, source: object = "match") -> MatchRecord:
    """A match result or its JSON as a record.

    Raises:
        InputError: not a match JSON of version 1; ``source`` is named in the sentence.
    """
    if isinstance(match, MatchRecord):
        return match
    found = match.to_dict() if isinstance(match, HasDict) else match
    if found.get("format") != FORMAT or found.get("version") != 1:
        raise InputError(source, f"is no '{FORMAT}' of version 1", _REMEDY)
    try:
        # Through JSON text, so that a result's own records and arrays are judged like a file's.
        return msgspec.json.decode(json.dumps(found), type=MatchRecord)
    except (msgspec.ValidationError, TypeError, ValueError) as error:
        raise InputError(source, f"is no match JSON ({error})", _REMEDY) from error
