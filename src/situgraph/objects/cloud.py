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
RING_POINTS = 20  # fewest ring pixels that carry a plane
DRAWS = 60  # triples tried for a plane; with half of the ring on it, one in eight holds it
FLAT = 0.04  # m; points this near a plane lie on it
WALLS = 3  # planes tried around one window
OWN_SHARE = 0.05  # of a window's pixels that must have depth for it to be asked
BEHIND = 0.3  # m; a window whose depth is all farther behind a plane is not in it
CARRIES = 0.05  # of a mask's points that are the thing itself, not a speck before it


@dataclass(frozen=True, eq=False)
class LabelledCloud:
    """Points (n, 3) in the optical frame that belong to one detection."""

    category: str
    score: float
    points: Array


@dataclass(frozen=True, eq=False)
class _Sparse:
    """A depth image thinned to every so-manieth pixel, and what goes with it."""

    z: Array
    good: NDArray[np.bool_]
    camera: Camera
    reach: float
    erosion: int
    ring: int
    glass: float


def labelled_clouds(
    depth: NDArray[np.float32],
    camera: Camera,
    detections: Sequence[Detection],
    config: ObjectsConfig,
) -> list[LabelledCloud]:
    """The points of each detection in a depth image (h, w), metres, 0 where there is none.

    Every ``config.pixel_step``-th pixel is looked at. Detections without usable points are left
    out.
    """
    step = config.pixel_step
    z = np.asarray(depth)[::step, ::step].astype(float)
    reach = max_range(camera, config)
    image = _Sparse(
        z,
        usable(z, reach, config.depth_step),
        Camera(camera.fx / step, camera.fy / step, camera.cx / step, camera.cy / step),
        reach,
        round(config.mask_erosion / step),
        max(2, round(config.ring_width / step)),
        config.glass_share,
    )
    clouds = []
    for detection in detections:
        mask = detection.mask[::step, ::step]
        if detection.category in GLASS:
            points = _points(image, mask, detection.category)
        else:
            parts, count = ndimage.label(mask)
            points = np.concatenate(
                [np.zeros((0, 3))]
                + [
                    _nearest(_points(image, parts == k, detection.category), config)
                    for k in range(1, count + 1)
                ]
            )
        if len(points):
            clouds.append(LabelledCloud(detection.category, detection.score, points))
    return clouds


def max_range(camera: Camera, config: ObjectsConfig) -> float:
    """The depth (m) at which the noise sigma_z = z^2 s / (f b) reaches its limit."""
    return math.sqrt(
        config.max_depth_sigma * camera.fx * config.depth_baseline / config.disparity_sigma
    )


def usable(z: Array, reach: float, largest_step: float) -> NDArray[np.bool_]:
    """Pixels with a finite depth (m) within ``reach`` that lie on no depth edge.

    An edge is a jump between neighbours by more than ``largest_step`` of the depth.
    """
    finite = np.isfinite(z) & (z > 0.0)
    filled = np.where(finite, z, 0.0)
    step = ndimage.maximum_filter(filled, 3) - ndimage.minimum_filter(
        np.where(finite, z, np.inf), 3
    )
    good: NDArray[np.bool_] = finite & (filled < reach) & (step < largest_step * filled)
    return good


def _points(image: _Sparse, whole: NDArray[np.bool_], category: str) -> Array:
    """The points of one mask; only the image part around it is looked at."""
    rows, columns = np.any(whole, axis=1), np.any(whole, axis=0)
    if not rows.any():
        return np.zeros((0, 3))
    border = image.ring + 1
    (top, bottom), (left, right) = (
        (int(np.argmax(line)), len(line) - int(np.argmax(line[::-1]))) for line in (rows, columns)
    )
    top, left = max(0, top - border), max(0, left - border)
    window = (slice(top, bottom + border), slice(left, right + border))
    mask = whole[window]
    v, u = np.mgrid[top : top + mask.shape[0], left : left + mask.shape[1]]
    k = image.camera
    rays = np.stack([(u - k.cx) / k.fx, (v - k.cy) / k.fy, np.ones(mask.shape)], axis=-1)
    core = ndimage.binary_erosion(mask, iterations=image.erosion) if image.erosion else mask
    z, good = image.z[window], image.good[window]
    if category in GLASS:
        around = ndimage.binary_dilation(mask, iterations=image.ring)
        ring = around & ~ndimage.binary_dilation(mask)
        return _on_wall(rays, z, good, ring, core, image)
    pick = core & good
    points: Array = rays[pick] * z[pick][:, None]
    return points


