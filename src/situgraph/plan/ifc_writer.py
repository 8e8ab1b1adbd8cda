"""A-Graph -> IFC4 file: storeys, spaces, walls with openings, doors, windows and fixtures."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from situgraph.errors import InputError
from situgraph.plan.ifc_author import Author
from situgraph.plan.ifc_elements import add_boundaries, add_filling, add_fixture, add_wall
from situgraph.plan.wall_pieces import WallPiece, piece_of, wall_pieces
from situgraph.scenegraph.files import write_atomic
from situgraph.scenegraph.graph import Object, Room, SceneGraph, Storey

# Floor to ceiling where the graph does not say, and the thickness of floors (m).
HEIGHT = 2.8
SLAB = 0.2


def write_ifc(graph: SceneGraph, path: str | os.PathLike[str]) -> Path:
    """Author an IFC4 file of a graph whose rooms have footprints; gives the path back.

    Walls are solids between faces that stand back to back and around the rest; doors and windows
    fill openings cut through them; spaces have the rooms' footprints and heights; other objects
    are boxes of the class of their category. A category without a class of its own becomes a
    proxy. The same graph gives the same bytes. Coordinates are those of the graph, in metres.

    Raises:
        InputError: a room has no footprint, or ``path`` cannot be written.
    """
    from situgraph import __version__

    for room in graph.rooms:
        if room.footprint is None:
            where = f"{graph.name or 'graph'}: room {room.id}"
            raise InputError(where, "has no footprint", "only such rooms can be drawn in IFC")
    if not graph.rooms:
        raise InputError(graph.name or "graph", "it has no rooms", "there is nothing to write")
    author = Author(graph.name or "building", __version__)
    return write_atomic(path, _Building(author, graph).written())


class _Building:
    """One graph on its way into a file."""

    def __init__(self, author: Author, graph: SceneGraph) -> None:
        self.author = author
        self.graph = graph
        self.levels: list[Storey] = list(graph.storeys)
        if any(r.storey is None for r in graph.rooms):
            floor = min(r.center[2] for r in graph.rooms if r.storey is None) - 0.5 * HEIGHT
            self.levels.append(Storey("", "no storey", floor, HEIGHT))
        self.row = {s.id: i for i, s in enumerate(self.levels)}
        self.height = [self._height(s) for s in self.levels]
        self.storeys: list[Any] = []
        self.contents: list[list[Any]] = [[] for _ in self.levels]
        self.spaces: dict[str, Any] = {}

    def written(self) -> bytes:
        author = self.author
        self._structure()
        for room in self.graph.rooms:
            self._space(room)
        by_storey: list[list[Room]] = [[] for _ in self.levels]
        for room in self.graph.rooms:
            by_storey[self.row[room.storey or ""]].append(room)
        for level, rooms in enumerate(by_storey):
            self._slab(level, rooms)
        walls: dict[str, list[WallPiece]] = {}
        bodies: dict[int, Any] = {}
        for number, piece in enumerate(wall_pieces(self.graph)):
            storey = self.storeys[piece.storey]
            wall = add_wall(author, piece, number, storey, self.height[piece.storey])
            self.contents[piece.storey].append(wall)
            bodies[id(piece)] = wall
            for plane in (piece.a, piece.b):
                if plane is not None:
                    walls.setdefault(plane, []).append(piece)
        for item in self.graph.objects:
            piece_here = piece_of(item, walls) if item.category in ("door", "window") else None
            level = self._level(item) if piece_here is None else piece_here.storey
            if piece_here is None:
                made = add_fixture(author, item, self.storeys[level], self.levels[level].elevation)
            else:
                floor = self.levels[level].elevation
                made = add_filling(author, item, piece_here, bodies[id(piece_here)], floor)
                add_boundaries(author, item, piece_here, made, self.spaces)
            self.contents[level].append(made)
        self._aggregate()
        return self.author.text()

    def _height(self, storey: Storey) -> float:
        """Floor to ceiling: twice the way from the floor to the middle of the rooms."""
        half = [
            r.center[2] - storey.elevation
            for r in self.graph.rooms
            if (r.storey or "") == storey.id
        ]
        middle = sorted(half)[len(half) // 2] if half else 0.0
        return 2.0 * middle if middle > 0.5 else storey.height or HEIGHT

    def _structure(self) -> None:
        author = self.author
        site_at = author.placement((0.0, 0.0, 0.0))
        building_at = author.placement((0.0, 0.0, 0.0), under=site_at)
        self.site = author.rooted("IfcSite", "site", Name="site", ObjectPlacement=site_at)
        self.building = author.rooted(
            "IfcBuilding", "building", Name=author.name, ObjectPlacement=building_at
        )
        for storey in self.levels:
            at = author.placement((0.0, 0.0, storey.elevation), under=building_at)
            self.storeys.append(
                author.rooted(
                    "IfcBuildingStorey",
                    f"storey {storey.id}",
                    Name=storey.name or storey.id,
                    ObjectPlacement=at,
                    Elevation=storey.elevation,
                )
            )

    def _space(self, room: Room) -> None:
        assert room.footprint is not None
        level = self.row[room.storey or ""]
        self.spaces[room.id] = self.author.rooted(
            "IfcSpace",
            f"space {room.id}",
            Name=room.name or room.id,
            ObjectPlacement=self._origin(level),
            Representation=self.author.prism(room.footprint, self.height[level]),
            CompositionType="ELEMENT",
            PredefinedType="INTERNAL",
        )

    def _slab(self, level: int, rooms: list[Room]) -> None:
        """One floor slab under all rooms of a storey and the walls between them."""
        import shapely

        area = shapely.union_all([shapely.Polygon(r.footprint) for r in rooms])
        area = area.buffer(0.35, join_style="mitre").buffer(-0.1, join_style="mitre")
        for number, part in enumerate(getattr(area, "geoms", [area])):
            outline = shapely.geometry.polygon.orient(part).exterior.coords[:-1]
            slab = self.author.rooted(
                "IfcSlab",
                f"slab {self.levels[level].id} {number}",
                Name="floor",
                ObjectPlacement=self._origin(level),
                Representation=self.author.prism(
                    [(float(x), float(y)) for x, y in outline], SLAB, -SLAB
                ),
                PredefinedType="FLOOR",
            )
            self.contents[level].append(slab)

    def _aggregate(self) -> None:
        parts = "RelatingObject RelatedObjects"
        relate = self.author.relate
        relate("IfcRelAggregates", "sites", self.author.project, [self.site], parts)
        relate("IfcRelAggregates", "buildings", self.site, [self.building], parts)
        relate("IfcRelAggregates", "storeys", self.building, self.storeys, parts)
        for level, storey in enumerate(self.storeys):
            spaces = [
                self.spaces[r.id] for r in self.graph.rooms if self.row[r.storey or ""] == level
            ]
            if spaces:
                relate("IfcRelAggregates", f"spaces {level}", storey, spaces, parts)
            if self.contents[level]:
                relate(
                    "IfcRelContainedInSpatialStructure", f"contents {level}", storey,
                    self.contents[level], "RelatingStructure RelatedElements",
                )  # fmt: skip

    def _level(self, item: Object) -> int:
        """The storey of the object's first room, else the highest one that is not above it."""
        if item.rooms:
            return self.row[self.graph.room_by_id[item.rooms[0]].storey or ""]
        below = [i for i, s in enumerate(self.levels) if s.elevation <= item.center[2]]
        return max(below, key=lambda i: self.levels[i].elevation, default=0)

    def _origin(self, level: int) -> Any:
        return self.author.placement((0.0, 0.0, 0.0), under=self.storeys[level].ObjectPlacement)
