"""Images with known poses through the object stage: a user's own RGB-D folder, no SLAM."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from situgraph.errors import InputError
from situgraph.geometry.poses import Array, pose_to_matrix
from situgraph.objects.detections import Camera
from situgraph.objects.stage import ObjectStage, View
from situgraph.scenegraph.graph import SceneGraph, Warning

LATE = 0.1  # s; an image whose pose is older or younger than this has none
STEP = (0.1, 0.1)  # m, rad; an image that shows nothing new after so little motion is left out
ROOMY = (0.7, 12.0)  # m; the usual depth of a picture taken indoors lies between


class RgbdImage(Protocol):
    """A colour image (h, w, 3), its depth (h, w) in metres, 0 for none, and fx fy cx cy."""

    @property
    def stamp(self) -> float:
        """When it was taken (s)."""

    @property
    def rgb(self) -> NDArray[np.uint8] | None:
        """Colours, or None."""

    @property
    def depth(self) -> NDArray[np.float32] | None:
        """Depths, or None."""

    @property
    def intrinsics(self) -> tuple[float, float, float, float]:
        """fx, fy, cx, cy in pixels."""


@dataclass(frozen=True)
class Looked:
    """What came out: the graph with its objects, images seen and images used, what was odd."""

    graph: SceneGraph
    images: int
    used: int
    warnings: tuple[Warning, ...]


@dataclass
class _Count:
    images: int = 0
    without_pose: int = 0
    without_depth: int = 0
    used: int = 0
    depths: list[float] = field(default_factory=list)


def look(
    source: object,
    images: Iterable[RgbdImage],
    stamps: Array,
    poses: Array,
    base_T_camera: Array,
    stage: ObjectStage,
    graph: SceneGraph | None = None,
) -> Looked:
    """Feed every image that has a pose and shows something new; give the objects out.

    Args:
        source: what errors name.
        images: in the order of their stamps (s).
        stamps: (n,) of the poses, in order (s).
        poses: (n, 7) of base in the map, z up.
        base_T_camera: (4, 4) of the optical frame in base.
        stage: with its detector.
        graph: rooms and planes in the map, for relations; None: objects have none.

    Raises:
        InputError: no poses, no depth, no image with a pose, or intrinsics of another image size.
    """
    if len(stamps) == 0:
        remedy = "add groundtruth.txt with lines of stamp x y z qx qy qz qw"
        raise InputError(source, "has no camera poses", remedy)
    matrices = pose_to_matrix(poses)
    count, last = _Count(), np.full((4, 4), np.inf)
    for image in images:
        count.images += 1
        pose = _pose_at(image.stamp, stamps, matrices)
        if pose is None:
            count.without_pose += 1
        elif image.rgb is None or image.depth is None:
            count.without_depth += 1
        elif _moved(last, pose):
            _check_size(source, image.rgb.shape, image.intrinsics)
            seen = image.depth[image.depth > 0]
            if len(seen):
                count.depths.append(float(np.median(seen)))
            last = pose
            key = f"k{count.used}"
            camera = Camera(*image.intrinsics)
            stage.feed(View(key, image.stamp, image.rgb, image.depth, camera, pose, base_T_camera))
            count.used += 1
    if count.used == 0:
        raise _nothing(source, count, stamps)
    found = stage.annotated(graph or SceneGraph(kind="online"), matrices[:, :3, 3])
    return Looked(found, count.images, count.used, tuple(_odd(count)))


def _pose_at(stamp: float, stamps: Array, matrices: Array) -> Array | None:
    """The pose (4, 4) at a stamp, between its neighbours; None where none is near."""
    from scipy.spatial.transform import Rotation, Slerp

    i = int(np.searchsorted(stamps, stamp))
    near = [k for k in (i - 1, i) if 0 <= k < len(stamps) and abs(stamps[k] - stamp) <= LATE]
    if not near:
        return None
    out: Array = matrices[min(near, key=lambda k: abs(stamps[k] - stamp))].copy()
    if len(near) == 2 and stamps[near[1]] > stamps[near[0]]:
        a, b = near
        s = (stamp - stamps[a]) / (stamps[b] - stamps[a])
        turns = Rotation.from_matrix(matrices[[a, b], :3, :3])
        out[:3, :3] = Slerp([0.0, 1.0], turns)(s).as_matrix()
        out[:3, 3] = (1.0 - s) * matrices[a, :3, 3] + s * matrices[b, :3, 3]
    return out


def _moved(before: Array, now: Array) -> bool:
    if not np.isfinite(before).all():
        return True
    turn = np.clip((np.trace(before[:3, :3].T @ now[:3, :3]) - 1.0) / 2.0, -1.0, 1.0)
    step = float(np.linalg.norm(now[:3, 3] - before[:3, 3]))
    return step > STEP[0] or float(np.arccos(turn)) > STEP[1]


def _check_size(
    source: object, shape: tuple[int, ...], intrinsics: tuple[float, float, float, float]
) -> None:
    """The principal point of a camera lies near the middle of its image."""
    _, _, cx, cy = intrinsics
    h, w = shape[:2]
    if not (0.25 * w < cx < 0.75 * w and 0.25 * h < cy < 0.75 * h):
        problem = (
            f"its intrinsics (cx {cx:g}, cy {cy:g}) are of another size than its {w} x {h} images"
        )
        raise InputError(source, problem, "give those of the images as they are stored")


def _nothing(source: object, count: _Count, stamps: Array) -> InputError:
    if count.images == 0:
        return InputError(source, "has no image that can be read", "see docs/recordings.md")
    if count.without_depth:
        remedy = "list both in rgb.txt and depth.txt"
        return InputError(source, "has no image with both colour and depth", remedy)
    span = f"poses run from {stamps[0]:.3f} to {stamps[-1]:.3f} s"
    return InputError(
        source, f"no image has a pose within {LATE} s ({span})", "use one clock for both"
    )


def _odd(count: _Count) -> Iterable[Warning]:
    if count.without_pose:
        yield Warning("image-without-pose", f"{count.without_pose} images have no pose; left out")
    if count.without_depth:
        yield Warning("image-incomplete", f"{count.without_depth} images without colour or depth")
    if not count.depths:
        yield Warning("no-depth", "no depth image holds any depth: nothing can be placed")
    elif not ROOMY[0] <= (usual := float(np.median(count.depths))) <= ROOMY[1]:
        yield Warning(
            "depth-scale",
            f"the usual depth is {usual:.2g} m, odd for pictures of rooms; if the depth images "
            "count other steps a metre, give the number as the fifth in intrinsics.txt",
        )
