"""Located or not: a match is adopted when it is unique, examined with every new room, withdrawn.

A match that is unique may still have several readings: which wall was moved, which was not. It is
adopted then, and in doubt.

The S-Graph and its factor graph never depend on the match, so a match that is withdrawn leaves
nothing behind: the next one starts from the same map.
"""

from __future__ import annotations

import math
from typing import Literal, Protocol

import msgspec
import numpy as np

from situgraph.coupling.association import associate_planes, associate_rooms
from situgraph.coupling.config import CouplingConfig
from situgraph.coupling.lines import WallLines
from situgraph.coupling.located import Pairs
from situgraph.coupling.readings import Reading, doubt, readings
from situgraph.geometry.poses import Array, Placement, wrap_angle
from situgraph.matching.bent_solution import Answer, BentSolution
from situgraph.matching.config import MatchingConfig
from situgraph.matching.result import MatchResult
from situgraph.scenegraph.graph import SceneGraph

Happening = Literal["located", "doubted", "confirmed", "withdrawn"]


class Matching(Protocol):
    """What matches a growing graph (``situgraph.matching.Matcher``)."""

    def update(self, online: SceneGraph) -> MatchResult:
        """Match the graph as it is now."""
        ...


class Event(msgspec.Struct, frozen=True):
    """Something changed: at ``stamp`` (s), after so many ``rooms``, and why."""

    stamp: float
    rooms: int
    happening: Happening
    reason: str


class Locator:
    """Follows a growing S-Graph: where is its map in the plan, if that is known.

    Attributes:
        pairs: the adopted solution; None while there is none.
        result: the last match.
        events: all that happened, in order.
        lines: the walls of the plan.
        readings: the placements near the adopted one that cannot be told apart, the best first;
            none while nothing is adopted.
    """

    def __init__(
        self,
        matcher: Matching,
        prior: SceneGraph,
        config: CouplingConfig | None = None,
        matching: MatchingConfig | None = None,
    ) -> None:
        """Not located yet; ``matching`` says when two placements are the same."""
        self._matcher = matcher
        self._prior = prior
        self._config = config or CouplingConfig()
        self._same = matching or MatchingConfig()
        self._sure = False
        self.pairs: Pairs | None = None
        self.result: MatchResult | None = None
        self.events: list[Event] = []
        self.lines = WallLines(prior)
        self.readings: tuple[Reading, ...] = ()

    @property
    def located(self) -> bool:
        """Whether a match is adopted."""
        return self.pairs is not None

    @property
    def since(self) -> float | None:
        """When the adopted match was found (s)."""
        stamps = [e.stamp for e in self.events if e.happening == "located"]
        return stamps[-1] if self.located and stamps else None

    def update(self, online: SceneGraph, stamp: float) -> MatchResult:
        """Examine the graph as it is now (map frame); returns the match."""
        result = self._matcher.update(online)
        self.result = result
        why = None if self.pairs is None else self._examine(online, result, stamp)
        if self.pairs is None and result.unique and result.best is not None:
            self.pairs, why = pairs_of(result.best), None
            self._sure = True
            self._note(stamp, online, "located", result.reason)
        self.readings = () if self.pairs is None else self._read(online, self.pairs)
        if len(self.readings) > 1:
            why = why or doubt(self.readings, self._prior)
        if self.pairs is not None and self._sure is not (why is None):
            self._sure = why is None
            happening: Happening = "confirmed" if why is None else "doubted"
            self._note(stamp, online, happening, why or result.reason)
        return result

    def _read(self, online: SceneGraph, pairs: Pairs) -> tuple[Reading, ...]:
        config, lines = self._config, self.lines
        return readings(online, self._prior, pairs.placement, pairs.storeys, lines, config)

    def _examine(self, online: SceneGraph, result: MatchResult, stamp: float) -> str | None:
        """Does the adopted match still hold? If so, why it is in doubt; None: it is not."""
        assert self.pairs is not None
        held = self._held(online, result)
        if held is not None and held.probability >= self._config.keep_probability:
            self.pairs = pairs_of(held)
            return None if result.unique else result.reason
        if held is None and result.verdict == "none":
            open_rooms = unexplained(online, self._prior, self.pairs, self._config)
            if len(open_rooms) <= self._tolerated(len(online.rooms)):
                names = ", ".join(open_rooms) or "all of this together"
                return f"nothing in the plan is like {names} at its place"
        self.pairs = None
        self._note(stamp, online, "withdrawn", self._why(held, result))
        return None

    def _tolerated(self, rooms: int) -> int:
        """How many rooms may be unexplained before the match goes: one of three and more."""
        return 0 if rooms < 3 else max(1, rooms - self._same.least_rooms(rooms))

    def _why(self, held: Answer | None, result: MatchResult) -> str:
        if result.verdict == "none":
            return f"nothing in the plan explains what was seen since: {result.reason}"
        best = result.best
        if result.unique and best is not None:
            return f"what was seen since fits another placement: {result.reason}"
        if held is not None:
            return (
                f"its probability fell to {held.probability:.1%} of {result.count} "
                f"placements: {result.reason}"
            )
        return f"it is not among the {result.count} placements that fit: {result.reason}"

    def _note(self, stamp: float, online: SceneGraph, what: Happening, reason: str) -> None:
        self.events.append(Event(stamp, len(online.rooms), what, reason))

    def _held(self, online: SceneGraph, result: MatchResult) -> Answer | None:
        """The adopted placement among the solutions of a new match."""
        assert self.pairs is not None
        adopted = self.pairs.rooms
        middle = np.mean([r.center for r in online.rooms], axis=0) if online.rooms else np.zeros(3)
        for solution in result.solutions:
            if isinstance(solution, BentSolution):
                both = adopted.keys() & solution.rooms.keys()
                same = 2 * sum(solution.rooms[r] == adopted[r] for r in both) > len(both)
            else:
                same = self._one(solution.transform, self.pairs.placement, middle)
            if same:
                return solution
        return None

    def _one(self, a: Placement, b: Placement, middle: Array) -> bool:
        away = a.points(middle) - b.points(middle)
        return (
            float(np.hypot(away[0], away[1])) <= self._same.same_distance
            and abs(float(wrap_angle(a.yaw - b.yaw))) <= self._same.same_yaw
            and abs(float(away[2])) <= self._same.same_height
        )


