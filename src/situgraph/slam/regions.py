"""Connected free space between walls and closed doorways: where a room may be."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from situgraph.geometry.poses import Array
from situgraph.slam.config import RoomConfig
from situgraph.slam.gaps import Gap, doorways, without_leaves
from situgraph.slam.planemap import MapPlane
from situgraph.slam.raster import Mask, Raster


class Plan(NamedTuple):
    """The plan around a place: its raster, walls and doorways, and the regions of free space.

    ``cut`` tells for each region whether it goes on beyond the raster.
    """

    raster: Raster
    planes: list[MapPlane]
    doorways: list[Gap]
    regions: list[Mask]
    cut: list[bool]


def look(
    place: Array,
    half: float,
    outlines: Sequence[Array],
    planes: Sequence[MapPlane],
    config: RoomConfig,
) -> Plan:
    """Divide the square of ``half`` an edge (m) around ``place`` (2,) into regions.

    Args:
        place: middle of the square in the map.
        half: half its edge.
        outlines: free areas seen by keyframes, polygons (n, 2) in the map.
        planes: the walls of the storey.
        config: settings.
    """
    from scipy import ndimage

    raster = Raster.around(place - half, place + half, config.cell)
    near = [p for p in planes if _touches(p, place, half)]
    walls = without_leaves(near, config)
    openings = doorways(walls, config, near)
    seen = raster.count_polygons(outlines) > 0
    stretches = [np.array([p.point(a), p.point(b)]) for p in walls for a, b in p.intervals]
    solid = raster.draw_lines([*stretches, *(g.ends for g in openings)])
    labels, count = ndimage.label(seen & ~solid)
    areas = np.bincount(labels.ravel(), minlength=count + 1) * config.cell**2
    edge = set(np.unique(np.concatenate([labels[0], labels[-1], labels[:, 0], labels[:, -1]])))
    kept = [k for k in range(1, count + 1) if areas[k] >= config.least_area]
    boxes = ndimage.find_objects(labels)
    regions = []
    for k in kept:
        region = np.zeros_like(solid)
        region[boxes[k - 1]] = ndimage.binary_fill_holes(labels[boxes[k - 1]] == k)
        regions.append(region)
    return Plan(raster, walls, openings, regions, [k in edge for k in kept])


def _touches(plane: MapPlane, place: Array, half: float) -> bool:
    ends = plane.ends() - place
    return bool((ends.min(axis=0) < half).all() and (ends.max(axis=0) > -half).all())
