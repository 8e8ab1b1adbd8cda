"""Doors and windows as built against as planned."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence

import numpy as np

from situgraph.coupling.config import CouplingConfig
from situgraph.coupling.coupled import WallEstimate
from situgraph.coupling.deviation import Deviation, Kind, along_of, names_of
from situgraph.coupling.lines import WallLines
from situgraph.coupling.panes import OPENINGS, reach
from situgraph.coupling.walls import stretch
from situgraph.geometry.poses import Array
from situgraph.scenegraph.graph import Object, Plane, SceneGraph

# (category, place (3,), normal (3,) of its wall, half of its width in m) -> how many images show
# the place and no trace of such a thing; all in the map frame.
Missed = Callable[[str, Array, Array, float], int]


def differing_openings(
    seen: SceneGraph,
    prior: SceneGraph,
    walls: Sequence[WallEstimate],
    rooms: Mapping[str, str],
    objects: Mapping[str, str],
    looked_for: Collection[str],
    missed: Callable[[Object, Plane], int] | None,
    lines: WallLines,
    config: CouplingConfig,
) -> Iterable[Deviation]:
    """Doors and windows on faces that were seen: moved along them, missing, extra.

    ``missed`` counts the images that should have shown one in its wall; None: all did. ``lines``
    are the walls of the plan.
    """
    able = set(looked_for) & set(OPENINGS)
    faces: dict[str, list[str]] = {}
    for wall in walls:
        faces.setdefault(wall.prior, []).append(wall.online)
    told: set[str] = set()
    pairs = _paired(seen, prior, walls, objects, lines, config)
    for item in prior.objects:
        hosts = [p for p in item.planes if p in faces]
        if item.category not in able or not hosts:
            continue
        partner = next((o for o, p in pairs.items() if p == item.id), None)
        along = along_of(prior.plane_by_id[hosts[0]])
        if partner is not None:
            told.add(partner)
            shift = _shift(seen.object_by_id[partner], item, along)
            if abs(shift) > config.moved_object and _sure(seen.object_by_id[partner], config):
                what = f"stands {abs(shift):.2f} m from its planned place"
                yield _about("moved-object", item, prior, what, online=partner, offset=shift)
        elif (
            _looked_at(item, hosts, faces, seen, prior)
            and set(item.rooms) <= set(rooms.values())
            and (missed is None or _missed(item, hosts, prior, missed) >= config.least_sightings)
        ):
            yield _about("missing-object", item, prior, "was planned and not found")
    planned = {w.online for w in walls}
    for item in seen.objects:
        host = next((p for p in item.planes if p in planned), None)
        known = item.id in pairs or not _sure(item, config)
        if item.category not in able or host is None or known:
            continue
        of = tuple(dict.fromkeys(rooms[r] for r in item.rooms if r in rooms))
        yield Deviation(
            "extra-object",
            item.category,
            item.center,
            f"a {item.category} in {names_of(prior, of)} was not planned",
            online=item.id,
            prior=None,
            rooms=of,
        )


def _sure(item: Object, config: CouplingConfig) -> bool:
    """Whether an opening was seen well enough to be told where none was planned.

    What the robot passed has no confidence to be measured, or the full one.
    """
    sightings = item.attributes.get("seen", config.least_sightings)
    seldom = isinstance(sightings, int) and sightings < config.least_sightings
    confident = item.confidence is None or item.confidence >= config.told_confidence
    return confident and not seldom


def _shift(seen: Object, planned: Object, along: Array) -> float:
    """The least shift (m) along a wall under which one of them covers the other.

    Half a window that was seen is not a window that was moved.
    """
    apart = float(along @ _flat(seen, planned))
    if seen.ellipsoid is None or planned.ellipsoid is None:
        return apart
    wider = abs(reach(seen.ellipsoid, along) - reach(planned.ellipsoid, along))
    return math.copysign(max(abs(apart) - wider, 0.0), apart)


def _missed(
    item: Object,
    hosts: Sequence[str],
    prior: SceneGraph,
    missed: Callable[[Object, Plane], int],
) -> int:
    return max(missed(item, prior.plane_by_id[host]) for host in hosts)


def _paired(
    seen: SceneGraph,
    prior: SceneGraph,
    walls: Sequence[WallEstimate],
    objects: Mapping[str, str],
    lines: WallLines,
    config: CouplingConfig,
) -> dict[str, str]:
    """Openings seen and planned that are one: the nearest on the same wall, else as matched.

    The wall, not the face: a door at the end of what was seen of one face may be in the next.
    """
    lines_of: dict[str, set[str]] = {}
    for wall in walls:
        lines_of.setdefault(wall.online, set()).add(lines.of(wall.prior))
    planned: dict[str, list[Object]] = {}
    for other in prior.objects:
        for line in sorted({lines.of(p) for p in other.planes}):
            planned.setdefault(line, []).append(other)
    options = []
    for item in seen.objects:
        for line in sorted(set().union(*(lines_of.get(p, set()) for p in item.planes))):
            for other in planned.get(line, ()):
                away = float(np.linalg.norm(_flat(item, other)))
                if other.category == item.category and away <= config.same_object:
                    options.append((away, item.id, other.id))
    matched = [(o, p) for o, p in objects.items() if o in seen.object_by_id]
    pairs: dict[str, str] = {}
    taken: set[str] = set()
    for one, two in [(a, b) for _, a, b in sorted(options)] + sorted(matched):
        if one not in pairs and two not in taken and two in prior.object_by_id:
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
        along = along_of(prior.plane_by_id[host])
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
        f"the {item.category} of {names_of(prior, item.rooms)} {what}",
        online=online,
        prior=item.id,
        rooms=item.rooms,
        offset=offset,
        element=guid if isinstance(guid, str) else None,
    )


def _flat(one: Object, two: Object) -> Array:
    return np.subtract(one.center[:2], two.center[:2], dtype=float)
