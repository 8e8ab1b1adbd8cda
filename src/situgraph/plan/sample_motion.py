"""Motions of a sampled S-Graph: the unknown frame, and drift that bends the map."""

from __future__ import annotations

import msgspec
import numpy as np

from situgraph.geometry.poses import Array, Placement, wrap_angle
from situgraph.plan.contacts import Index
from situgraph.plan.exploration import Walk


class RoomMotions(msgspec.Struct, frozen=True):
    """For each explored room (n,) how building coordinates appear in the map: turn, then shift.

    ``walked`` (n,) is the way in metres up to the room.
    """

    yaw: Array
    shift: Array
    walked: Array

    def points(self, points: Array, slot: Index) -> Array:
        """Plan-view points (k, 2) of the rooms ``slot`` (k,), in the map."""
        return np.asarray(self.vectors(points, slot) + self.shift[slot])

    def vectors(self, vectors: Array, slot: Index) -> Array:
        """Plan-view directions (k, 2) of the rooms ``slot`` (k,), in the map."""
        c, s = np.cos(self.yaw)[slot], np.sin(self.yaw)[slot]
        x, y = vectors[:, 0], vectors[:, 1]
        return np.stack([c * x - s * y, s * x + c * y], axis=1)

    def placements(self, z: float) -> list[Placement]:
        """Map to building as each room sees it; ``z`` (m) is the map origin's height."""
        c, s = np.cos(self.yaw), np.sin(self.yaw)
        x = -(c * self.shift[:, 0] + s * self.shift[:, 1])
        y = s * self.shift[:, 0] - c * self.shift[:, 1]
        columns = (x.tolist(), y.tolist(), wrap_angle(-self.yaw).tolist())
        return [Placement(px, py, z, yaw) for px, py, yaw in zip(*columns)]


def room_motions(frame: Placement, walk: Walk, center: Array, bend: float) -> RoomMotions:
    """Motions of each room on a walk; ``frame`` takes map to building at the start.

    ``center`` (rooms, 3) are the rooms' centres in the building. The heading error grows by
    ``bend`` rad for each metre walked, and the position error is what that adds up to along the
    way from centre to centre.
    """
    back = frame.inverse()
    stops = back.points(center[walk.stops, :2])
    step = np.diff(stops, axis=0)
    length = np.linalg.norm(step, axis=1)
    walked = np.concatenate([[0.0], np.cumsum(length)])
    error = bend * 0.5 * (walked[1:] + walked[:-1])
    c, s = np.cos(error), np.sin(error)
    bent = np.stack([c * step[:, 0] - s * step[:, 1], s * step[:, 0] + c * step[:, 1]], axis=1)
    place = stops[0] + np.concatenate([[(0.0, 0.0)], np.cumsum(bent, axis=0)])
    entered = np.array(walk.entered)
    yaw = back.yaw + bend * walked[entered]
    c, s = np.cos(yaw), np.sin(yaw)
    x, y = center[walk.order, 0], center[walk.order, 1]
    turned = np.stack([c * x - s * y, s * x + c * y], axis=1)
    return RoomMotions(yaw, place[entered] - turned, walked[entered])
