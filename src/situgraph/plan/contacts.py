"""Which faces of different rooms stand back to back: the two sides of one wall.

Everything here is plain arrays, so that layouts, the sampler and the IFC writer share it.
"""

from __future__ import annotations

import msgspec
import numpy as np
from numpy.typing import NDArray

from situgraph.geometry.poses import Array
from situgraph.scenegraph.graph import SceneGraph

Index = NDArray[np.int64]


class Faces(msgspec.Struct, frozen=True):
    """Vertical room faces in the plan view; one row each, lengths in metres.

    ``start`` and ``end`` (n, 2) run with the room on the left, ``normal`` (n, 2) points into the
    room, ``room`` and ``storey`` (n,) are indices.
    """

    start: Array
    end: Array
    normal: Array
    room: Index
    storey: Index

    @property
    def direction(self) -> Array:
        """Unit vectors (n, 2) from start to end."""
        edge = self.end - self.start
        length = np.maximum(np.linalg.norm(edge, axis=1, keepdims=True), 1e-12)
        return np.asarray(edge / length)

    @property
    def length(self) -> Array:
        """Lengths (n,) in metres."""
        return np.asarray(np.linalg.norm(self.end - self.start, axis=1))


class Contacts(msgspec.Struct, frozen=True):
    """Pairs of faces ``a``, ``b`` (n,) of one wall.

    ``low`` and ``high`` (n,) bound the common stretch in metres from the start of face ``a``;
    ``gap`` (n,) is the wall's thickness.
    """

    a: Index
    b: Index
    low: Array
    high: Array
    gap: Array


def find_contacts(faces: Faces, max_gap: float, min_overlap: float) -> Contacts:
    """Pairs of anti-parallel faces of two rooms on one storey, back to back within ``max_gap`` m.

    Each pair comes once (``a`` < ``b``); stretches shorter than ``min_overlap`` m are left out.
    """
    import shapely

    if len(faces.room) == 0:
        none = np.zeros(0, dtype=np.int64)
        return Contacts(none, none, np.zeros(0), np.zeros(0), np.zeros(0))
    # Storeys stand far apart in the plan view while the tree looks for neighbours.
    far = 10.0 * (np.ptp(np.concatenate([faces.start, faces.end]), axis=0).max() + 1.0)
    shift = np.stack([faces.storey * far, np.zeros(len(faces.room))], axis=1)
    low = np.minimum(faces.start, faces.end) + shift
    high = np.maximum(faces.start, faces.end) + shift
    tree = shapely.STRtree(shapely.box(low[:, 0], low[:, 1], high[:, 0], high[:, 1]))
    low, high = low - max_gap, high + max_gap
    # Boxes only: the exact tests below are quicker on all pairs at once.
    a, b = tree.query(shapely.box(low[:, 0], low[:, 1], high[:, 0], high[:, 1]))
    keep = (a < b) & (faces.room[a] != faces.room[b])
    a, b = a[keep].astype(np.int64), b[keep].astype(np.int64)
    keep = np.einsum("ij,ij->i", faces.normal[a], faces.normal[b]) < -0.99
    a, b = a[keep], b[keep]

    direction = faces.direction[a]
    u = np.einsum("ij,ij->i", direction, faces.start[b] - faces.start[a])
    v = np.einsum("ij,ij->i", direction, faces.end[b] - faces.start[a])
    low = np.maximum(np.minimum(u, v), 0.0)
    high = np.minimum(np.maximum(u, v), faces.length[a])
    middle = 0.5 * (faces.start[b] + faces.end[b])
    gap = -np.einsum("ij,ij->i", faces.normal[a], middle - faces.start[a])
    keep = (gap > -1e-6) & (gap <= max_gap) & (high - low >= min_overlap)
    order = np.lexsort((b[keep], a[keep]))
    return Contacts(
        a[keep][order], b[keep][order], low[keep][order], high[keep][order], gap[keep][order]
    )


def free_stretches(faces: Faces, contacts: Contacts) -> tuple[Index, Array, Array]:
    """The parts of each face with no room behind: face (k,), from (k,) and to (k,) in metres.

    Distances run from the start of the face; faces without any contact come whole.
    """
    count = len(faces.room)
    length = faces.length
    every = np.arange(count)
    low_b, high_b = _seen_from_b(faces, contacts)
    face = np.concatenate([every, every, contacts.a, contacts.b])
    low = np.concatenate([np.zeros(count), length, contacts.low, low_b])
    high = np.concatenate([np.zeros(count), length, contacts.high, high_b])
    order = np.lexsort((low, face))
    face, low, high = face[order], low[order], high[order]
    same = face[1:] == face[:-1]
    return face[:-1][same], high[:-1][same], np.maximum(low[1:], high[:-1])[same]


def _seen_from_b(faces: Faces, contacts: Contacts) -> tuple[Array, Array]:
    """The common stretches measured from the start of face ``b``."""
    direction = faces.direction
    from_a = faces.start[contacts.a]
    ends = [
        np.einsum(
            "ij,ij->i",
            direction[contacts.b],
            from_a + along[:, None] * direction[contacts.a] - faces.start[contacts.b],
        )
        for along in (contacts.low, contacts.high)
    ]
    length = faces.length[contacts.b]
    return np.maximum(np.minimum(*ends), 0.0), np.minimum(np.maximum(*ends), length)


def faces_of(graph: SceneGraph) -> tuple[Faces, list[str]]:
    """The faces of a graph whose planes have extents, and the plane id of each row.

    A plane that bounds several rooms gives one row a room. Storeys are numbered in the graph's
    order; rooms without a storey share one more number.
    """
    storey_row = {s.id: i for i, s in enumerate(graph.storeys)}
    plane_by_id = graph.plane_by_id
    segments: list[tuple[tuple[float, float], tuple[float, float]]] = []
    normals: list[tuple[float, float]] = []
    owner: list[int] = []
    level: list[int] = []
    names: list[str] = []
    for row, room in enumerate(graph.rooms):
        storey = storey_row.get(room.storey or "", len(storey_row))
        for plane_id in room.planes:
            plane = plane_by_id[plane_id]
            if plane.extent is None:
                continue
            segments.append(plane.extent)
            normals.append(plane.normal[:2])
            owner.append(row)
            level.append(storey)
            names.append(plane_id)
    ends = np.array(segments, dtype=float).reshape(-1, 2, 2)
    normal = np.array(normals, dtype=float).reshape(-1, 2)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
    start, end = ends[:, 0], ends[:, 1]
    edge = end - start
    left = edge[:, 0] * normal[:, 1] - edge[:, 1] * normal[:, 0]
    swap = (left < 0.0)[:, None]
    start, end = np.where(swap, end, start), np.where(swap, start, end)
    rooms = np.array(owner, dtype=np.int64)
    return Faces(start, end, normal, rooms, np.array(level, dtype=np.int64)), names
