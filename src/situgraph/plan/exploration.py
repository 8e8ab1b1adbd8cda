"""In which order a robot gets to know the rooms of a building: through doors, else along walls."""

from __future__ import annotations

import math

import msgspec
import numpy as np

from situgraph.geometry.poses import Array
from situgraph.plan.contacts import faces_of, find_contacts
from situgraph.scenegraph.graph import SceneGraph

# Rooms are neighbours when their faces stand back to back over this length, this close (m).
COMMON_WALL = 0.5
THICKEST_WALL = 0.6


class Walk(msgspec.Struct, frozen=True):
    """Rooms in the order of their discovery, by row of the prior's rooms.

    ``stops`` (k,) are all rooms walked through, also on the way back, and ``entered`` gives for
    each room of ``order`` its place in ``stops``.
    """

    order: list[int]
    stops: list[int]
    entered: list[int]
    contiguous: bool


class RoomLinks:
    """Which rooms can be reached from which; made once a building."""

    def __init__(self, prior: SceneGraph) -> None:
        """Read the doors, stairs and shared walls of ``prior``."""
        count = len(prior.rooms)
        row = {r.id: i for i, r in enumerate(prior.rooms)}
        self.center: Array = np.array([r.center for r in prior.rooms], dtype=float).reshape(-1, 3)
        doors: set[tuple[int, int]] = set()
        for item in prior.objects:
            rooms = [row[r] for r in item.rooms]
            doors.update((a, b) for a in rooms for b in rooms if a != b)
        walls: set[tuple[int, int]] = set()
        faces, names = faces_of(prior)
        contacts = find_contacts(faces, THICKEST_WALL, COMMON_WALL)
        for a, b in zip(faces.room[contacts.a].tolist(), faces.room[contacts.b].tolist()):
            walls.update(((a, b), (b, a)))
        for rooms_of_plane in prior.rooms_by_plane.values():
            shared = [row[r] for r in rooms_of_plane]
            walls.update((a, b) for a in shared for b in shared if a != b)
        self.doors = _lists(doors, count)
        self.walls = _lists(walls - doors, count)
        self.size = _component_sizes(doors | walls, count)
        #: Planes of the other side of the same wall, by plane id.
        self.back: dict[str, list[str]] = {}
        for a, b in zip(contacts.a.tolist(), contacts.b.tolist()):
            self.back.setdefault(names[a], []).append(names[b])
            self.back.setdefault(names[b], []).append(names[a])

    def walk(self, rooms: int, rng: np.random.Generator, start: int | None = None) -> Walk:
        """Explore ``rooms`` rooms (fewer where there are no more) from a random start.

        From each room the robot goes on through a random door to a room it does not know, or back
        the way it came where there is none; when no door leads on it takes a room behind a wall of
        a known one, and where there is no such room either, the nearest one.
        """
        rooms = min(rooms, len(self.size))
        if start is None:
            able = np.flatnonzero(self.size >= min(rooms, int(self.size.max())))
            start = int(able[rng.integers(len(able))])
        order, stops, entered, way = [start], [start], [0], [start]
        known = {start}
        contiguous = True
        while len(order) < rooms:
            ahead = [r for r in self.doors[way[-1]] if r not in known]
            if not ahead and len(way) > 1:
                way.pop()
                stops.append(way[-1])
                continue
            if not ahead:
                ahead = [r for k in order for r in self.walls[k] + self.doors[k] if r not in known]
            if not ahead:
                contiguous = False
                ahead = [self._nearest(way[-1], known)]
            following = ahead[int(rng.integers(len(ahead)))]
            known.add(following)
            order.append(following)
            stops.append(following)
            way.append(following)
            entered.append(len(stops) - 1)
        return Walk(order, stops, entered, contiguous)

    def _nearest(self, here: int, known: set[int]) -> int:
        away = np.linalg.norm((self.center - self.center[here]) * (1.0, 1.0, 3.0), axis=1)
        away[list(known)] = math.inf
        return int(np.argmin(away))


def _lists(pairs: set[tuple[int, int]], count: int) -> list[list[int]]:
    found: list[list[int]] = [[] for _ in range(count)]
    for a, b in sorted(pairs):
        found[a].append(b)
    return found


def _component_sizes(pairs: set[tuple[int, int]], count: int) -> Array:
    """For each room the number of rooms that can be reached from it, itself included."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    if count == 0:
        return np.zeros(0)
    a, b = np.array(sorted(pairs), dtype=np.int64).reshape(-1, 2).T
    graph = coo_array((np.ones(len(a)), (a, b)), shape=(count, count))
    _, label = connected_components(graph, directed=False)
    return np.asarray(np.bincount(label)[label], dtype=float)
