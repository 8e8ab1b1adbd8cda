"""As built against as planned: walls moved, missing, extra; doors and windows likewise."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import Any, Literal

import msgspec
import numpy as np

from situgraph.coupling.config import CouplingConfig
from situgraph.coupling.coupled import WallEstimate
from situgraph.coupling.walls import stretch
from situgraph.geometry.poses import Array
from situgraph.scenegraph.graph import Object, Plane, SceneGraph, Vec3

Kind = Literal[
    "moved-wall", "missing-wall", "extra-wall", "moved-object", "missing-object", "extra-object"
]
OPENINGS = ("door", "window")  # what a wall has, and what detectors are made for
INSIDE = 0.3  # m; a face this far inside a planned room is no wall of it
ALIKE = math.radians(20.0)  # faces that differ less may be one that was built askew
HALF = 0.5  # a face is missing when at least this share of it is open


class Deviation(msgspec.Struct, frozen=True, omit_defaults=True):
    """One difference between the building and its plan, in the building frame.

    Attributes:
        kind: what differs.
        category: ``wall``, or the object's.
        place: where (m).
        online: id of what was seen; None for what was not.
        prior: id of what was planned; None for what was not.
        rooms: the planned rooms concerned.
        offset: how far it lies from its planned place (m); of a wall positive along the planned
            normal into the room, of an object along its wall.
        sigma: standard deviation of ``offset`` (m).
        tilt: how far a wall is turned in the plan (rad).
        tilt_sigma: its standard deviation (rad).
        element: GlobalId of the planned element, where the plan names it.
        message: all of this in a sentence.
    """

    kind: Kind
    category: str
    place: Vec3
    message: str
    online: str | None = None
    prior: str | None = None
    rooms: tuple[str, ...] = ()
    offset: float | None = None
    sigma: float | None = None
    tilt: float | None = None
    tilt_sigma: float | None = None
    element: str | None = None


def find_deviations(
    seen: SceneGraph,
    prior: SceneGraph,
    walls: Sequence[WallEstimate],
    rooms: Mapping[str, str],
    objects: Mapping[str, str],
    looked_for: Collection[str] | None,
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
        config: what is worth telling.
    """
    able = (seen.categories if looked_for is None else set(looked_for)) & prior.modelled
    return (
        *_moved_walls(seen, prior, walls, config),
        *_missing_walls(seen, prior, walls, rooms, config),
        *_extra_walls(seen, prior, walls, rooms, config),
        *_openings(seen, prior, walls, rooms, objects, able, config),
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
        if abs(wall.offset) <= told:
            continue
        of = prior.rooms_by_plane.get(name, ())
        where = "into" if wall.offset > 0 else "away from"
        yield Deviation(
            "moved-wall",
            "wall",
            wall.place,
            f"the wall stands {100 * abs(wall.offset):.0f} cm {where} {_names(prior, of)} "
            f"(± {100 * wall.offset_sigma:.1f} cm)",
            wall.online,
            name,
            of,
            wall.offset,
            wall.offset_sigma,
            wall.tilt,
            wall.tilt_sigma,
            _element(prior.plane_by_id[name]),
        )


def _common(plane: Plane, face: Plane) -> float:
    """Metres that a plane and a planned face have in common."""
    along = _along(face)
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
            if length < config.told_length:
                continue
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
                f"a wall of {length:.1f} m in {_names(prior, (planned,))} is not there",
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
        if length < config.told_length or seldom:
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
            x, y = ends.mean(axis=0).tolist()
            yield Deviation(
                "extra-wall",
                "wall",
                (x, y, room.center[2]),
                f"a wall of {length:.1f} m in {_names(prior, (room.id,))} was not planned",
                online=plane.id,
                rooms=(room.id,),
            )
            break


def _near_planned(plane: Plane, prior: SceneGraph, faces: Sequence[str], distance: float) -> bool:
    ends = np.asarray(plane.extent, dtype=float)
    n = np.asarray(plane.normal[:2])
    for face in (prior.plane_by_id[f] for f in faces):
        m = np.asarray(face.normal[:2])
        same = m @ n > math.cos(ALIKE)
        if same and float(np.abs(ends @ m + face.offset).mean()) < distance:
            return True
    return False


def _openings(
    seen: SceneGraph,
    prior: SceneGraph,
    walls: Sequence[WallEstimate],
    rooms: Mapping[str, str],
    objects: Mapping[str, str],
    looked_for: Collection[str],
    config: CouplingConfig,
) -> Iterable[Deviation]:
    """Doors and windows on faces that were seen: moved along them, missing, extra."""
    able = set(looked_for) & set(OPENINGS)
    faces: dict[str, list[str]] = {}
    for wall in walls:
        faces.setdefault(wall.prior, []).append(wall.online)
    told: set[str] = set()
    pairs = _paired(seen, prior, walls, objects, config)
    for item in prior.objects:
        hosts = [p for p in item.planes if p in faces]
        if item.category not in able or not hosts:
            continue
        partner = next((o for o, p in pairs.items() if p == item.id), None)
        along = _along(prior.plane_by_id[hosts[0]])
        if partner is not None:
            told.add(partner)
            shift = float(along @ _flat(seen.object_by_id[partner], item))
            if abs(shift) > config.moved_object:
                what = f"stands {abs(shift):.2f} m from its planned place"
                yield _about("moved-object", item, prior, what, online=partner, offset=shift)
        elif _looked_at(item, hosts, faces, seen, prior) and set(item.rooms) <= set(rooms.values()):
            yield _about("missing-object", item, prior, "was planned and not found")
    planned = {w.online for w in walls}
    for item in seen.objects:
        host = next((p for p in item.planes if p in planned), None)
        sightings = item.attributes.get("sightings", config.least_sightings)
        seldom = isinstance(sightings, int) and sightings < config.least_sightings
        if item.category not in able or host is None or item.id in pairs or seldom:
            continue
        of = tuple(dict.fromkeys(rooms[r] for r in item.rooms if r in rooms))
        yield Deviation(
            "extra-object",
            item.category,
            item.center,
            f"a {item.category} in {_names(prior, of)} was not planned",
            online=item.id,
            prior=None,
            rooms=of,
        )


def _paired(
    seen: SceneGraph,
    prior: SceneGraph,
    walls: Sequence[WallEstimate],
    objects: Mapping[str, str],
    config: CouplingConfig,
) -> dict[str, str]:
    """Openings seen and planned that are one: as matched, else the nearest on the same face."""
    pairs = {o: p for o, p in objects.items() if o in seen.object_by_id and p in prior.object_by_id}
    faces_of: dict[str, set[str]] = {}
    for wall in walls:
        faces_of.setdefault(wall.online, set()).add(wall.prior)
    taken = set(pairs.values())
    options = []
    for item in seen.objects:
        if item.id in pairs:
            continue
        for face in sorted(set().union(*(faces_of.get(p, set()) for p in item.planes))):
            for other in prior.objects_by_plane.get(face, ()):
                if other.category == item.category and other.id not in taken:
                    away = float(np.linalg.norm(_flat(item, other)))
                    if away <= config.same_object:
                        options.append((away, item.id, other.id))
    for _, one, two in sorted(options):
        if one not in pairs and two not in taken:
            pairs[one] = two
            taken.add(two)
    return pairs


def _looked_at(
    item: Object,
    hosts: Sequence[str],
    faces: Mapping[str, list[str]],
    seen: SceneGraph,
    prior: SceneGraph,
) -> bool:
    """Whether the stretch of wall around an opening was seen."""
    for host in hosts:
        along = _along(prior.plane_by_id[host])
        at = float(along @ np.asarray(item.center[:2]))
        for name in faces[host]:
            span = stretch(seen.plane_by_id[name], along)
            if span is not None and span[0] < at < span[1]:
                return True
    return False


def _about(
    kind: Kind,
    item: Object,
    prior: SceneGraph,
    what: str,
    online: str | None = None,
    offset: float | None = None,
) -> Deviation:
    guid = item.attributes.get("guid")
    return Deviation(
        kind,
        item.category,
        item.center,
        f"the {item.category} of {_names(prior, item.rooms)} {what}",
        online=online,
        prior=item.id,
        rooms=item.rooms,
        offset=offset,
        element=guid if isinstance(guid, str) else None,
    )


def _along(face: Plane) -> Array:
    n = np.asarray(face.normal[:2], dtype=float)
    along: Array = np.array([-n[1], n[0]], dtype=float)
    along /= np.hypot(n[0], n[1])
    return along


def _flat(one: Object, two: Object) -> Array:
    return np.subtract(one.center[:2], two.center[:2], dtype=float)


def _element(face: Plane) -> str | None:
    """The GlobalId at the end of a face's source, ``IfcWall 2O2Fr...``."""
    last = (face.source or "").split(" ")[-1]
    return last if len(last) == 22 else None


def _names(graph: SceneGraph, rooms: Sequence[str]) -> str:
    names = [str(graph.room_by_id[r].name or r) for r in rooms if r in graph.room_by_id]
    return " and ".join(names) if names else "the building"
