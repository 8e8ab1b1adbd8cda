"""Which planned faces are one wall: back to back, or planned in one line, over the whole plan.

A wall that was moved takes all its faces along, whether the robot has seen those between two of
them or not; so what is one wall is asked of the plan, not of what was seen.
"""

from __future__ import annotations

import numpy as np

from situgraph.coupling.evidence import place_of
from situgraph.geometry.poses import Array
from situgraph.scenegraph.graph import SceneGraph

SQUARE = 0.98  # cosine between the normals of faces of one wall
THICKEST = 0.6  # m, from face to face
SURFACE = 0.03  # m; faces planned within this are in one surface
BESIDE = 1.0  # m between two faces in one line, along it
OVERLAP = 0.2  # m, that the faces of a wall have in common
STOREY = 1.5  # m; faces farther apart in height are on two storeys


class WallLines:
    """Walls of a plan, each found when one of its faces is first asked for.

    Attributes:
        names: ids of the faces with an extent, in the order of the plan.
        row: id -> row of the arrays.
        normals: (n, 2) unit normals in the plan.
        offsets: (n,) m, of the lines in the plan.
        ends: (n, 2, 2) m.
        stretches: (n, 2) first and last metre along the face, its normal turned left.
        storeys: of the rooms each face bounds.
    """

    def __init__(self, prior: SceneGraph) -> None:
        """The walls of ``prior``."""
        faces = [p for p in prior.planes if p.extent is not None]
        self.names = [p.id for p in faces]
        self.row = {name: k for k, name in enumerate(self.names)}
        slanted = np.array([p.normal[:2] for p in faces], dtype=float).reshape(-1, 2)
        length = np.maximum(np.linalg.norm(slanted, axis=1), 1e-9)
        self.normals: Array = slanted / length[:, None]
        self.ends: Array = np.array([p.extent for p in faces], dtype=float).reshape(-1, 2, 2)
        self.offsets: Array = -(self.ends.mean(axis=1) * self.normals).sum(axis=1)
        along = np.stack([-self.normals[:, 1], self.normals[:, 0]], axis=1)
        self.stretches: Array = np.sort((self.ends * along[:, None]).sum(axis=2), axis=1)
        rooms = prior.room_by_id
        self.storeys = [
            {rooms[r].storey for r in prior.rooms_by_plane.get(p.id, ())} for p in faces
        ]
        self._height = np.array([place_of(prior, p)[2] for p in faces])
        self._line: dict[str, str] = {}

    def of(self, face: str) -> str:
        """The wall of a face: the first of its faces in the plan."""
        if face not in self.row:
            return face
        if face not in self._line:
            members, waiting = {self.row[face]}, [self.row[face]]
            while waiting:
                new = set(self._touching(waiting.pop()).tolist()) - members
                members |= new
                waiting += sorted(new)
            first = self.names[min(members)]
            self._line.update({self.names[k]: first for k in members})
        return self._line[face]

    def _touching(self, k: int) -> Array:
        """Rows of the faces that are one wall with face ``k``, itself among them."""
        n, d = self.normals[k], self.offsets[k]
        cosine = self.normals @ n
        rows = np.flatnonzero(
            (np.abs(cosine) >= SQUARE) & (np.abs(self._height - self._height[k]) <= STOREY)
        )
        before = self.ends[rows] @ n + d
        across = np.array([-n[1], n[0]])
        stretches = np.sort(self.ends[rows] @ across, axis=1)
        low, high = np.sort(self.ends[k] @ across)
        common = np.minimum(stretches[:, 1], high) - np.maximum(stretches[:, 0], low)
        back = (
            (cosine[rows] < 0.0)
            & (before.max(axis=1) < 0.0)
            & (before.min(axis=1) > -THICKEST)
            & (common > OVERLAP)
        )
        line = (cosine[rows] > 0.0) & (np.abs(before).max(axis=1) < SURFACE) & (common > -BESIDE)
        return np.asarray(rows[back | line])
