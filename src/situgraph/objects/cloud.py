"""Masks and depth to labelled points (paper, section 'Object detection').

Points come in the optical frame of the camera (x right, y down, z forward, metres). Depth cameras
are noisy at range, bleed at edges and see nothing, or what lies behind, through glass: far and edge
pixels are left out, and what hangs in a wall takes the plane of the wall around it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from situgraph.geometry.poses import Array
from situgraph.objects.config import ObjectsConfig
from situgraph.objects.detections import Camera, Detection

GLASS = frozenset({"window"})
RING_POINTS = 30  # fewest ring pixels that carry a plane
PLANE_ROUNDS = 3  # of trimming in the plane fit


@dataclass(frozen=True, eq=False)
class LabelledCloud:
    """Points (n, 3) in the optical frame that belong to one detection."""

    category: str
    score: float
    points: Array


def labelled_clouds(
    depth: NDArray[np.float32],
    camera: Camera,
    detections: Sequence[Detection],
    config: ObjectsConfig,
) -> list[LabelledCloud]:
    """The points of each detection in a depth image (h, w), metres, 0 where there is none.

    Detections without usable points are left out.
    """
    z = np.asarray(depth, dtype=float)
    good = usable(z, camera, config)
    clouds = []
    for detection in detections:
        points = _points(z, good, camera, detection, config)
        if len(points):
            clouds.append(LabelledCloud(detection.category, detection.score, points))
    return clouds


def max_range(camera: Camera, config: ObjectsConfig) -> float:
    """The depth (m) at which the noise sigma_z = z^2 s / (f b) reaches its limit."""
    return math.sqrt(
        config.max_depth_sigma * camera.fx * config.depth_baseline / config.disparity_sigma
    )


def usable(z: Array, camera: Camera, config: ObjectsConfig) -> NDArray[np.bool_]:
    """Pixels with a finite depth in range that lie on no depth edge."""
    finite = np.isfinite(z) & (z > 0.0)
    filled = np.where(finite, z, 0.0)
    step = ndimage.maximum_filter(filled, 3) - ndimage.minimum_filter(
        np.where(finite, z, np.inf), 3
    )
    good: NDArray[np.bool_] = (
        finite & (filled < max_range(camera, config)) & (step < config.depth_step * filled)
    )
    return good


def _points(
    z: Array,
    good: NDArray[np.bool_],
    camera: Camera,
    detection: Detection,
    config: ObjectsConfig,
) -> Array:
    """The points of one detection; only the image part around its mask is looked at."""
    rows, columns = np.any(detection.mask, axis=1), np.any(detection.mask, axis=0)
    if not rows.any():
        return np.zeros((0, 3))
    border = config.ring_width + 1
    (top, bottom), (left, right) = (
        (int(np.argmax(line)), len(line) - int(np.argmax(line[::-1]))) for line in (rows, columns)
    )
    window = (
        slice(max(0, top - border), bottom + border),
        slice(max(0, left - border), right + border),
    )
    mask = detection.mask[window]
    v, u = np.mgrid[window[0].start : window[0].start + mask.shape[0],
                    window[1].start : window[1].start + mask.shape[1]]  # fmt: skip
    rays = np.stack(
        [(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, np.ones(mask.shape)], axis=-1
    )
    core = (
        ndimage.binary_erosion(mask, iterations=config.mask_erosion)
        if config.mask_erosion
        else mask
    )
    if detection.category in GLASS:
        return _on_wall(
            rays, z[window], good[window], mask, core, config, max_range(camera, config)
        )
    pick = core & good[window]
    points: Array = rays[pick] * z[window][pick][:, None]
    return points


def _on_wall(
    rays: Array,
    z: Array,
    good: NDArray[np.bool_],
    mask: NDArray[np.bool_],
    core: NDArray[np.bool_],
    config: ObjectsConfig,
    reach: float,
) -> Array:
    """The mask's rays cut with the plane of the wall around it (none if no plane is seen there)."""
    ring = ndimage.binary_dilation(mask, iterations=config.ring_width) & ~ndimage.binary_dilation(
        mask
    )
    wall = rays[ring & good] * z[ring & good][:, None]
    plane = _plane(wall)
    if plane is None:
        return np.zeros((0, 3))
    normal, offset = plane
    picked = rays[core]
    with np.errstate(divide="ignore"):
        scale = -offset / (picked @ normal)
    near = (scale > 0.0) & (scale < reach)
    points: Array = picked[near] * scale[near][:, None]
    return points


def _plane(points: Array) -> tuple[Array, float] | None:
    """A trimmed least-squares plane of points (n, 3): unit normal and offset, or None."""
    for _ in range(PLANE_ROUNDS):
        if len(points) < RING_POINTS:
            return None
        center = points.mean(axis=0)
        _, _, vectors = np.linalg.svd(points - center, full_matrices=False)
        normal = vectors[2]
        distance = np.abs((points - center) @ normal)
        points = points[distance <= max(2.0 * float(np.median(distance)), 0.005)]
    return normal, -float(normal @ center)
