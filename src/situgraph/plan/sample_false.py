"""Rooms a robot believes in that are not there."""

from __future__ import annotations

import math

import numpy as np

from situgraph.plan.sample_draft import Draft, DraftPlane, DraftRoom
from situgraph.plan.sampler_config import SamplerConfig

# Where false rooms stand (m from the centre of a real one) and how wide they are (m).
DISTANCE = (4.0, 9.0)
WIDTH = (2.5, 6.0)


def add_false_rooms(draft: Draft, config: SamplerConfig, rng: np.random.Generator) -> None:
    """Add rectangular rooms beside real ones, along their walls; a fraction is drawn by lot."""
    expected = config.false_rooms * len(draft.rooms)
    count = math.floor(expected) + int(rng.random() < expected % 1.0)
    real = len(draft.rooms)
    for _ in range(count):
        beside = draft.rooms[int(rng.integers(real))]
        normal = draft.planes[beside.planes[0]].normal if beside.planes else (1.0, 0.0, 0.0)
        wall = math.atan2(normal[1], normal[0])
        away, distance = rng.uniform(-math.pi, math.pi), rng.uniform(*DISTANCE)
        x = beside.center[0] + distance * math.cos(away)
        y = beside.center[1] + distance * math.sin(away)
        half = 0.5 * rng.uniform(*WIDTH, 2)
        c, s = math.cos(wall), math.sin(wall)
        around = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]) * half
        corners = around @ np.array([[c, s], [-s, c]]) + (x, y)
        ends = [(float(a), float(b)) for a, b in corners]
        first = len(draft.planes)
        for k in range(4):
            edge = corners[(k + 1) % 4] - corners[k]
            nx, ny = (np.array([-edge[1], edge[0]]) / np.linalg.norm(edge)).tolist()
            offset = -(nx * ends[k][0] + ny * ends[k][1])
            extent = (ends[k], ends[(k + 1) % 4])
            draft.planes.append(DraftPlane((nx, ny, 0.0), offset, extent, None))
        footprint = tuple(ends) if config.footprints else None
        center = (float(x), float(y), beside.center[2])
        planes = list(range(first, first + 4))
        draft.rooms.append(DraftRoom(center, planes, footprint, beside.storey, None))
