"""What a frame shows: whether a place is in its image, in range and not hidden."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from situgraph.geometry.poses import Array
from situgraph.objects.detections import Camera

NEAR = 0.6  # m; what is closer fills the image and is not expected to be recognised
BORDER = 0.1  # share of the image at its rim where nothing is expected
BEHIND = 0.4  # m; depth short of an object by more than this hides it
COARSE = 24  # px; of the depth every so-manieth pixel is kept, both ways
ASIDE = 0.5  # cosine; what is seen from farther aside is not expected to be recognised
MOST_LOOKS = 7200  # that are remembered, of 2 kB each: an hour


@dataclass(frozen=True, eq=False)
class View:
    """One RGB-D frame tied to a keyframe: ``pose`` (4, 4) of the keyframe in the map,
    ``keyframe_T_camera`` (4, 4) of the optical frame in the keyframe's.
    """  # noqa: D205

    keyframe: str
    stamp: float
    rgb: NDArray[np.uint8]
    depth: NDArray[np.float32]
    camera: Camera
    pose: Array
    keyframe_T_camera: Array  # noqa: N815 - the usual notation for frames


@dataclass(frozen=True, eq=False)
class Look:
    """What is remembered of a frame: where the camera was (4, 4), map to camera, how far its depth
    reaches (m), its image's size (h, w) and some of its depth.
    """  # noqa: D205

    to_camera: Array
    camera: Camera
    reach: float
    size: tuple[int, int]
    depth: NDArray[np.float32]

    @classmethod
    def of(cls, view: View, reach: float) -> Look:
        """That of a view."""
        to_camera: Array = np.asarray(np.linalg.inv(view.pose @ view.keyframe_T_camera), float)
        h, w = view.depth.shape
        depth = view.depth[COARSE // 2 :: COARSE, COARSE // 2 :: COARSE].astype(np.float32)
        return cls(to_camera, view.camera, reach, (h, w), depth)

    def shows(self, place: Array, depth: NDArray[np.float32] | None = None) -> bool:
        """Whether a place (3,) is in the image, in range, not hidden; by all of its ``depth``, or
        by what is remembered of it.
        """  # noqa: D205
        x, y, z = self.to_camera[:3, :3] @ place + self.to_camera[:3, 3]
        if not NEAR < z < self.reach:
            return False
        h, w = self.size
        u, v = self.camera.fx * x / z + self.camera.cx, self.camera.fy * y / z + self.camera.cy
        if not (BORDER * w < u < (1 - BORDER) * w and BORDER * h < v < (1 - BORDER) * h):
            return False
        if depth is None:
            rows, columns = self.depth.shape
            there = self.depth[min(int(v) // COARSE, rows - 1), min(int(u) // COARSE, columns - 1)]
        else:
            there = depth[int(v), int(u)]
        return bool(there == 0.0 or there > z - BEHIND)

    def faces(self, place: Array, normal: Array) -> bool:
        """Whether a wall with this ``normal`` (3,) is looked at, not along, at a place (3,)."""
        eye = -self.to_camera[:3, :3].T @ self.to_camera[:3, 3]
        ray = (place - eye)[:2]
        return abs(float(ray @ normal[:2])) >= ASIDE * float(np.linalg.norm(ray))
