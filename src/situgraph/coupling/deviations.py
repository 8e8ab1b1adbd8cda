"""As built against as planned: walls moved, missing, extra; doors and windows likewise."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from situgraph.coupling.config import CouplingConfig
from situgraph.coupling.coupled import WallEstimate
from situgraph.coupling.deviation import Deviation, along_of, names_of
from situgraph.coupling.lines import WallLines
from situgraph.coupling.openings import differing_openings
from situgraph.coupling.panes import opened, reach
from situgraph.coupling.walls import stretch
from situgraph.geometry.poses import Array
from situgraph.scenegraph.graph import Object, Plane, SceneGraph

INSIDE = 0.3  # m; a face this far inside a planned room is no wall of it
ALIKE = math.radians(20.0)  # faces that differ less may be one that was built askew
HALF = 0.5  # a face is missing when at least this share of it is open
LEAF = 1.3  # m; no open door leaf with its jamb is longer
HINGE = 0.3  # m; from the side of a door to the end of its leaf's face, and what a leaf is longer
LEAF_GAP = 0.5  # m; two in one line are at least so far apart


def find_deviations(
    seen: SceneGraph,
    prior: SceneGraph,
    walls: Sequence[WallEstimate],
    rooms: Mapping[str, str],
    objects: Mapping[str, str],
    looked_for: Collection[str] | None,
    missed: Callable[[Object, Plane], int] | None,
    lines: WallLines,
    config: CouplingConfig,
) -> tuple[Deviation, ...]:
    """All that differs, walls first.

    Args:
        seen: the S-Graph in the building frame.
        prior: the plan.
        walls: the estimates of all associated faces.
        rooms: online room -> planned room.
        objects: online object -> planned object, as matched.
        looked_for: categories the robot would have seen; None: those that ``seen`` has.
        missed: how many images should have shown a planned opening in its wall; None: enough.
        lines: the walls of the plan.
        config: what is worth telling.
    """
    able = (seen.categories if looked_for is None else set(looked_for)) & prior.modelled
    return (
        *_moved_walls(seen, prior, walls, config),
        *_missing_walls(seen, prior, walls, rooms, config),
        *_extra_walls(seen, prior, walls, rooms, config),
        *differing_openings(seen, prior, walls, rooms, objects, able, missed, lines, config),
    )


def _moved_walls(
    seen: SceneGraph, prior: SceneGraph, walls: Sequence[WallEstimate], config: CouplingConfig
) -> Iterable[Deviation]:
    best: dict[str, tuple[float, WallEstimate]] = {}
    for wall in walls:  # of several online planes on one face the one that covers most of it
        if not seen.rooms_by_plane.get(wall.online):
            continue  # a pane, a recess, a cupboard: what bounds no room is no wall of one
        common = _common(seen.plane_by_id[wall.online], prior.plane_by_id[wall.prior])
        if wall.prior not in best or common > best[wall.prior][0]:
            best[wall.prior] = (common, wall)
    for name, (_, wall) in sorted(best.items()):
        told = max(config.told_offset, config.told_sigmas * wall.offset_sigma)
        face = prior.plane_by_id[name]
        if abs(wall.offset) <= told:
            continue
        of = prior.rooms_by_plane.get(name, ())
        where = "into" if wall.offset > 0 else "away from"
        yield Deviation(
            "moved-wall",
            "wall",
            wall.place,
            f"the wall stands {100 * abs(wall.offset):.0f} cm {where} {names_of(prior, of)} "
            f"(± {100 * wall.offset_sigma:.1f} cm)",
            wall.online,
            name,
            of,
            wall.offset,
            wall.offset_sigma,
            wall.tilt,
            wall.tilt_sigma,
            _element(face),
        )


def _common(plane: Plane, face: Plane) -> float:
    """Metres that a plane and a planned face have in common."""
    along = along_of(face)
    a, b = stretch(plane, along), stretch(face, along)
    return math.inf if a is None or b is None else min(a[1], b[1]) - max(a[0], b[0])


def _missing_walls(
    seen: SceneGraph,
    prior: SceneGraph,
    walls: Sequence[WallEstimate],
    rooms: Mapping[str, str],
    config: CouplingConfig,
) -> Iterable[Deviation]:
    """Planned faces of known rooms that were not seen, and beyond which the room goes on."""
    import shapely

    found = {w.prior for w in walls}
    outlines: dict[str, list[Any]] = {}
    for online, planned in rooms.items():
        outline = seen.room_by_id[online].footprint
        if outline:
            outlines.setdefault(planned, []).append(shapely.Polygon(outline).buffer(0))
    for planned, shapes in sorted(outlines.items()):
        area = shapely.union_all(shapes)
        for name in prior.room_by_id[planned].planes:
            face = prior.plane_by_id[name]
            if name in found or face.virtual or face.extent is None:
                continue
            ends = np.asarray(face.extent, dtype=float)
            length = float(np.linalg.norm(ends[1] - ends[0]))
            low, high = sorted((ends @ along_of(face)).tolist())
            if length - opened(face, (low, high), prior) < config.told_length:
                continue  # short, or hardly more than the doors in it
            n = np.asarray(face.normal[:2]) / np.linalg.norm(face.normal[:2])
            beyond = shapely.LineString(ends - config.seen_beyond * n)
            if float(beyond.intersection(area).length) < HALF * length:
                continue
            middle = ends.mean(axis=0)
            height = prior.room_by_id[planned].center[2]
            yield Deviation(
                "missing-wall",
                "wall",
                (float(middle[0]), float(middle[1]), height),
                f"a wall of {length:.1f} m in {names_of(prior, (planned,))} is not there",
                prior=name,
                rooms=(planned,),
                element=_element(face),
            )


def _extra_walls(
    seen: SceneGraph,
    prior: SceneGraph,
    walls: Sequence[WallEstimate],
    rooms: Mapping[str, str],
    config: CouplingConfig,
) -> Iterable[Deviation]:
    """Faces that bound known rooms, well inside the planned room, where no face was planned."""
    import shapely

    known = {w.online for w in walls}
    for plane in seen.planes:
        if plane.id in known or plane.extent is None:
            continue
        ends = np.asarray(plane.extent, dtype=float)
        length = float(np.linalg.norm(ends[1] - ends[0]))
        sightings = plane.attributes.get("sightings", config.least_sightings)
        seldom = isinstance(sightings, int) and sightings < config.least_sightings
        if length < config.told_length or seldom or _two_leaves(plane, length):
            continue
        line = shapely.LineString(ends)
        for online in seen.rooms_by_plane.get(plane.id, ()):
            room = prior.room_by_id.get(rooms.get(online, ""))
            if room is None or not room.footprint:
                continue
            inside = shapely.Polygon(room.footprint).buffer(-INSIDE)
            if line.intersection(inside).length < HALF * length:
                continue
            if _near_planned(plane, prior, room.planes, config.told_extra):
                continue
            if _is_leaf(ends, prior.objects_by_room.get(room.id, ()), prior):
                continue
            x, y = ends.mean(axis=0).tolist()
            yield Deviation(
                "extra-wall",
                "wall",
                (x, y, room.center[2]),
                f"a wall of {length:.1f} m in {names_of(prior, (room.id,))} was not planned",
                online=plane.id,
                rooms=(room.id,),
            )
            break


def _two_leaves(plane: Plane, length: float) -> bool:
    """Whether a face may be the open leaves of two doors across from each other, in one line."""
    seen = plane.attributes.get("length", length)
    return isinstance(seen, int | float) and seen < min(length - LEAF_GAP, 2.0 * LEAF)


def _is_leaf(ends: Array, objects: Sequence[Object], prior: SceneGraph) -> bool:
    """Whether a face may be the open leaf of a planned door: hung at its side, and no wider."""
    for door in objects:
        if door.category != "door" or door.ellipsoid is None or not door.planes:
            continue
        along = along_of(prior.plane_by_id[door.planes[0]])
        half = reach(door.ellipsoid, along)
        hinges = np.asarray(door.center[:2]) + np.outer((-half, half), along)
        away = np.linalg.norm(ends[:, None] - hinges[None], axis=2).min()
        length = float(np.linalg.norm(ends[1] - ends[0]))
        if away <= HINGE and length <= 2.0 * half + HINGE:
            return True
    return False


def _near_planned(plane: Plane, prior: SceneGraph, faces: Sequence[str], distance: float) -> bool:
    ends = np.asarray(plane.extent, dtype=float)
    n = np.asarray(plane.normal[:2])
    for face in (prior.plane_by_id[f] for f in faces):
        m = np.asarray(face.normal[:2])
        same = m @ n > math.cos(ALIKE)
        if same and float(np.abs(ends @ m + face.offset).mean()) < distance:
            return True
    return False


def _element(face: Plane) -> str | None:
    """The GlobalId at the end of a face's source, ``IfcWall 2O2Fr...``."""
    last = (face.source or "").split(" ")[-1]
    return last if len(last) == 22 else None
