"""What each wall and object seen may be in the plan, for shifts of the map of a metre and less."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import numpy as np

from situgraph.coupling.config import CouplingConfig
from situgraph.coupling.deviation import along_of
from situgraph.coupling.lines import WallLines
from situgraph.geometry.poses import Array, Placement, wrap_angle
from situgraph.scenegraph.graph import Object, Plane, SceneGraph

LOST = 7.6  # nats: a plane that is none of the plan (docs/matching.md, 'missing' against 'fit')
OBJECT_SIGMA = 0.25  # m (docs/matching.md, section 6)
OBJECT_TAIL = 0.0125  # of the same density, against its peak
OBJECT_REACH = 1.5  # m
STOREY = 1.5  # m; objects farther apart in height are on two storeys
AT_ONCE = 2_000_000  # numbers of the largest array


def median_turn(
    online: SceneGraph, placement: Placement, lines: WallLines, config: CouplingConfig
) -> Placement:
    """The placement turned about the middle of the rooms, so that walls are parallel to the plan's.

    The median over the faces of rooms that have one of their direction in the plan.
    """
    angles = np.arctan2(lines.normals[:, 1], lines.normals[:, 0])
    turns = []
    for plane in online.planes:
        if not online.rooms_by_plane.get(plane.id) or not len(angles):
            continue
        n = placement.vectors(np.asarray(plane.normal[:2], dtype=float))
        away = np.asarray(wrap_angle(math.atan2(n[1], n[0]) - angles))
        nearest = float(away[np.abs(away).argmin()])
        if abs(nearest) <= config.same_angle:
            turns.append(nearest)
    if not turns or not online.rooms:
        return placement
    yaw = placement.yaw - float(np.median(turns))
    middle = np.mean([r.center for r in online.rooms], axis=0)[:2]
    before, after = placement.points(middle), Placement(0.0, 0.0, 0.0, yaw).points(middle)
    x, y = (before - after).tolist()
    return Placement(x, y, placement.z, yaw)


class FaceOptions:
    """Planned faces near each face of a room, for shifts of the map in the building.

    Arrays have a row a face seen, a column an option, and where shifts are asked about a leading
    axis of these.
    """

    def __init__(
        self,
        online: SceneGraph,
        placement: Placement,
        storeys: Mapping[str, str],
        lines: WallLines,
        config: CouplingConfig,
    ) -> None:
        """Find them; ``placement`` is map to building, ``storeys`` online -> planned."""
        self._config, self._lines = config, lines
        found = [
            option
            for plane in online.planes
            if plane.extent is not None and online.rooms_by_plane.get(plane.id)
            for option in [_options(online, plane, placement, storeys, lines, config)]
            if len(option)
        ]
        self.count = len(found)
        width = max((len(f) for f in found), default=0)
        face = np.full((self.count, width), -1)
        for k, option in enumerate(found):
            face[k, : len(option)] = option[:, 0].astype(int)
        seen = np.zeros((self.count, width, 3))
        for k, option in enumerate(found):
            seen[k, : len(option)] = option[:, 1:]
        self._face, self._seen = face, seen
        if not self.count:
            return
        self._normal, self._planned = lines.normals[face], lines.stretches[face]
        walls = [lines.of(lines.names[k]) for k in face.ravel()]
        number = {name: i for i, name in enumerate(dict.fromkeys(walls))}
        self._wall = np.array([number[w] for w in walls]).reshape(face.shape)
        leading = lines.normals[[lines.row[w] for w in number]]
        self._sign = np.sign((self._normal * leading[self._wall]).sum(axis=2))

    def shifts(self) -> Iterator[tuple[Array, float]]:
        """Shifts (m) of the map along a planned normal (2,) that bring a face to its option."""
        for row, option in zip(*np.nonzero(self._face >= 0)):
            yield self._normal[row, option], -float(self._seen[row, option, 0])

    def cost(self, moves: Array) -> Array:
        """What speaks against each shift (p, 2), in nats."""
        size = max(1, AT_ONCE // max(1, self.count**2, self._face.size))
        parts = [self._cost(moves[k : k + size]) for k in range(0, len(moves), size)]
        return np.concatenate(parts) if parts else np.zeros(0)

    def fitted(self, moves: Array, near: float) -> Array:
        """Each shift (p, 2) moved to where the faces that fit within ``near`` m agree best."""
        away, _, chosen = self._chosen(moves)
        found = []
        for p, move in enumerate(moves):
            fits = np.abs(away[p]) <= near
            normals = self._normal[np.flatnonzero(fits), chosen[p, fits]]
            # A weak pull to where it is: walls of one direction leave the other one open.
            normals = np.concatenate([normals, 0.05 * np.eye(2)])
            rest = np.concatenate([-away[p, fits], np.zeros(2)])
            found.append(move + np.linalg.lstsq(normals, rest, rcond=None)[0])
        return np.array(found).reshape(-1, 2)

    def moved(self, move: Array, near: float) -> tuple[str, ...]:
        """Planned faces, one of each wall, farther than ``near`` m away after a shift (2,)."""
        away, wall, chosen = self._chosen(move[None])
        faces: dict[int, str] = {}
        for k in np.flatnonzero(np.abs(away[0]) > near).tolist():
            faces.setdefault(int(wall[0, k]), self._lines.names[self._face[k, chosen[0, k]]])
        return tuple(faces.values())

    def _chosen(self, moves: Array) -> tuple[Array, Array, Array]:
        """Of each face its nearest option after each shift (p, 2).

        How far away (p, n) m, nan where there is none within reach; its wall; its column.
        """
        c = self._config
        tangent = np.stack([-self._normal[..., 1], self._normal[..., 0]], axis=-1)
        away = self._seen[..., 0] + np.tensordot(moves, self._normal, axes=(1, 2))
        slid = np.tensordot(moves, tangent, axes=(1, 2))
        common = np.minimum(self._seen[..., 2] + slid, self._planned[..., 1]) - np.maximum(
            self._seen[..., 1] + slid, self._planned[..., 0]
        )
        half = 0.5 * (self._planned[..., 1] - self._planned[..., 0])
        able = (
            (self._face >= 0)
            & (np.abs(away) <= c.same_offset)
            & (common >= np.minimum(c.least_overlap, half))
        )
        chosen = np.where(able, np.abs(away), np.inf).argmin(axis=2)
        pick = chosen[..., None]
        there = np.take_along_axis(able, pick, axis=2)[..., 0]
        nearest = np.take_along_axis(away, pick, axis=2)[..., 0]
        rows = np.arange(self.count)
        return np.where(there, nearest, np.nan), self._wall[rows, chosen], chosen

    def _cost(self, moves: Array) -> Array:
        away, wall, chosen = self._chosen(moves)
        there = np.isfinite(away)
        along = np.where(there, away * self._sign[np.arange(self.count), chosen], 0.0)
        same = (wall[:, :, None] == wall[:, None, :]) & there[:, :, None] & there[:, None, :]
        # A wall was moved as one of its faces says; the others deviate from it or do not.
        apart = self._weighed(along[:, None, :] - along[:, :, None])
        each = self._weighed(along) + np.where(same, apart, 0.0).sum(axis=2)
        best = np.where(same, each[:, None, :], np.inf).min(axis=2)
        share = np.maximum(same.sum(axis=2), 1)
        lost = LOST * (~there).sum(axis=1)
        return np.asarray(np.where(there, best / share, 0.0).sum(axis=1) + lost)

    def _weighed(self, away: Array) -> Array:
        """Nats against a wall that stands ``away`` m from its plan: built there, or moved."""
        c = self._config
        q = c.reading_moved
        return np.asarray(-np.log((1.0 - q) * np.exp(-0.5 * (away / c.reading_sigma) ** 2) + q))


def _options(
    online: SceneGraph,
    plane: Plane,
    placement: Placement,
    storeys: Mapping[str, str],
    lines: WallLines,
    config: CouplingConfig,
) -> Array:
    """Rows (face, m away from it, first and last metre of the stretch seen) of what it may be."""
    rooms = [online.room_by_id[r] for r in online.rooms_by_plane[plane.id]]
    floors = {storeys.get(r.storey) for r in rooms if r.storey} or set(storeys.values())
    flat = np.asarray(plane.normal[:2], dtype=float)
    length = float(np.linalg.norm(flat))
    flat /= length
    ends = np.asarray(plane.extent, dtype=float)
    d = (plane.offset + plane.normal[2] * rooms[0].center[2]) / length
    ends = placement.points(ends - (ends @ flat + d)[:, None] * flat)
    normal = placement.vectors(flat)
    n = lines.normals
    away = n @ ends.mean(axis=0) + lines.offsets
    seen = np.sort(np.stack([-n[:, 1], n[:, 0]], axis=1) @ ends.T, axis=1)
    planned = lines.stretches
    common = np.minimum(seen[:, 1], planned[:, 1]) - np.maximum(seen[:, 0], planned[:, 0])
    near = (
        (n @ normal >= math.cos(config.same_angle))
        & (np.abs(away) <= config.reading_reach + config.same_offset)
        & (common >= -config.reading_reach)
    )
    rows = [k for k in np.flatnonzero(near).tolist() if lines.storeys[k] & floors or not floors]
    return np.column_stack([rows, away[rows], seen[rows]]) if rows else np.empty((0, 4))


class ObjectOptions:
    """Planned objects of the category near each object seen, for shifts of the map."""

    def __init__(
        self, online: SceneGraph, prior: SceneGraph, placement: Placement, config: CouplingConfig
    ) -> None:
        """Find them. Of an object on a wall only its place along the wall counts: it moves along.

        ``placement`` is map to building.
        """
        self._each: list[tuple[Array, Array]] = []
        for item in online.objects:
            place = placement.points(np.asarray(item.center, dtype=float))
            away, axes = [], []
            for other in prior.objects:
                x = place - np.asarray(other.center)
                if other.category != item.category or abs(x[2]) > STOREY:
                    continue
                if np.hypot(x[0], x[1]) <= OBJECT_REACH:
                    away.append(x[:2])
                    axes.append(_freedom(other, prior))
            if away:
                self._each.append((np.array(away), np.array(axes)))

    def cost(self, moves: Array) -> Array:
        """What speaks against each shift (p, 2), in nats."""
        total = np.zeros(len(moves))
        for away, axes in self._each:
            x = np.einsum("oij,poj->poi", axes, away[None] + moves[:, None])
            near = ((x / OBJECT_SIGMA) ** 2).sum(axis=2).min(axis=1)
            total -= np.log((1.0 - OBJECT_TAIL) * np.exp(-0.5 * near) + OBJECT_TAIL)
        return total


def _freedom(item: Object, prior: SceneGraph) -> Array:
    """Takes (2, 2) a shift to what of it an object can tell: along its wall, else all of it."""
    for name in item.planes:
        if name in prior.plane_by_id:
            along = along_of(prior.plane_by_id[name])
            return np.outer(along, along)
    return np.eye(2)
