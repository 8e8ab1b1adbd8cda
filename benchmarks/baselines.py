"""Two other ways to match rooms, for comparison: maximal cliques, and all injections.

Both compare distances between room centres in the plan view and nothing else: neither walls nor
objects, and a mirrored arrangement passes. So they answer less than ``situgraph.match`` does, and
their times are a lower bound of what a whole matcher built on them takes.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from dataclasses import dataclass

import networkx as nx
import numpy as np
from numpy.typing import NDArray

from situgraph.scenegraph.graph import SceneGraph

Rows = tuple[int, ...]


@dataclass(frozen=True)
class Limits:
    """How alike distances are, how many rooms an answer holds, and when to give up.

    ``tolerance`` in metres: four standard deviations of a distance between two centres with 5 cm
    of noise on each axis. ``share`` of the online rooms, rounded up: as ``min_share`` of the
    matching stage. ``seconds`` and ``steps`` (cliques, or rooms tried) stop the search.
    """

    tolerance: float = 0.3
    share: float = 0.7
    seconds: float = 5.0
    steps: int = 5_000_000

    def least(self, rooms: int) -> int:
        return math.ceil(self.share * rooms - 1e-9)


DEFAULT = Limits()


@dataclass(frozen=True)
class Answer:
    """Assignments of online to prior rooms (ids), the steps made, and whether these were all."""

    assignments: tuple[dict[str, str], ...]
    steps: int
    complete: bool


def by_cliques(online: SceneGraph, prior: SceneGraph, limits: Limits = DEFAULT) -> Answer:
    """Maximal cliques of the graph that joins compatible pairs (online room, prior room).

    Two pairs are compatible if both their online and their prior rooms differ and lie equally far
    apart. The time covers the graph too: it is new with each online graph.
    """
    seen, planned = _distances(online), _distances(prior)
    size, least, pairs = len(planned), limits.least(len(seen)), len(seen) * len(planned)
    alike = np.abs(seen[:, None, :, None] - planned[None, :, None, :]) <= limits.tolerance
    alike &= ~np.eye(len(seen), dtype=bool)[:, None, :, None]
    alike &= ~np.eye(size, dtype=bool)[None, :, None, :]
    graph: nx.Graph[int] = nx.Graph()
    graph.add_nodes_from(range(pairs))
    rows, columns = np.nonzero(np.triu(alike.reshape(pairs, pairs)))
    graph.add_edges_from(zip(rows.tolist(), columns.tolist()))
    end, steps = time.perf_counter() + limits.seconds, 0
    found: list[dict[str, str]] = []
    for clique in nx.find_cliques(graph):
        steps += 1
        if len(clique) >= least:
            named = (divmod(pair, size) for pair in sorted(clique))
            found.append({online.rooms[i].id: prior.rooms[j].id for i, j in named})
        if steps >= limits.steps or time.perf_counter() > end:
            return Answer(tuple(found), steps, False)
    return Answer(tuple(found), steps, True)


def by_injections(online: SceneGraph, prior: SceneGraph, limits: Limits = DEFAULT) -> Answer:
    """Every injection of enough online rooms into the prior's, room by room.

    A room takes any free prior room whose distances to those taken before agree, or is left out
    while enough rooms remain.
    """
    seen, planned = _distances(online).tolist(), _distances(prior).tolist()
    count, spare = len(seen), len(seen) - limits.least(len(seen))
    end, steps = time.perf_counter() + limits.seconds, 0

    def extended(room: int, taken: Rows) -> Iterator[Rows]:
        """All ways on from the prior rooms taken so far; -1 stands for a room left out."""
        nonlocal steps
        if room == count:
            yield taken
            return
        for choice, row in enumerate(planned):
            steps += 1
            if steps >= limits.steps or time.perf_counter() > end:
                return
            if choice not in taken and all(
                there < 0 or abs(seen[room][other] - row[there]) <= limits.tolerance
                for other, there in enumerate(taken)
            ):
                yield from extended(room + 1, (*taken, choice))
        if taken.count(-1) < spare:
            yield from extended(room + 1, (*taken, -1))

    found = tuple(
        {online.rooms[i].id: prior.rooms[j].id for i, j in enumerate(rows) if j >= 0}
        for rows in extended(0, ())
    )
    return Answer(found, steps, steps < limits.steps and time.perf_counter() <= end)


def _distances(graph: SceneGraph) -> NDArray[np.float64]:
    """Between all room centres in the plan view, metres (rooms, rooms)."""
    centers = np.array([room.center[:2] for room in graph.rooms])
    gaps: NDArray[np.float64] = np.linalg.norm(centers[:, None] - centers[None], axis=2)
    return gaps
