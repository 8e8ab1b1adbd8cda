"""A solution of a map that is bent: where each part of it lies in the building."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cached_property
from typing import Any

import msgspec
import numpy as np

from situgraph.geometry.poses import Placement, best_placement, wrap_angle
from situgraph.matching.solution import Deviation, Solution, written
from situgraph.matching.tables import Floats
from situgraph.scenegraph.graph import SceneGraph


class BentSolution:
    """Placements of several parts of a map, which go on from one another.

    It has what a ``Solution`` has.

    Attributes:
        parts: the placement of each part, the one with most rooms first.
        probability: against all other placements of the parts and 'not in this plan'.
    """

    def __init__(
        self,
        parts: Sequence[Solution],
        online: SceneGraph,
        probability: float,
        log_likelihood: float,
    ) -> None:
        """Of parts that explain as many rooms the first comes first."""
        self.probability = probability
        self.log_likelihood = log_likelihood
        self.parts = tuple(sorted(parts, key=lambda part: -len(part.rooms)))
        self._online = online

    @cached_property
    def transform(self) -> Placement:
        """The rigid motion nearest to all placements, map to building."""
        own = [part.transform for part in self.parts for _ in part.rooms]
        return best_placement(own, self._centers, self.parts[0].transform.z)

    @property
    def _centers(self) -> Floats:
        room = self._online.room_by_id
        return np.array([room[r].center[:2] for part in self.parts for r in part.rooms])

    @property
    def bend(self) -> float:
        """By how much the parts are turned against each other at most, radians."""
        yaws = [part.transform.yaw for part in self.parts]
        turns = [float(wrap_angle(yaw - self.transform.yaw)) for yaw in yaws]
        return max(turns) - min(turns)

    @cached_property
    def rooms(self) -> dict[str, str]:
        """Explained online rooms and the prior rooms they are."""
        return _together([part.rooms for part in self.parts])

    @cached_property
    def storeys(self) -> dict[str, str]:
        """Online storeys and the prior storeys they are."""
        return _together([part.storeys for part in self.parts])

    @cached_property
    def planes(self) -> dict[str, str]:
        """Online planes and the prior planes they are, one to one."""
        return _together([part.planes for part in self.parts])

    @cached_property
    def objects(self) -> dict[str, str]:
        """Online objects and the prior objects they most likely are."""
        return _together([part.objects for part in self.parts])

    @cached_property
    def also_covers(self) -> dict[str, list[str]]:
        """Further prior rooms whose centres lie within an explained online room."""
        taken = set(self.rooms.values())
        found: dict[str, list[str]] = {}
        for part in self.parts:
            for room, others in part.also_covers.items():
                covered = [other for other in others if other not in taken]
                if covered:
                    found[room] = covered
        return found

    @property
    def moved(self) -> int:
        """How many planes lie off their plan by more than fitting allows."""
        return sum(part.moved for part in self.parts)

    @property
    def rms(self) -> float:
        """Root mean square of the offsets of the planes that fit, metres."""
        return math.sqrt(self._mean([part.rms**2 for part in self.parts]))

    @property
    def score(self) -> float:
        """The mean over the parts, by their rooms."""
        return self._mean([part.score for part in self.parts])

    def _mean(self, values: Sequence[float]) -> float:
        return float(np.average(values, weights=[len(part.rooms) for part in self.parts]))

    @cached_property
    def deviations(self) -> tuple[Deviation, ...]:
        """Walls that lie off their plan, each against the placement of its part."""
        found = {d.plane: d for part in reversed(self.parts) for d in part.deviations}
        return tuple(found[plane] for plane in sorted(found) if plane in self.planes)

    def to_dict(self) -> dict[str, Any]:
        """A solution of the match JSON; ``parts`` has the placements one by one."""
        parts = [
            {
                "rooms": list(part.rooms),
                "transform": msgspec.to_builtins(part.transform),
                "rms": part.rms,
            }
            for part in self.parts
        ]
        return written(self) | {"parts": parts}


def _together(mappings: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """One mapping of several, one to one: what comes first stays."""
    found: dict[str, Any] = {}
    taken: set[Any] = set()
    for mapping in mappings:
        for mine, theirs in mapping.items():
            if mine not in found and theirs not in taken:
                found[mine] = theirs
                taken.add(theirs)
    return found


Answer = Solution | BentSolution
