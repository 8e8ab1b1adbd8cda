"""Doors and windows as what they are: stretches of a wall.

A door that stands open drags its ellipsoid into the room, a pane is seen from both sides of a wall,
and a wall seen in part gives half a window. What belongs to the opening is what lies in the wall:
the frame, the closed leaf, the pane. So each object of these kinds is projected into the wall that
holds most of its points, and stretches of one wall that cover each other become one opening, from
whichever side they were seen.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from situgraph.geometry.poses import Array
from situgraph.objects.association import confidence, sightings
from situgraph.objects.config import ObjectsConfig
from situgraph.objects.gaps import WallGap
from situgraph.objects.hosting import BEHIND, ENOUGH, host_of, in_walls
from situgraph.objects.relations import RoomView, tangent
from situgraph.scenegraph.graph import Ellipsoid, Object

JAMB = 0.3  # m; a jamb that is seen beside a gap is no wider
COLUMN = 0.1  # m; width of the columns in which sightings along a wall are counted
FILLS = 0.85  # of a face's length; what is wider has no wall beside it
DOOR_HITS = 2.0  # frames that saw a point of a door for it to bound the door
VALLEY = 0.25  # of a well-seen column's sightings; where there are fewer, nothing is
TRIM = (0.02, 0.98)  # share of the points that bound the opening along and up the wall


@dataclass(frozen=True, eq=False)
class Seen:
    """What the camera saw of one thing: points (n, 3) in the map, frames that saw each (n,)."""

    number: int
    category: str
    points: Array
    hits: Array
    seen: int
    expected: int
    score: float
    frames: tuple[int, ...] = ()  # the latest that saw it
    due: tuple[int, ...] = ()  # the latest that should have


@dataclass(frozen=True)
class Stretch:
    """A part of a wall's face: ``low`` to ``high`` (m) along it, ``bottom`` to ``top`` up."""

    category: str
    view: int
    face: int
    low: float
    high: float
    bottom: float
    top: float
    weight: float  # sightings of its points, summed
    numbers: tuple[int, ...]
    seen: int
    expected: int
    score: float
    frames: tuple[int, ...]
    due: tuple[int, ...]

    @property
    def confidence(self) -> float:
        """Of the opening, from all that was seen of it."""
        return confidence(self.seen, self.expected, self.score)


@dataclass(frozen=True)
class Openings:
    """``given``: seen well enough; ``weak``: not by the camera alone; ``homeless``: in no wall."""

    given: list[Object]
    weak: list[Object]
    homeless: list[int]


def openings(
    things: Sequence[Seen],
    views: tuple[RoomView, ...],
    config: ObjectsConfig,
    gaps: Sequence[WallGap] = (),
) -> Openings:
    """The openings in the rooms' walls, and the numbers of the things that lie in no wall.

    Of a door and a window that claim the same stretch, the one with more sightings stands. Of wide
    doors and of open ones often one jamb is all that the camera knows: such a piece of a door is
    the whole gap that it bounds.
    """
    stretches: list[Stretch] = []
    homeless = []
    for thing in things:
        own = _stretches(thing, views, config)
        if own is None:
            homeless.append(thing.number)
        else:
            stretches += own
    found = _merged(stretches, views, config)
    found = _merged([_filled(s, gaps, views, config) for s in found], views, config)
    named = [(key, s) for key, s in _named(found) if _plausible(s, views, config)]
    sure = {
        key
        for key, s in named
        if _seen_enough(s, gaps, views, config) and _framed(s, views, config)
    }
    objects = [_object(key, s, views) for key, s in named]
    return Openings(
        [o for o in objects if o.id in sure], [o for o in objects if o.id not in sure], homeless
    )


def _merged(
    stretches: Sequence[Stretch], views: tuple[RoomView, ...], config: ObjectsConfig
) -> list[Stretch]:
    found: list[Stretch] = []
    for stretch in sorted(stretches, key=lambda s: (-s.weight, s.numbers)):
        met = next((k for k, f in enumerate(found) if _same(f, stretch, views, config)), None)
        if met is None:
            found.append(stretch)
        elif found[met].category == stretch.category:
            found[met] = _united(found[met], stretch, views, config)
    return found


def _filled(
    piece: Stretch, gaps: Sequence[WallGap], views: tuple[RoomView, ...], config: ObjectsConfig
) -> Stretch:
    """A piece too narrow for a door, grown to the gap in its wall that it touches."""
    width = piece.high - piece.low
    if piece.category != "door" or width >= config.door_narrowest:
        return piece
    held = []
    for low, high in _gaps(piece, gaps, views, config):
        if low - JAMB <= piece.low and piece.high <= high + JAMB:
            whole = min(low, piece.low), max(high, piece.high)
            if config.door_narrowest <= whole[1] - whole[0] <= config.door_widest:
                held.append((whole[1] - whole[0], *whole))
    if held:
        _, low, high = min(held)
        piece = replace(piece, low=low, high=high)
    return piece


