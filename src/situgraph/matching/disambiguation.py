"""What to look for next: the observations that tell the solutions of an ambiguous match apart.

Each solution predicts objects, walls and rooms that were not seen yet (``predictions``). An
observation is worth the information it is expected to give about which solution is right.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Sequence
from typing import Any, NamedTuple, TypeVar

import numpy as np

from situgraph.matching.bent_solution import Answer
from situgraph.matching.predictions import (
    FACING,
    Kind,
    Outline,
    Prediction,
    depth,
    predictions,
    seen_from,
)
from situgraph.scenegraph.graph import SceneGraph

T = TypeVar("T")

MOST_SOLUTIONS = 64  # told apart
LEAST_GAIN = 0.01  # nats
SAME_OBJECT = 0.8  # metres; objects this near are one: three sigma of their places
SAME_WALL = 0.3  # metres; walls this near cannot be told apart: twice the tolerance of one
SAME_ENTRANCE = 1.0  # metres
COSTS: dict[Kind, int] = {"object": 1, "wall": 2, "room": 3}  # a glance, a step, a walk


class Advice(NamedTuple):
    """An observation that splits the solutions.

    Attributes:
        look_for: a category of objects, ``wall`` (how far it is) or ``room`` (behind a door).
        on_plane: the prior plane it is on, under the first solution that knows it.
        in_room: the prior room in which to look, under the same solution.
        splits: numbers of the solutions that predict the same, group by group.
        from_room: the online room from which it is seen.
        place: where in the map (x, y), metres; of a room, just behind its entrance.
        gain: information expected, nats.
        kind: object, wall or room.
    """

    look_for: str
    on_plane: str | None
    in_room: str
    splits: tuple[tuple[int, ...], ...]
    from_room: str
    place: tuple[float, float]
    gain: float
    kind: Kind

    def to_dict(self) -> dict[str, Any]:
        """A piece of advice of the match JSON."""
        return {
            "look_for": self.look_for,
            "on_plane": self.on_plane,
            "in_room": self.in_room,
            "splits": [list(group) for group in self.splits],
            "from_room": self.from_room,
            "place": list(self.place),
            "gain": self.gain,
        }


def advise(
    solutions: Sequence[Answer],
    online: SceneGraph,
    prior: SceneGraph,
    *,
    looked: float,
    contents: bool,
) -> tuple[Advice, ...]:
    """The observations that tell the solutions apart, the most telling first.

    ``looked`` is the probability that what can be seen of objects in the rooms was seen, so that
    another look tells nothing new. ``contents``: whether objects are evidence at all.
    """
    told = solutions[:MOST_SOLUTIONS]
    if len(told) < 2:
        return ()
    chance = np.array([s.probability for s in told])
    every = [predictions(s, online, prior) for s in told]
    found = [
        *(_on_walls(every, chance, 1.0 - looked) if contents else ()),
        *_unseen_walls(every, chance),
        *_next_rooms(every, chance, contents),
    ]
    found.sort(key=lambda a: (-round(a.gain, 2), COSTS[a.kind], a.from_room, a.place))
    return tuple(a for a in found if a.gain >= LEAST_GAIN)


def _on_walls(every: list[list[Prediction]], chance: Any, worth: float) -> list[Advice]:
    """Objects on a wall of a room that was seen; a solution that predicts none says so."""
    by_key: dict[Hashable, dict[int, Prediction]] = {}
    for k, one in enumerate(every):
        for p in one:
            if p.kind == "object":
                by_key.setdefault((p.room, p.plane, p.look_for), {})[k] = p
    rooms = [{p.room for p in one} for one in every]
    found = []
    for predicted in by_key.values():
        first = next(iter(predicted.values()))
        outcomes: dict[int, Outline] = {
            k: predicted[k].outcome if k in predicted else ()
            for k in range(len(every))
            if k in predicted or first.room in rooms[k]
        }
        groups = _grouped(outcomes, _same_places)
        found += _advice(first, groups, chance, worth)
    return found


def _unseen_walls(every: list[list[Prediction]], chance: Any) -> list[Advice]:
    """Walls of a room that was seen without them."""
    known = [(k, p) for k, one in enumerate(every) for p in one if p.kind == "wall"]
    found, used = [], set()
    for number, (_, first) in enumerate(known):
        if number in used:
            continue
        outcomes: dict[int, Outline] = {}
        for other, (k, p) in enumerate(known):
            facing = abs(math.remainder(p.outcome[0][0] - first.outcome[0][0], 2 * math.pi))
            if p.room == first.room and facing <= FACING:
                used.add(other)
                outcomes[k] = tuple(sorted((*outcomes.get(k, ()), (0.0, p.outcome[0][1]))))
        found += _advice(first, _grouped(outcomes, _same_walls), chance, 1.0)
    return found


def _next_rooms(every: list[list[Prediction]], chance: Any, contents: bool) -> list[Advice]:
    """What lies behind an entrance.

    Whether there is one is seen from the room before it; so only the solutions that know of one
    there are told apart by walking through it.
    """
    known = [(k, p) for k, one in enumerate(every) for p in one if p.kind == "room"]
    found, used = [], set()
    for number, (_, first) in enumerate(known):
        if number in used:
            continue
        behind: dict[int, Prediction] = {}
        for other, (k, p) in enumerate(known):
            if p.room != first.room or depth(p.outcome, p.place, first.place) < -SAME_WALL:
                continue
            if math.dist(p.place, first.place) <= SAME_ENTRANCE:
                used.add(other)
            here = seen_from(p, first.place)
            behind.setdefault(k, here if contents else here._replace(contents=()))
        found += _advice(first, _grouped(behind, _same_room), chance, 1.0)
    return found


def _advice(first: Prediction, groups: list[list[int]], chance: Any, worth: float) -> list[Advice]:
    """The observation, if it splits anything; its worth is a share of the entropy of the groups."""
    if len(groups) < 2:
        return []
    mass = np.array([chance[group].sum() for group in groups])
    share = np.maximum(mass / mass.sum(), 1e-300)
    gain = -float((share * np.log(share)).sum())
    splits = tuple(sorted(tuple(group) for group in groups))
    return [
        Advice(
            first.look_for, first.planned_plane, first.planned_room, splits,
            first.room, first.place, worth * gain, first.kind,
        )
    ]  # fmt: skip


def _grouped(outcomes: dict[int, T], same: Callable[[T, T], bool]) -> list[list[int]]:
    """Solutions whose outcomes look the same as that of the first of their group."""
    groups: list[tuple[T, list[int]]] = []
    for k, outcome in sorted(outcomes.items(), key=lambda item: item[0]):
        for example, members in groups:
            if same(example, outcome):
                members.append(k)
                break
        else:
            groups.append((outcome, [k]))
    return [members for _, members in groups]


def _same_places(one: Outline, two: Outline) -> bool:
    return len(one) == len(two) and all(
        any(math.dist(p, q) <= SAME_OBJECT for q in two) for p in one
    )


def _same_walls(one: Outline, two: Outline) -> bool:
    return len(one) == len(two) and all(
        any(
            abs(math.remainder(p[0] - q[0], 2 * math.pi)) <= FACING
            and abs(p[1] - q[1]) <= SAME_WALL
            for q in two
        )
        for p in one
    )


def _same_room(one: Prediction, two: Prediction) -> bool:
    return one.contents == two.contents and _same_walls(one.outcome, two.outcome)
