"""A scene graph sorted into storeys, with everything worked out that a drawing needs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property

import msgspec
import numpy as np

from situgraph.errors import InputError
from situgraph.geometry.poses import Array
from situgraph.scenegraph.graph import Object, SceneGraph, Storey
from situgraph.view.config import ViewConfig
from situgraph.view.faces import Faces, wall_faces
from situgraph.view.openings import Opening, place_openings
from situgraph.view.outlines import Outline, room_outlines
from situgraph.view.walls import Walls, wall_bodies


class Shape(msgspec.Struct, frozen=True):
    """A room to draw: where its name stands and, if anything bounds it, its outline."""

    id: str
    name: str
    center: Array
    outline: Outline | None


class Floor(msgspec.Struct, frozen=True, dict=True):
    """One storey. ``key`` is its id, or None where the graph names no storey."""

    key: str | None
    name: str
    elevation: float
    rooms: tuple[Shape, ...]
    faces: Faces
    openings: tuple[Opening, ...]
    objects: tuple[Object, ...]
    path: Array
    config: ViewConfig

    @cached_property
    def walls(self) -> Walls:
        """Wall bodies, worked out when they are first drawn; none where there are many rooms."""
        if len(self.rooms) > self.config.detail_rooms:
            return Walls()
        drawn = [s.outline.polygon for s in self.rooms if s.outline is not None]
        return wall_bodies(drawn, self.faces, self.openings, self.config)

    def loose_faces(self) -> Faces:
        """Faces that bound no room, end somewhere and are not the back of a wall."""
        loose = set(self.walls.loose)
        return self.faces.only(np.array([id in loose for id in self.faces.ids], dtype=bool))

    def points(self) -> Array:
        """What a drawing must show, as points (n, 2): not the trees around a house."""
        parts = [self.faces.segments.reshape(-1, 2), self.path]
        parts += [s.center[None] if s.outline is None else s.outline.polygon for s in self.rooms]
        inside = [o.center[:2] for o in self.objects if o.rooms or not self.rooms]
        return np.concatenate([*parts, np.array(inside, dtype=float).reshape(-1, 2)])


class Building(msgspec.Struct, frozen=True):
    """A graph with its storeys, lowest first."""

    graph: SceneGraph
    floors: tuple[Floor, ...]

    def bounds(
        self, floors: Iterable[Floor] | None = None
    ) -> tuple[float, float, float, float] | None:
        """The least x and y and the greatest x and y (m), or None where nothing is drawn."""
        points = [f.points() for f in (self.floors if floors is None else floors)]
        every = np.concatenate(points) if points else np.zeros((0, 2))
        if not len(every):
            return None
        (x0, y0), (x1, y1) = every.min(axis=0), every.max(axis=0)
        return float(x0), float(y0), float(x1), float(y1)

    def chosen(self, storeys: Sequence[str]) -> tuple[Floor, ...]:
        """The storeys of these ids or names, or all.

        Raises:
            InputError: no storey is called so.
        """
        for wanted in storeys:
            if not any(wanted in (f.key, f.name) for f in self.floors):
                names = ", ".join(f"{f.name} ({f.key})" for f in self.floors) or "none"
                raise InputError(
                    self.graph.name or "the graph",
                    f"has no storey '{wanted}'",
                    f"there are: {names}",
                )
        return tuple(f for f in self.floors if not storeys or {f.key, f.name} & set(storeys))


def survey(graph: SceneGraph, config: ViewConfig) -> Building:
    """Sort a graph into storeys and work out outlines, wall bodies and openings."""
    outlines = room_outlines(graph, config)
    storeys = sorted(graph.storeys, key=lambda s: s.elevation)
    level = _Levels(graph, storeys)
    floors = [_floor(graph, storey, outlines, level, config) for storey in [*storeys, None]]
    return Building(graph, tuple(f for f in floors if len(f.points())))


def cropped(floor: Floor, bounds: tuple[float, float, float, float]) -> Floor:
    """The part of a storey in ``bounds`` (m)."""
    x0, y0, x1, y1 = bounds

    def inside(points: Array) -> bool:
        low, high = points.min(axis=0), points.max(axis=0)
        return bool(low[0] < x1 and high[0] > x0 and low[1] < y1 and high[1] > y0)

    rooms = tuple(
        s for s in floor.rooms
        if inside(s.center[None] if s.outline is None else s.outline.polygon)
    )  # fmt: skip
    low, high = floor.faces.segments.min(axis=1), floor.faces.segments.max(axis=1)
    near = (low < (x1, y1)).all(axis=1) & (high > (x0, y0)).all(axis=1)
    faces = floor.faces.only(near)
    openings = tuple(o for o in floor.openings if inside(o.middle[None]))
    return msgspec.structs.replace(
        floor,
        rooms=rooms,
        faces=faces,
        openings=openings,
        objects=tuple(o for o in floor.objects if inside(np.array([o.center[:2]]))),
    )


class _Levels:
    """Which storey every node belongs to."""

    def __init__(self, graph: SceneGraph, storeys: Sequence[Storey]) -> None:
        self.storeys = storeys
        self.starts = np.array([s.elevation for s in storeys])
        self.room = {r.id: r.storey or self.at(r.center[2], 0.3) for r in graph.rooms}
        self.plane: dict[str, set[str | None]] = {}
        for room in graph.rooms:
            for plane in room.planes:
                self.plane.setdefault(plane, set()).add(self.room[room.id])
        self.object = {o.id: self._of(o) for o in graph.objects}
        self.frame = {k.id: self.at(k.pose[2], 0.3) for k in graph.keyframes}
        only = storeys[0].id if len(storeys) == 1 else None
        self.free = {p.id: only for p in graph.planes if p.id not in self.plane}

    def at(self, height: float, below: float) -> str | None:
        """The highest storey that starts no more than ``below`` above ``height``."""
        if not len(self.storeys):
            return None
        at = int(np.searchsorted(self.starts, height + below, side="right")) - 1
        return self.storeys[max(at, 0)].id

    def _of(self, item: Object) -> str | None:
        rooms = [self.room[r] for r in item.rooms]
        planes = [s for p in item.planes for s in sorted(self.plane.get(p, ()), key=str)]
        at = self.at(item.center[2], 0.0)
        return at if at in (*rooms, *planes) else next(iter([*rooms, *planes]), at)


def _floor(
    graph: SceneGraph,
    storey: Storey | None,
    outlines: Mapping[str, Outline],
    level: _Levels,
    config: ViewConfig,
) -> Floor:
    key = None if storey is None else storey.id
    rooms = [r for r in graph.rooms if level.room[r.id] == key]
    free = [p for p, at in level.free.items() if at == key]
    faces = wall_faces(graph, [r.id for r in rooms], outlines, free, config.wall_gap)
    items = [o for o in graph.objects if level.object[o.id] == key]
    openings, others = place_openings(graph, items, faces, config)
    shapes = tuple(
        Shape(r.id, r.name or r.id, np.array(r.center[:2]), outlines.get(r.id)) for r in rooms
    )
    path = [k.pose[:2] for k in graph.keyframes if level.frame[k.id] == key]
    return Floor(
        key,
        "" if storey is None else storey.name or storey.id,
        0.0 if storey is None else storey.elevation,
        shapes,
        faces,
        openings,
        others,
        np.array(path, dtype=float).reshape(-1, 2),
        config,
    )
