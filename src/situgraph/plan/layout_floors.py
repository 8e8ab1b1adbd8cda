"""From a kind and a symmetry to a floor whose centre is the origin."""

from __future__ import annotations

import numpy as np

from situgraph.geometry.poses import Array
from situgraph.plan import layout_kinds as kinds
from situgraph.plan.contacts import Index
from situgraph.plan.floor import Floor, from_boxes, joined, turned
from situgraph.plan.layout_config import Kind, LayoutConfig
from situgraph.plan.layout_wings import wings_floor

Rng = np.random.Generator


def draw_floor(
    kind: Kind,
    rooms: int,
    config: LayoutConfig,
    rng: Rng,
    symmetric: bool = False,
    shape: tuple[int, int] | None = None,
) -> Floor:
    """One floor of a kind, centred on the origin; ``symmetric``: its own half turn.

    ``shape`` (columns, rows) is for the kind 'grid'; None chooses the most nearly square one.
    A symmetric floor is a half and its half turn about the origin, and an odd number of rooms has
    a hall between the two.
    """
    if kind == "wings":
        floor = wings_floor(rooms, config, rng, symmetric)
    elif kind == "grid":
        floor = kinds.grid_floor(shape or kinds.grid_shape(rooms), config, rng)
    elif symmetric:
        return _doubled(kind, rooms, config, rng)
    else:
        floor = _drawn(kind, rooms, 1.0, config, rng)
    if kind == "wings" and symmetric:
        return floor
    low, high = floor.corners.min(axis=0), floor.corners.max(axis=0)
    return Floor(floor.corners - 0.5 * (low + high), floor.first, floor.thickness)


def half_turn_partners(points: Array) -> Index:
    """For each point (n, 2 or 3) the index of its image under the half turn about the z axis.

    The points must map onto themselves within a tenth of a millimetre.
    """
    from scipy.spatial import cKDTree

    image = points.copy()
    image[:, :2] *= -1.0
    distance, partner = cKDTree(points).query(image)
    if len(points) and float(np.max(distance)) > 1e-4:
        raise ValueError("the points do not map onto themselves by a half turn")
    return np.asarray(partner, dtype=np.int64)


def _drawn(kind: Kind, rooms: int, stretch: float, config: LayoutConfig, rng: Rng) -> Floor:
    draw = {
        "random": kinds.random_floor,
        "storeys": kinds.random_floor,
        "modular": kinds.modular_floor,
        "corridor": kinds.corridor_floor,
        "lshaped": kinds.lshaped_floor,
    }[kind]
    return draw(rooms, config, rng, stretch)


def _doubled(kind: Kind, rooms: int, config: LayoutConfig, rng: Rng) -> Floor:
    hall = rooms % 2
    width = 2.0 * config.corridor_width if rooms == 1 else config.corridor_width
    thickness = rng.uniform(config.thickness_min, config.thickness_max, hall)
    parts = []
    reach = config.corridor_width * 1.5
    if rooms > 1:
        half = _drawn(kind, rooms // 2, 2.0, config, rng)
        low, high = half.corners.min(axis=0), half.corners.max(axis=0)
        shift = (-0.5 * (low[0] + high[0]), 0.5 * width * hall - low[1])
        half = Floor(half.corners + shift, half.first, half.thickness)
        reach = 0.5 * float(high[0] - low[0])
        parts = [half, turned(half)]
    if hall:
        box = np.array([[-reach, -0.5 * width, reach, 0.5 * width]])
        parts.append(from_boxes(box, thickness))
    return joined(parts)