def pairs_of(solution: Answer) -> Pairs:
    """What a solution of the match says corresponds."""
    return Pairs(
        solution.transform, solution.rooms, solution.planes, solution.objects, solution.storeys
    )


def unexplained(
    online: SceneGraph, prior: SceneGraph, pairs: Pairs, config: CouplingConfig
) -> tuple[str, ...]:
    """Online rooms that are no room of the plan where the map puts them.

    A room is one where it lies in a planned room, and two of its faces that are not parallel have
    a counterpart there.
    """
    rooms = associate_rooms(online, prior, pairs.placement, pairs.storeys, {}, config)
    pairs_of_faces = associate_planes(online, prior, pairs.placement, pairs.storeys, {}, config)
    faces: dict[str, set[str]] = {}
    for name, face in pairs_of_faces:
        faces.setdefault(name, set()).add(face)
    found = []
    for room in online.rooms:
        planned = prior.room_by_id.get(rooms.get(room.id, ""))
        there = set() if planned is None else set(planned.planes)
        own = [p for p in room.planes if faces.get(p, set()) & there]
        if not _spread(online, own):
            found.append(room.id)
    return tuple(found)


def _spread(graph: SceneGraph, planes: list[str]) -> bool:
    """Whether two of the planes are not parallel."""
    if len(planes) < 2:
        return False
    angles = [
        math.atan2(graph.plane_by_id[p].normal[1], graph.plane_by_id[p].normal[0]) for p in planes
    ]
    return any(abs(math.sin(a - angles[0])) > 0.3 for a in angles[1:])
