"""Where a robot can walk: a grid of clearances on each storey, and shortest ways over it."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from situgraph.geometry.poses import Array
from situgraph.sim.config import RobotConfig
from situgraph.sim.world import World

CELL = 0.05  # m
_COMFORT = 0.7  # m; the robot likes to stay this far from walls where there is space
_SHY = 3.0  # how much longer a way feels at a wall


class Floor:
    """The free space of one storey as a grid of clearances.

    ``free`` is the walkable plan view as a shapely geometry; ``clearance`` (ny, nx) is the distance
    of each cell to the nearest obstacle (m, 0 where not free), ``corner`` (2,) the centre of cell
    (0, 0). Without ``furnished``, furniture and door leaves are not there.
    """

    def __init__(
        self, world: World, index: int, config: RobotConfig, *, furnished: bool = True
    ) -> None:
        import shapely
        from scipy.ndimage import distance_transform_edt

        level = world.levels[index]
        own = {o.object.id for o in level.openings}
        ways = [d.way for d in world.doors if d.passable and d.opening.object.id in own]
        rooms = shapely.union_all(list(level.rooms.values()))
        open_space = shapely.union_all([rooms, level.passages.buffer(0.01), *ways])
        bodies = list(world.bodies[index].values()) if furnished else []
        self.free: Any = open_space.difference(shapely.union_all([world.obstacles[index], *bodies]))
        self._config = config
        x0, y0, x1, y1 = self.free.bounds
        self.corner: Array = np.array([x0 - CELL, y0 - CELL])
        nx, ny = int((x1 - x0) / CELL) + 3, int((y1 - y0) / CELL) + 3
        xs, ys = self.corner[0] + np.arange(nx) * CELL, self.corner[1] + np.arange(ny) * CELL
        shapely.prepare(self.free)
        inside = shapely.contains_xy(self.free, *np.meshgrid(xs, ys))
        # Half a cell less: the obstacle begins somewhere between two cells.
        away = distance_transform_edt(inside) * CELL - CELL / 2
        self.clearance: Array = np.maximum(away, 0.0)

    def cell(self, point: Array) -> tuple[int, int]:
        """The (row, column) of the cell nearest a point (2,)."""
        column, row = np.rint((np.asarray(point) - self.corner) / CELL).astype(int)
        ny, nx = self.clearance.shape
        return int(np.clip(row, 0, ny - 1)), int(np.clip(column, 0, nx - 1))

    def point(self, row: int, column: int) -> Array:
        """The centre (2,) of a cell."""
        return np.asarray(self.corner + CELL * np.array([column, row]))

    def clear(self, points: Array) -> Array:
        """Clearances (n,) at points (n, 2), m."""
        from scipy.ndimage import map_coordinates

        at = ((points - self.corner) / CELL)[:, ::-1].T
        return np.asarray(map_coordinates(self.clearance, at, order=1, mode="nearest"))

    def inside(self, shape: Any) -> NDArray[np.bool_]:
        """Which cells (ny, nx) lie in a shapely polygon."""
        import shapely

        found = np.zeros(self.clearance.shape, dtype=bool)
        x0, y0, x1, y1 = shape.bounds
        (r0, c0), (r1, c1) = self.cell(np.array([x0, y0])), self.cell(np.array([x1, y1]))
        rows, columns = np.mgrid[r0 : r1 + 1, c0 : c1 + 1]
        xs, ys = self.corner[0] + CELL * columns, self.corner[1] + CELL * rows
        found[r0 : r1 + 1, c0 : c1 + 1] = shapely.contains_xy(shape, xs, ys)
        return found

    @cached_property
    def walkable(self) -> NDArray[np.bool_]:
        """Cells (ny, nx) where the robot fits, if tightly."""
        return np.asarray(self.clearance >= self._config.tight_radius)

    @cached_property
    def regions(self) -> NDArray[np.int32]:
        """Cells (ny, nx) labelled by connected region; 0 is not walkable."""
        from scipy.ndimage import label

        return np.asarray(label(self.walkable, np.ones((3, 3)))[0])

    @cached_property
    def main(self) -> NDArray[np.bool_]:
        """Cells (ny, nx) of the largest connected region."""
        sizes = np.bincount(self.regions.ravel())
        sizes[0] = 0
        return np.asarray((self.regions == int(np.argmax(sizes))) & self.walkable)

    def way(self, start: Array, goal: Array) -> Array | None:
        """The way (n, 2) from ``start`` to ``goal`` that keeps off walls; None if there is none."""
        from scipy.sparse.csgraph import dijkstra

        a, b = self.cell(start), self.cell(goal)
        if not self.regions[a] or self.regions[a] != self.regions[b]:
            return None
        number, graph = self._graph
        _, found = dijkstra(graph, indices=int(number[a]), return_predecessors=True)
        cells = [int(number[b])]
        while cells[-1] != number[a]:
            cells.append(int(found[cells[-1]]))
        return np.asarray(self.corner + CELL * self._cells[cells[::-1], ::-1])

    def distances(self, start: Array) -> Array:
        """How far each cell (ny, nx) feels from ``start`` (2,), m; inf where there is no way."""
        from scipy.sparse.csgraph import dijkstra

        field = np.full(self.walkable.shape, np.inf)
        number, graph = self._graph
        if self.walkable[self.cell(start)]:
            field[self.walkable] = dijkstra(graph, indices=int(number[self.cell(start)]))
        return field

    @cached_property
    def _cells(self) -> NDArray[np.int64]:
        return np.argwhere(self.walkable)

    @cached_property
    def _graph(self) -> tuple[NDArray[np.int64], Any]:
        """Numbers of walkable cells and the sparse matrix of costs between neighbours."""
        from scipy.sparse import coo_array

        number: NDArray[np.int64] = np.full(self.walkable.shape, -1, dtype=np.int64)
        number[self.walkable] = np.arange(int(self.walkable.sum()))
        tight = np.clip((_COMFORT - self.clearance) / _COMFORT, 0.0, 1.0)
        felt = 1.0 + _SHY * tight**2
        starts, ends, costs = [], [], []
        ny, nx = number.shape
        for dy, dx in ((0, 1), (1, 0), (1, 1), (1, -1)):
            here = (slice(0, ny - dy), slice(max(0, -dx), nx - max(0, dx)))
            there = (slice(dy, ny), slice(max(0, dx), nx - max(0, -dx)))
            both = (number[here] >= 0) & (number[there] >= 0)
            starts.append(number[here][both])
            ends.append(number[there][both])
            costs.append(np.hypot(dx, dy) * (felt[here][both] + felt[there][both]) / 2)
        i, j, w = np.concatenate(starts), np.concatenate(ends), np.concatenate(costs)
        size = int(self.walkable.sum())
        graph = coo_array((np.r_[w, w], (np.r_[i, j], np.r_[j, i])), shape=(size, size)).tocsr()
        return number, graph