def _stretches(
    thing: Seen, views: tuple[RoomView, ...], config: ObjectsConfig
) -> list[Stretch] | None:
    """The parts of the wall that a thing covers; None where no wall holds it."""
    host = host_of(thing.points, thing.hits, views)
    if host is None:
        return None
    view, face = host
    normal = views[view].normals[face]
    inside = in_walls(thing.points, views[view])[:, face]
    along = thing.points[inside] @ tangent(normal)
    heights, hits = thing.points[inside, 2], thing.hits[inside]
    core = hits >= config.core_share * np.quantile(hits, 0.9)
    if thing.category == "door":
        # Of an open one there are two jambs and a lintel; one jamb may have been seen seldom.
        core = hits >= min(DOOR_HITS, float(hits.max()))
    along, heights, hits = along[core], heights[core], hits[core]
    found = []
    parts = _parts(along, hits, thing.category, config)
    most = max((float(hits[part].max()) for part in parts), default=1.0)
    for part in parts:
        low, high = np.quantile(along[part], TRIM)
        bottom, top = np.quantile(heights[part], TRIM)
        # Each part stands on its own sightings: the frames that saw the thing need not show it all.
        seen = max(1, round(thing.seen * float(hits[part].max()) / most))
        found.append(
            Stretch(
                thing.category, view, face, float(low), float(high), float(bottom), float(top),
                float(hits[part].sum()), (thing.number,), seen, thing.expected,
                thing.score * seen / thing.seen, thing.frames, thing.due,
            )
        )  # fmt: skip
    return found


def _parts(
    along: Array, hits: Array, category: str, config: ObjectsConfig
) -> list[NDArray[np.intp]]:
    """Indices of the points of each part.

    Two neighbouring windows run together in a picture now and then; what lies between them is then
    seen in a few frames only. The middle of an open door is seen as seldom, so doors are parted
    that way only where they would be too wide for one.
    """
    if category != "door":
        return _runs(along, hits, config.opening_gap, VALLEY)
    found = []
    for part in _runs(along, hits, config.doorway_width, 0.0):
        if np.ptp(along[part]) > config.door_widest:
            inner = _runs(along[part], hits[part], config.opening_gap, VALLEY)
            found += [part[k] for k in inner]
        else:
            found.append(part)
    return found


def _runs(along: Array, hits: Array, gap: float, valley: float) -> list[NDArray[np.intp]]:
    """Indices of the points between gaps (m) in which columns have few sightings.

    Few is under the share ``valley`` of what well-seen columns have.
    """
    column = np.floor((along - along.min()) / COLUMN).astype(int)
    weight = np.bincount(column, hits)
    full = (weight > 0) & (weight >= valley * np.quantile(weight[weight > 0], 0.75))
    runs = np.flatnonzero(full)
    breaks = np.flatnonzero(np.diff(runs) > round(gap / COLUMN)) + 1
    found = []
    for run in np.split(runs, breaks):
        part = np.flatnonzero((column >= run[0]) & (column <= run[-1]))
        if len(part) >= ENOUGH:
            found.append(part)
    return found


def _span(stretch: Stretch, views: tuple[RoomView, ...], along: Array) -> tuple[float, float]:
    """The stretch along another face's tangent (3,)."""
    sign = float(np.sign(tangent(views[stretch.view].normals[stretch.face]) @ along))
    ends = sorted((sign * stretch.low, sign * stretch.high))
    return ends[0], ends[1]


def _same(
    first: Stretch, second: Stretch, views: tuple[RoomView, ...], config: ObjectsConfig
) -> bool:
    """Whether two stretches lie in one wall and cover each other."""
    n, d = views[first.view].normals[first.face], views[first.view].offsets[first.face]
    m, e = views[second.view].normals[second.face], views[second.view].offsets[second.face]
    facing = float(n @ m)
    if abs(facing) < 0.97:
        return False
    behind = abs(d - e) if facing > 0 else abs(d + e)
    if behind > (BEHIND if facing > 0 else config.wall_thickness):
        return False
    low, high = _span(second, views, tangent(n))
    if first.category == second.category == "door":
        # Jambs and lintel of one frame, seen at different times: two doors are wider together.
        return max(first.high, high) - min(first.low, low) <= config.frame_width or (
            min(first.high, high) > max(first.low, low)
        )
    shared = min(first.high, high) - max(first.low, low)
    narrow = max(min(first.high - first.low, high - low), config.voxel)
    level = min(first.top, second.top) - max(first.bottom, second.bottom)
    return shared > config.opening_overlap * narrow and level > -config.cluster_gap


