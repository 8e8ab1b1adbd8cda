"""What stands in openings: frames, leaves that are open, shut or absent, panes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from situgraph.geometry.poses import Array
from situgraph.sim.config import WorldConfig
from situgraph.sim.levels import Level
from situgraph.sim.mesh import MeshBuilder
from situgraph.sim.openings import Opening

Leaf = Literal["open", "closed", "none"]

_FRAME = 0.04  # m, width of a door frame's profile
_SASH = 0.06  # m, width of a window frame's profile
_PROUD = 0.012  # m, how far frames stand out of the wall
_LEAF = 0.04  # m, thickness of a leaf
_DOUBLE = 1.4  # m, wider doors have two leaves
_LANE = 0.7  # m; a leaf leaves the way straight through the door free this far ...
_ROBOT = 0.24  # m; ... and this wide to either side
_PANE = 0.01  # m, half the thickness of glass
_BAR = 1.1  # m, windows wider than this have a bar


@dataclass(frozen=True, eq=False)
class Swing:
    """A leaf in the plan view: it reaches ``width`` m from ``hinge`` (2,) in ``direction`` (2,)."""

    hinge: Array
    direction: Array
    width: float

    def polygon(self, margin: float = 0.0) -> Any:
        """Its plan view as a shapely polygon, widened by ``margin`` m."""
        import shapely

        line = shapely.LineString([self.hinge, self.hinge + self.width * self.direction])
        return line.buffer(_LEAF / 2 + margin, cap_style="flat" if margin == 0 else "square")


@dataclass(frozen=True, eq=False)
class Door:
    """A door as built: the state of its leaf and where its leaves stand."""

    opening: Opening
    state: Leaf
    swings: tuple[Swing, ...]

    @property
    def passable(self) -> bool:
        """Whether a robot can walk through: no shut leaf, a room on either side."""
        return self.state != "closed" and len(self.opening.rooms) > 1

    @property
    def way(self) -> Any:
        """The plan view between its frames, from room to room, as a shapely polygon."""
        import shapely

        o = self.opening
        side, through = o.along * (o.width / 2 - _FRAME), o.across * (o.depth / 2 + 0.02)
        signs = ((-1, -1), (1, -1), (1, 1), (-1, 1))
        return shapely.Polygon([o.middle + a * side + b * through for a, b in signs])


def hang(
    opening: Opening,
    level: Level,
    obstacles: Any,
    config: WorldConfig,
    rng: np.random.Generator,
) -> Door:
    """Decide how the door stands in its opening.

    The object's attributes ``leaf`` (false: a bare opening) and ``state`` (open, closed, none)
    decide; else doors between two rooms stand open, but for ``config.closed_doors`` of them, and
    doors to the outside are shut. An open leaf swings into free space: ``obstacles`` is a shapely
    geometry to keep clear of; where there is none it has been taken out.
    """
    lot, angle = rng.random(), rng.uniform(config.door_angle_low, config.door_angle_high)
    order = rng.permutation(4)
    wanted = opening.object.attributes.get("state")
    if opening.object.attributes.get("leaf") is False or wanted == "none":
        return Door(opening, "none", ())
    between = len(opening.rooms) > 1
    if wanted == "closed" or (wanted != "open" and (not between or lot < config.closed_doors)):
        return Door(opening, "closed", _swings(opening, 0, 0, 0.0, centred=True))
    import shapely

    rooms = [level.rooms[r] for r in opening.rooms]
    space = shapely.union_all([*rooms, opening.polygon.buffer(0.02)])
    reach = opening.across * (opening.depth / 2 + _LANE)
    ends = [opening.middle - reach, opening.middle + reach]
    taken = shapely.union(obstacles, shapely.LineString(ends).buffer(_ROBOT, cap_style="flat"))
    for choice in order:
        swings = _swings(opening, int(choice) % 2, int(choice) // 2, angle)
        area = shapely.union_all([s.polygon(0.01) for s in swings])
        tips = shapely.union_all([s.polygon(0.03) for s in swings])
        if area.difference(space).area < 1e-3 and not tips.intersects(taken):
            return Door(opening, "open", swings)
    return Door(opening, "none", ())


def _swings(
    opening: Opening, side: int, hand: int, angle: float, *, centred: bool = False
) -> tuple[Swing, ...]:
    s, h = (1.0 if side else -1.0), (1.0 if hand else -1.0)
    clear = opening.width / 2 - _FRAME
    face = np.zeros(2) if centred else opening.across * s * opening.depth / 2
    hands, width = ((h, -h), clear) if opening.width > _DOUBLE else ((h,), 2 * clear)
    return tuple(
        Swing(
            opening.middle + opening.along * k * clear + face,
            -k * np.cos(angle) * opening.along + s * np.sin(angle) * opening.across,
            width,
        )
        for k in hands
    )


def build_door(mesh: MeshBuilder, door: Door, parts: Mapping[str, int]) -> None:
    """Add frame, leaves and handles; ``parts`` numbers ``frame``, ``leaf`` and ``handle``."""
    o = door.opening
    yaw = float(np.arctan2(o.along[1], o.along[0]))
    deep, mid = o.depth / 2 + _PROUD, (o.low + o.high) / 2
    for k in (-1.0, 1.0):
        at = o.middle + o.along * k * (o.width / 2 - _FRAME / 2)
        mesh.box([*at, mid], [_FRAME / 2, deep, (o.high - o.low) / 2], yaw, parts["frame"])
    head = [o.width / 2 - _FRAME, deep, _FRAME / 2]
    mesh.box([*o.middle, o.high - _FRAME / 2], head, yaw, parts["frame"])
    low, high = o.low + 0.008, o.high - _FRAME - 0.004
    for swing in door.swings:
        turn = float(np.arctan2(swing.direction[1], swing.direction[0]))
        at = swing.hinge + swing.direction * swing.width / 2
        size = [swing.width / 2, _LEAF / 2, (high - low) / 2]
        mesh.box([*at, (low + high) / 2], size, turn, parts["leaf"])
        grip = swing.hinge + swing.direction * (swing.width - 0.11)
        mesh.box([*grip, o.low + 1.02], [0.06, _LEAF / 2 + 0.045, 0.012], turn, parts["handle"])


def build_window(mesh: MeshBuilder, opening: Opening, parts: Mapping[str, int]) -> None:
    """Add frame, bars and pane; ``parts`` numbers ``frame`` and ``glass``."""
    o = opening
    yaw = float(np.arctan2(o.along[1], o.along[0]))
    half, mid, tall = o.width / 2, (o.low + o.high) / 2, (o.high - o.low) / 2
    deep = 0.035

    def put(along: float, up: float, size: list[float], part: int) -> None:
        mesh.box([*(o.middle + o.along * along), mid + up], size, yaw, part)

    for k in (-1.0, 1.0):
        put(k * (half - _SASH / 2), 0.0, [_SASH / 2, deep, tall], parts["frame"])
        put(0.0, k * (tall - _SASH / 2), [half - _SASH, deep, _SASH / 2], parts["frame"])
    bars = int(o.width // _BAR)
    for i in range(bars):
        at = (2 * (i + 1) / (bars + 1) - 1) * half
        put(at, 0.0, [_SASH / 2, deep, tall - _SASH], parts["frame"])
    put(0.0, 0.0, [half - _SASH, _PANE, tall - _SASH], parts["glass"])
    # The board at the foot reaches from the frame into the room.
    inner = o.depth / 2 + 0.02
    put(0.0, -tall + 0.01, [half, inner, 0.01], parts["frame"])
