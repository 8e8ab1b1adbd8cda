"""Scene graphs as tables: rooms of plan lines, as section 1 of ``docs/matching.md`` has them."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from itertools import accumulate
from typing import Any, NamedTuple, NoReturn

import numpy as np

from situgraph.errors import InputError
from situgraph.matching.blocks import Block
from situgraph.matching.config import MatchingConfig
from situgraph.matching.tables import Floats, Ints, Limits
from situgraph.scenegraph.graph import SceneGraph


def limits_of(config: MatchingConfig, sigma: float) -> Limits:
    """The constants of the search; ``sigma`` (m) is the standard deviation of offsets."""
    peak = (1 - config.p_moved - config.p_missing) * config.clutter_length
    together = config.p_together * 2 * config.moved_limit / config.p_moved
    values: dict[str, Any] = {
        "fit": config.plane_offset_tolerance,
        "moved": config.moved_limit,
        "angle": config.angle_tolerance,
        "sine": config.parallel_sine,
        "fit_peak": math.log(peak / (math.sqrt(2 * math.pi) * sigma)),
        "moved_base": math.log(config.p_moved * config.clutter_length / (2 * config.moved_limit)),
        "together": together / (2 * math.sqrt(math.pi) * sigma),
        "alone": 1 - config.p_together,
        "apart_weight": 1 / (4 * sigma**2),
        "thickness": config.wall_thickness,
        "missing": math.log(config.p_missing),
        "missing_shared": math.log(config.p_missing_shared),
        "room_true": math.log(1 - config.p_false_room),
        "room_false": math.log(config.p_false_room),
        "other_room": config.p_other_room,
        "shape_gain": config.shape_gain,
        "tied": math.log1p(config.p_tied * config.shape_gain),
        "plane_weight": 1 / (2 * sigma**2),
        "angle_weight": 1 / (2 * config.angle_sigma**2),
        "same_distance": config.same_distance,
        "same_yaw": config.same_yaw,
        "smallest_step": config.smallest_step,
        "peak_step": config.peak_step,
        "max_boxes": config.max_boxes,
        "max_work": config.max_work,
    }
    return Limits(**values, slots=Block(Limits, {}, **values))


class Constants:
    """The constants of searches in maps of any spread, made when they are first asked for."""

    def __init__(self, config: MatchingConfig) -> None:
        """By these settings."""
        self._config = config
        self._limits: dict[float, Limits] = {}

    def limits(self, sigma: float) -> Limits:
        """Those of this standard deviation of offsets (m)."""
        found = self._limits.get(sigma)
        if found is None:
            found = self._limits[sigma] = limits_of(self._config, sigma)
        return found


class Listed(NamedTuple):
    """The rooms of a graph that count, those of two usable planes, and all planes."""

    kept: list[int]  # which rooms of the graph they are
    planes: list[list[int]]  # the usable planes of each
    row: dict[str, int]  # of each plane of the graph
    equation: list[float]  # normal and offset of each plane of the graph, one after the other
    steep: set[int]  # planes of the graph that are not usable
    graph: SceneGraph


class Rooms(NamedTuple):
    """The same as arrays."""

    center: Floats  # (N, 3)
    equation: Floats  # (p, 4) normal and offset of each plane of the graph
    kept: Ints  # (N,) which rooms of the graph they are
    first: Ints  # (N + 1,) the rows of each
    source: Ints  # (P,) the plane of each row

    @property
    def room(self) -> Ints:
        """The room of each row (P,)."""
        return np.repeat(np.arange(len(self.kept)), np.diff(self.first))


def list_rooms(graph: SceneGraph, tilt: float, before: Listed | None = None) -> Listed:
    """The rooms that count; a plane is usable when its normal is as near to horizontal as ``tilt``.

    What the graph begins with as the one listed ``before``, by the same tilt, is not read again.

    Raises:
        InputError: a room names a plane that is not there, an id is there twice, or a plane is not
            finite.
    """
    steepest = math.sin(tilt) + 1e-12
    row: dict[str, int] = {}
    equation: list[float] = []
    steep: set[int] = set()
    kept: list[int] = []
    rows: list[list[int]] = []
    planes_read = rooms_read = 0
    if before is not None and begins(graph.planes, before.graph.planes):
        planes_read = len(before.graph.planes)
        row, equation, steep = {**before.row}, [*before.equation], {*before.steep}
        if begins(graph.rooms, before.graph.rooms):
            rooms_read = len(before.graph.rooms)
            kept, rows = [*before.kept], [*before.planes]
    for k, p in enumerate(graph.planes[planes_read:], planes_read):
        row[p.id] = k
        x, y, z = p.normal
        equation += (x, y, z, p.offset)
        if z > steepest or z < -steepest:
            steep.add(k)
    for k, room in enumerate(graph.rooms[rooms_read:], rooms_read):
        try:
            planes = [row[name] for name in room.planes]
        except KeyError as error:
            problem = f"a room names the plane {error.args[0]!r}, which is not there"
            raise InputError(graph.name or "scene graph", problem, "add the plane") from error
        if steep:
            planes = [plane for plane in planes if plane not in steep]
        if len(planes) > 1:
            kept.append(k)
            rows.append(planes)
    _check(graph, row, equation)
    return Listed(kept, rows, row, equation, steep, graph)


def _check(graph: SceneGraph, row: dict[str, int], equation: list[float]) -> None:
    """Refuse what a file could not hold, but a graph that was made by a program may."""
    source = graph.name or "scene graph"
    if not math.isfinite(sum(equation)):
        finite = (math.isfinite(sum(p.normal) + p.offset) for p in graph.planes)
        name = next((p.id for p, fine in zip(graph.planes, finite) if not fine), "")
        raise InputError(source, f"the plane {name!r} is not finite", "leave it out")
    if not math.isfinite(sum(x for room in graph.rooms for x in room.center)):
        name = next(r.id for r in graph.rooms if not math.isfinite(sum(r.center)))
        raise InputError(source, f"the centre of room {name!r} is not finite", "leave it out")
    if len(row) != len(graph.planes):
        _refuse(source, "plane", [plane.id for plane in graph.planes])
    names = [room.id for room in graph.rooms]
    if len(set(names)) != len(names):
        _refuse(source, "room", names)


def _refuse(source: str, what: str, names: list[str]) -> NoReturn:
    name = Counter(names).most_common(1)[0][0]
    raise InputError(source, f"the {what} {name!r} is there twice", "give each its own id")


def begins(things: tuple[Any, ...], with_these: tuple[Any, ...]) -> bool:
    """Whether rooms, planes or objects begin with others; quick where they are the same ones."""
    return things[: len(with_these)] == with_these


def read_rooms(graph: SceneGraph, tilt: float) -> Rooms:
    """Those of ``list_rooms`` as arrays."""
    listed = list_rooms(graph, tilt)
    center = [x for k in listed.kept for x in graph.rooms[k].center]
    return Rooms(
        np.array(center, dtype=np.float64).reshape(-1, 3),
        np.fromiter(listed.equation, dtype=np.float64).reshape(-1, 4),
        np.array(listed.kept, dtype=np.int64),
        np.array([0, *accumulate(map(len, listed.planes))], dtype=np.int64),
        np.array([k for planes in listed.planes for k in planes], dtype=np.int64),
    )


def plan_lines(rooms: Rooms) -> tuple[Floats, Floats]:
    """Each row as a line in the plan: its normal (P, 2), its distance of the room's centre (P,)."""
    plane, center = rooms.equation[rooms.source], rooms.center[rooms.room]
    flat = np.hypot(plane[:, 0], plane[:, 1])
    reach = np.einsum("ij,ij->i", plane[:, :3], center) + plane[:, 3]
    return plane[:, :2] / flat[:, None], reach / flat


def storey_heights(graph: SceneGraph, rooms: Sequence[int]) -> list[float]:
    """The elevation of the storey of each of these rooms."""
    elevation = {s.id: s.elevation for s in graph.storeys}
    named = [graph.rooms[k].storey for k in rooms]
    return [elevation.get(storey, 0.0) if storey else 0.0 for storey in named]