def _united(
    first: Stretch, second: Stretch, views: tuple[RoomView, ...], config: ObjectsConfig
) -> Stretch:
    """Both as one: the stronger one's wall; its bounds give way by the other's share."""
    low, high = _span(second, views, tangent(views[first.view].normals[first.face]))
    share = second.weight / (first.weight + second.weight)
    fits = max(first.high, high) - min(first.low, low) <= config.frame_width
    if first.category == "door" and fits and second.seen >= config.min_seen:
        share = 1.0
    seen, expected, score, frames, due = sightings(first, second)
    # A weak sighting often shows a part, so it may widen the opening but never narrow it; what
    # still fits a door's frame is part of that frame, if it was seen as often as an object must be.
    return replace(
        first,
        low=first.low + share * min(low - first.low, 0.0),
        high=first.high + share * max(high - first.high, 0.0),
        bottom=first.bottom + share * min(second.bottom - first.bottom, 0.0),
        top=first.top + share * max(second.top - first.top, 0.0),
        weight=first.weight + second.weight,
        numbers=tuple(sorted({*first.numbers, *second.numbers})),
        seen=seen,
        expected=expected,
        score=score,
        frames=frames,
        due=due,
    )


def _plausible(stretch: Stretch, views: tuple[RoomView, ...], config: ObjectsConfig) -> bool:
    """Whether it is large enough, and lies at the height of a door or window."""
    floor = views[stretch.view].floor
    bottom, top = stretch.bottom - floor, stretch.top - floor
    door = stretch.category == "door"
    if top < config.opening_top or (
        door and (bottom > config.door_sill or top > config.door_highest)
    ):
        return False
    return (
        stretch.high - stretch.low >= config.opening_width
        and stretch.top - stretch.bottom >= config.opening_width
    )


def stands(shape: Array, config: ObjectsConfig) -> bool:
    """Whether an ellipsoid (3, 3) is as high and wide as what is seen of a door or window is."""
    high, wide = np.sqrt(shape[2, 2]), np.sqrt(np.linalg.eigvalsh(shape[:2, :2])[-1])
    return bool(2.0 * high >= config.opening_width and 2.0 * wide >= config.opening_width)


def _seen_enough(
    stretch: Stretch, gaps: Sequence[WallGap], views: tuple[RoomView, ...], config: ObjectsConfig
) -> bool:
    """Whether the camera is sure enough of it; of a door without a gap it must be surer."""
    least = config.min_confidence
    if stretch.category == "door" and stretch.confidence < config.door_confidence:
        held = _gaps(stretch, gaps, views, config)
        shared = [min(stretch.high, b) - max(stretch.low, a) for a, b in held]
        if max(shared, default=0.0) < 0.5 * (stretch.high - stretch.low):
            least = config.door_confidence
    return stretch.seen >= config.min_seen and stretch.confidence >= least


def _gaps(
    stretch: Stretch, gaps: Sequence[WallGap], views: tuple[RoomView, ...], config: ObjectsConfig
) -> list[tuple[float, float]]:
    """From where to where along the stretch's face the gaps in its wall reach."""
    view = views[stretch.view]
    normal, offset = view.normals[stretch.face], view.offsets[stretch.face]
    height = (stretch.bottom + stretch.top) / 2.0
    ends = [
        sorted((gap.ends @ tangent(normal)[:2]).tolist())
        for gap in gaps
        if gap.lies_in(normal, offset, height, config)
    ]
    return [(low, high) for low, high in ends]


def _framed(stretch: Stretch, views: tuple[RoomView, ...], config: ObjectsConfig) -> bool:
    """Whether a door is as wide as a door and there is some wall beside it.

    What covers its whole face is the front of a cabinet, or an open leaf that SLAM took for a wall.
    """
    if stretch.category != "door":
        return True
    width = stretch.high - stretch.low
    span = views[stretch.view].spans[stretch.face]
    return width >= config.door_narrowest and (span is None or width <= FILLS * (span[1] - span[0]))


def _named(found: list[Stretch]) -> list[tuple[str, Stretch]]:
    """With ids after the first thing they are of; further parts of one thing get a suffix."""
    ordered = sorted(found, key=lambda s: (s.numbers[0], s.view, s.face, s.low))
    out = []
    for number, group in groupby(ordered, key=lambda s: s.numbers[0]):
        for k, stretch in enumerate(group):
            out.append((f"o{number}" if k == 0 else f"o{number}.{k + 1}", stretch))
    return out


def _object(key: str, stretch: Stretch, views: tuple[RoomView, ...]) -> Object:
    view = views[stretch.view]
    normal, offset = view.normals[stretch.face], view.offsets[stretch.face]
    middle = (stretch.low + stretch.high) / 2.0 * tangent(normal) - offset * normal
    yaw = math.atan2(normal[1], normal[0]) - math.pi / 2.0
    return Object(
        key,
        stretch.category,
        (float(middle[0]), float(middle[1]), (stretch.bottom + stretch.top) / 2.0),
        Ellipsoid(
            ((stretch.high - stretch.low) / 2.0, 0.1, (stretch.top - stretch.bottom) / 2.0),
            (0.0, 0.0, math.sin(yaw / 2.0), math.cos(yaw / 2.0)),
        ),
        confidence=round(stretch.confidence, 4),
        attributes={"evidence": "vision", "seen": stretch.seen},
    )
