"""The whole answer of the coupling: trajectory, map, objects and deviations in the building."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import msgspec
import numpy as np

from situgraph.coupling.association import associate_planes, associate_rooms
from situgraph.coupling.config import CouplingConfig
from situgraph.coupling.coupled import Coupled, couple
from situgraph.coupling.deviation import Deviation, along_of
from situgraph.coupling.deviations import find_deviations
from situgraph.coupling.evidence import Evidence, from_scene
from situgraph.coupling.lines import WallLines
from situgraph.coupling.openings import Missed
from situgraph.coupling.panes import reach
from situgraph.coupling.readings import Reading, readings
from situgraph.coupling.trajectory import Carrier
from situgraph.coupling.walls import walls
from situgraph.geometry.poses import Array, Placement
from situgraph.scenegraph.graph import Object, Plane, SceneGraph

ROUNDS = 2  # association and solution in turn


@dataclass(frozen=True)
class Pairs:
    """What corresponds, online id -> prior id, and where the map lies: a solution of the match."""

    placement: Placement
    rooms: Mapping[str, str]
    planes: Mapping[str, str]
    objects: Mapping[str, str]
    storeys: Mapping[str, str]


class Located:
    """The robot in the building; deviations are worked out when they are asked for.

    Attributes:
        rooms: online room -> planned room, also those that were associated by their place.
        planes: pairs of an online plane and a planned face, likewise; either may occur twice.
        coupled: the solution of both graphs.
        readings: the placements that cannot be told apart; the first one is taken.
        carrier: takes poses and points of the map to the building.
    """

    def __init__(
        self,
        online: SceneGraph,
        prior: SceneGraph,
        coupled: Coupled,
        pairs: Pairs,
        planes: tuple[tuple[str, str], ...],
        looked_for: Collection[str] | None,
        missed: Missed | None,
        found: tuple[Reading, ...],
        lines: WallLines,
        config: CouplingConfig,
    ) -> None:
        """``planes`` as associated; ``looked_for`` and ``missed``: see ``locate``."""
        self.readings = found
        self.coupled = coupled
        self.rooms, self.planes = pairs.rooms, planes
        self.carrier = Carrier(online.keyframes, coupled.frames, coupled.building_T_map)
        self._online, self._prior, self._pairs = online, prior, pairs
        self._looked_for, self._missed, self._config = looked_for, missed, config
        self._lines = lines

    @property
    def placement(self) -> Placement:
        """Map to building."""
        return self.coupled.placement

    @cached_property
    def graph(self) -> SceneGraph:
        """The S-Graph in the building frame, corrected by the plan."""
        return _carried(self._online, self.coupled, self.carrier)

    @cached_property
    def deviations(self) -> tuple[Deviation, ...]:
        """What differs from the plan."""
        return find_deviations(
            self.graph,
            self._prior,
            self.coupled.walls,
            self.rooms,
            self._pairs.objects,
            self._looked_for,
            None if self._missed is None else self._images_without,
            self._lines,
            self._config,
        )

    def _images_without(self, item: Object, face: Plane) -> int:
        """How many images show the place of a planned opening in a face, and no trace of one."""
        assert self._missed is not None
        back = np.linalg.inv(self.coupled.building_T_map)
        place = back[:3, :3] @ np.array(item.center) + back[:3, 3]
        normal = back[:3, :3] @ np.array(face.normal)
        half = 0.0 if item.ellipsoid is None else reach(item.ellipsoid, along_of(face))
        return self._missed(item.category, place, normal, half)

    def to_dict(self) -> dict[str, Any]:
        """The JSON ``situgraph/located``, version 1."""
        m = self.coupled.building_T_map
        at = self.placement
        return {
            "format": "situgraph/located",
            "version": 1,
            "transform": {"x": at.x, "y": at.y, "z": at.z, "yaw": at.yaw},
            "building_T_map": m.tolist(),
            "rooms": dict(self.rooms),
            "rms": self.coupled.rms,
            "readings": [
                {
                    "x": r.placement.x,
                    "y": r.placement.y,
                    "z": r.placement.z,
                    "yaw": r.placement.yaw,
                    "cost": r.cost,
                    "moved_walls": list(r.moved),
                }
                for r in self.readings
            ],
            "walls": [
                {
                    "online": w.online,
                    "prior": w.prior,
                    "offset": w.offset,
                    "offset_sigma": w.offset_sigma,
                    "tilt": w.tilt,
                    "tilt_sigma": w.tilt_sigma,
                }
                for w in self.coupled.walls
            ],
            "deviations": [msgspec.to_builtins(d) for d in self.deviations],
            "seconds": self.coupled.seconds,
        }


def locate(
    online: SceneGraph,
    prior: SceneGraph,
    pairs: Pairs,
    *,
    evidence: Evidence | None = None,
    looked_for: Collection[str] | None = None,
    missed: Missed | None = None,
    lines: WallLines | None = None,
    found: tuple[Reading, ...] = (),
    config: CouplingConfig | None = None,
) -> Located:
    """Couple both graphs as a match says, and associate what the match left out.

    Args:
        online: the S-Graph, map frame.
        prior: the A-Graph.
        pairs: a solution of the match (``pairs_of``).
        evidence: the factors behind ``online``; None takes its planes as measured one by one.
        looked_for: categories of objects that the robot would have seen; only those can be
            missing or extra. None: those that ``online`` has.
        missed: how many images show a place and no trace of such an object there; only what several
            should have shown is missing. None: all is missing that was not found.
        lines: the walls of ``prior``, where they are known already.
        found: the readings near the placement of ``pairs``, likewise.
        config: settings.
    """
    settings = config or CouplingConfig()
    known = from_scene(online, settings) if evidence is None else evidence
    lines = lines or WallLines(prior)
    found = found or readings(online, prior, pairs.placement, pairs.storeys, lines, settings)
    if math.hypot(*found[0].shift) > settings.reading_apart:
        # What the match paired is right where the match lies; elsewhere the place decides.
        pairs = Pairs(found[0].placement, {}, {}, {}, pairs.storeys)
    placement, planes = found[0].placement, tuple(sorted(pairs.planes.items()))
    for _ in range(ROUNDS):
        planes = planes or associate_planes(
            online, prior, placement, pairs.storeys, pairs.planes, settings
        )
        faces = walls(online, prior, planes, placement, lines)
        coupled = couple(known, faces, placement, settings)
        placement = coupled.placement
        before = planes
        planes = associate_planes(online, prior, placement, pairs.storeys, pairs.planes, settings)
        if planes == before:
            break
    else:
        coupled = couple(known, walls(online, prior, planes, placement, lines), placement, settings)
    rooms = associate_rooms(online, prior, placement, pairs.storeys, pairs.rooms, settings)
    final = Pairs(placement, rooms, pairs.planes, pairs.objects, pairs.storeys)
    return Located(
        online, prior, coupled, final, planes, looked_for, missed, found, lines, settings
    )


def _carried(online: SceneGraph, coupled: Coupled, carrier: Carrier) -> SceneGraph:
    """The S-Graph in the building: planes and keyframes as estimated, the rest carried along."""
    change = msgspec.structs.replace
    planes = []
    for p in online.planes:
        x, y, z, d = coupled.planes.get(p.id, np.zeros(4)).tolist()
        extent = None
        if p.extent is not None:
            ends = carrier.points(np.asarray(p.extent, dtype=float))
            flat = math.hypot(x, y) or 1.0
            n = np.array([x, y]) / flat
            ends -= (ends @ n + d / flat)[:, None] * n
            (ax, ay), (bx, by) = ends.tolist()
            extent = ((ax, ay), (bx, by))
        planes.append(change(p, normal=(x, y, z), offset=d, extent=extent))
    rooms = [
        change(
            r,
            center=_triple(carrier.points(np.array([r.center]))[0]),
            footprint=None
            if r.footprint is None
            else tuple((float(a), float(b)) for a, b in carrier.points(np.array(r.footprint))),
        )
        for r in online.rooms
    ]
    objects = [
        change(
            o,
            center=_triple(carrier.points(np.array([o.center]))[0]),
            ellipsoid=None if o.ellipsoid is None else carrier.ellipsoid(o.ellipsoid),
        )
        for o in online.objects
    ]
    rise = coupled.placement.z
    return online.replace(
        planes=tuple(planes),
        rooms=tuple(rooms),
        objects=tuple(objects),
        keyframes=carrier.keyframes(),
        storeys=tuple(change(s, elevation=s.elevation + rise) for s in online.storeys),
    )


def _triple(values: Array) -> tuple[float, float, float]:
    x, y, z = values.tolist()
    return x, y, z