def _nearest(points: Array, config: ObjectsConfig) -> Array:
    """What of a connected mask's points (n, 3) is the thing, and not seen through or past it.

    Frame and leaf are one thing; the wall of the next room that shows between them is farther from
    the camera by more than a frame is wide, with nothing in between.
    """
    order = np.sort(points[:, 2])
    steps = np.flatnonzero(np.diff(order) > config.frame_width) + 1
    for part in np.split(order, steps):
        if len(part) >= max(config.min_points, CARRIES * len(order)):
            near: Array = points[points[:, 2] <= part[-1]]
            return near
    return points


def _on_wall(
    rays: Array,
    z: Array,
    good: NDArray[np.bool_],
    ring: NDArray[np.bool_],
    core: NDArray[np.bool_],
    image: _Sparse,
) -> Array:
    """The mask's rays cut with the plane of the wall around it (none if no plane is seen there).

    What stands before a window is in the ring too, and so is the wall with the doorway through
    which it is seen: a plane that all of the window's own depth lies behind is not its wall, nor is
    one that more of the ring lies behind than on it, however far that is. What has the wall's own
    depth nearly everywhere is a picture or a paler piece of wall: in glass there is no depth, or
    that of what lies behind.
    """
    around = rays[ring & good] * z[ring & good][:, None]
    # Far depth is too noisy to place things, but not to tell what lies behind a wall.
    own, depth = rays[core & (z > 0.0)], z[core & (z > 0.0)]
    solid = own, depth
    if len(depth) < OWN_SHARE * core.sum():  # a patch behind the glass says nothing
        own, depth = own[:0], depth[:0]
    rim, rim_depth = rays[ring & (z > 0.0)], z[ring & (z > 0.0)]
    for _ in range(WALLS):
        plane = _plane(around)
        if plane is None:
            break
        normal, offset = plane
        past = not len(depth) or float(np.quantile(_behind(own, depth, plane), 0.1)) < BEHIND
        on = int((np.abs(around @ normal + offset) < FLAT).sum())
        if past and on >= int((_behind(rim, rim_depth, plane) > BEHIND).sum()):
            opaque = int((_behind(*solid, plane) < BEHIND).sum())
            if opaque > (1.0 - image.glass) * int(core.sum()):
                break
            picked = rays[core]
            with np.errstate(divide="ignore"):
                scale = -offset / (picked @ normal)
            near = (scale > 0.0) & (scale < image.reach)
            points: Array = picked[near] * scale[near][:, None]
            return points
        around = around[np.abs(around @ normal + offset) > 2.0 * FLAT]
    return np.zeros((0, 3))


def _behind(rays: Array, depth: Array, plane: tuple[Array, float]) -> Array:
    """How far (m along the optical axis) what rays (n, 3) of unit depth met lies behind a plane."""
    normal, offset = plane
    with np.errstate(divide="ignore"):
        out: Array = depth + offset / (rays @ normal)
    return out


def _plane(points: Array) -> tuple[Array, float] | None:
    """The plane that most points (n, 3) lie on: unit normal and offset, or None.

    The best of ``DRAWS`` triples, then least squares over what it holds.
    """
    if len(points) < RING_POINTS:
        return None
    picks = points[np.random.default_rng(0).integers(len(points), size=(DRAWS, 3))]
    normals = np.cross(picks[:, 1] - picks[:, 0], picks[:, 2] - picks[:, 0])
    lengths = np.linalg.norm(normals, axis=1)
    normals = normals[lengths > 1e-9] / lengths[lengths > 1e-9][:, None]
    if not len(normals):
        return None
    apart = np.abs(points @ normals.T - np.sum(normals * picks[lengths > 1e-9, 0], axis=1))
    held = points[apart[:, int(np.argmax((apart < FLAT).sum(axis=0)))] < FLAT]
    if len(held) < RING_POINTS:
        return None
    center = held.mean(axis=0)
    _, _, vectors = np.linalg.svd(held - center, full_matrices=False)
    return vectors[2], -float(vectors[2] @ center)
