"""Which topic of a bag plays which role, and where the sensors sit on the robot."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import msgspec
import numpy as np

from situgraph.errors import InputError
from situgraph.geometry.poses import Array, matrix_to_pose, pose_to_matrix
from situgraph.io.recording import WarningLog
from situgraph.scenegraph.graph import Pose

ROLES = ("lidar", "rgb", "depth", "camera_info", "odometry")
_IMAGES = ("sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage")
_TYPES: Mapping[str, tuple[str, ...]] = {
    "lidar": ("sensor_msgs/msg/PointCloud2",),
    "rgb": _IMAGES,
    "depth": _IMAGES,
    "camera_info": ("sensor_msgs/msg/CameraInfo",),
    "odometry": ("nav_msgs/msg/Odometry",),
}
TRANSFORMS = ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage")
# The optical frame in a camera that looks along base's x axis.
FORWARD: Pose = (0.0, 0.0, 0.0, -0.5, 0.5, -0.5, 0.5)
_LINKS = 50  # of a chain of transforms


class Topic(msgspec.Struct, frozen=True):
    """A topic of a bag: its name, message type and number of messages."""

    name: str
    type: str
    count: int


def choose_topics(
    topics: Sequence[Topic], wanted: Mapping[str, str], source: object, log: WarningLog
) -> dict[str, Topic]:
    """The topic of each role that the bag can fill.

    ``wanted`` names topics by role; other roles are guessed by type and name, the one with the most
    messages where there are several.

    Raises:
        InputError: an unknown role, a topic that is not there or of another type, or a bag with
            neither scans nor images.
    """
    found: dict[str, Topic] = {}
    by_name = {t.name: t for t in topics}
    listing = ", ".join(f"{t.name} ({t.type})" for t in topics[:20]) or "nothing"
    for role, name in wanted.items():
        if role not in ROLES:
            raise InputError(source, f"no role {role!r}", f"roles are {', '.join(ROLES)}")
        if name not in by_name:
            raise InputError(source, f"has no topic {name}", f"it has {listing}")
        if by_name[name].type not in _TYPES[role]:
            raise InputError(
                source,
                f"topic {name} is {by_name[name].type}",
                f"{role} needs {' or '.join(_TYPES[role])}",
            )
        found[role] = by_name[name]
    for role in ROLES:
        if role not in found and (options := _options(role, topics, found)):
            found[role] = options[0]
            if len(options) > 1:
                others = ", ".join(t.name for t in options[1:6])
                log.add(
                    f"topic-chosen-{role}",
                    f"{role} is read from {options[0].name}; there are also {others}",
                )
    if "lidar" not in found and "rgb" not in found and "depth" not in found:
        raise InputError(source, f"has no PointCloud2 or Image topic but {listing}", "record one")
    return found


def _options(role: str, topics: Sequence[Topic], found: Mapping[str, Topic]) -> list[Topic]:
    options = [t for t in topics if t.type in _TYPES[role] and t.count]
    if role in ("rgb", "depth"):
        skip = ("mask", "label", "infra", "/ir", "semantic")
        options = [
            t
            for t in options
            if ("depth" in t.name) == (role == "depth") and not any(s in t.name for s in skip)
        ]
    if role == "camera_info":
        image = found.get("depth") or found.get("rgb")
        options.sort(key=lambda t: -_common(t.name, image.name if image else ""))
        return options[:1]

    def rank(topic: Topic) -> tuple[bool, bool, int]:
        return ("aligned" not in topic.name, "compressed" in topic.name.lower(), -topic.count)

    return sorted(options, key=rank)


def _common(a: str, b: str) -> int:
    """Length of the common beginning of two names."""
    return next((i for i, (x, y) in enumerate(zip(a, b)) if x != y), min(len(a), len(b)))


class Transforms:
    """Static transforms between named frames."""

    def __init__(self) -> None:
        self._to_parent: dict[str, tuple[str, Array]] = {}

    def add(self, transforms: Iterable[Any]) -> None:
        """Add geometry_msgs/TransformStamped messages; damaged ones are left out."""
        for item in transforms:
            t, q = item.transform.translation, item.transform.rotation
            pose = np.array([t.x, t.y, t.z, q.x, q.y, q.z, q.w])
            if np.isfinite(pose).all() and np.linalg.norm(pose[3:]) > 1e-6:
                child, parent = _bare(item.child_frame_id), _bare(item.header.frame_id)
                self._to_parent[child] = (parent, pose_to_matrix(pose))

    def between(self, base: str, sensor: str) -> Pose | None:
        """The pose of ``sensor`` in ``base``; None where the frames are not connected."""
        chain_a, chain_b = self._chain(_bare(sensor)), self._chain(_bare(base))
        for frame, sensor_up in chain_a.items():
            if frame in chain_b:
                m = np.linalg.inv(chain_b[frame]) @ sensor_up
                x, y, z, qx, qy, qz, qw = matrix_to_pose(m).tolist()
                return (x, y, z, qx, qy, qz, qw)
        return None

    def _chain(self, frame: str) -> dict[str, Array]:
        """The frame and its ancestors, each with the pose of ``frame`` in it."""
        found = {frame: np.eye(4)}
        for _ in range(_LINKS):
            if frame not in self._to_parent:
                break
            parent, link = self._to_parent[frame]
            if parent in found:
                break
            found[parent] = link @ found[frame]
            frame = parent
        return found


def _bare(frame: str) -> str:
    return str(frame).lstrip("/")
