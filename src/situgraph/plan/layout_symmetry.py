"""The half turn of a floor with its objects: global symmetry."""

from __future__ import annotations

import msgspec
import numpy as np

from situgraph.plan.contacts import Faces, Index
from situgraph.plan.floor import Floor, centroids
from situgraph.plan.layout_floors import half_turn_partners
from situgraph.plan.layout_items import Items

# Objects of a symmetric floor stay this far (m) from its centre, clear of their own images.
CENTRE_CLEARANCE = 0.7


class HalfTurn(msgspec.Struct, frozen=True):
    """Which room (n,) and which face (f,) each one maps to; one more entry, -1, for 'none'."""

    room: Index
    face: Index

    def image(self, items: Items) -> Items:
        """The objects after the half turn about the origin."""
        center = items.center * (-1.0, -1.0, 1.0)
        yaw = np.where(items.yaw > 0.0, items.yaw - np.pi, items.yaw + np.pi)
        return Items(
            items.kind, center, yaw, items.width, self.room[items.room], self.face[items.face]
        )

    def canonical(self, items: Items) -> Items:
        """Those of the objects that stand in the half that is drawn, clear of the centre."""
        return items.rows(_in_half(items) & _clear_of_centre(items))

    def fold(self, items: Items) -> Items:
        """All objects, those of the other half replaced by their images; none at the centre."""
        image = self.image(items)
        here = _in_half(items)
        columns = []
        for name in items.__struct_fields__:
            own, other = getattr(items, name), getattr(image, name)
            columns.append(np.where(here if own.ndim == 1 else here[:, None], own, other))
        folded = Items(*columns)
        return folded.rows(_clear_of_centre(folded))


def half_turn_of(floor: Floor, corners: np.ndarray, faces: Faces) -> HalfTurn:
    """The half turn of a floor that maps onto itself, from its inner corners and faces."""
    room = half_turn_partners(centroids(floor, corners))
    face = half_turn_partners(0.5 * (faces.start + faces.end))
    return HalfTurn(np.append(room, -1), np.append(face, -1))


def _in_half(items: Items) -> np.ndarray:
    x, y = items.center[:, 0], items.center[:, 1]
    return np.asarray((y > 1e-9) | ((np.abs(y) <= 1e-9) & (x > 0.0)))


def _clear_of_centre(items: Items) -> np.ndarray:
    return np.asarray(np.linalg.norm(items.center[:, :2], axis=1) > CENTRE_CLEARANCE)
