"""What a robot's log is to every stage: three streams of messages in the order of their stamps.

Frames (right-handed, metres): ``base`` is fixed to the robot's body, x forward, y left, z up;
``lidar`` and ``camera`` are fixed to base by ``RecordingInfo.base_T_lidar`` and
``base_T_camera``; the camera frame is the optical one (x right, y down, z forward). ``odom`` is
gravity-aligned (z up) and drifts; its first pose may be anywhere. Stamps are seconds.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal, NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from situgraph.errors import InputError
from situgraph.scenegraph.graph import Pose, Warning

Stream = Literal["scans", "frames", "odometry"]
STREAMS: tuple[Stream, ...] = ("scans", "frames", "odometry")
IDENTITY: Pose = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)


class Intrinsics(NamedTuple):
    """Pinhole camera in pixels: u = fx x / z + cx, v = fy y / z + cy; pixel centres at integers."""

    fx: float
    fy: float
    cx: float
    cy: float


@dataclass(frozen=True, eq=False)
class Scan:
    """One turn of a LiDAR, as measured (not deskewed). Only returns are listed, in time order.

    ``stamp`` is the time the turn **ended** (s). ``points`` (n, 3) float32, metres: each one in
    the lidar frame at its own firing time. ``times`` (n,) float32, seconds relative to
    ``stamp``, never positive; ``rings`` (n,) uint8, 0 is the lowest beam; ``intensity`` (n,)
    float32 in 0..1; each is None when the source has none.
    """

    stamp: float
    points: NDArray[np.float32]
    times: NDArray[np.float32] | None = None
    rings: NDArray[np.uint8] | None = None
    intensity: NDArray[np.float32] | None = None


@dataclass(frozen=True, eq=False)
class Frame:
    """An RGB-D image of one moment.

    ``rgb`` (h, w, 3) uint8; ``depth`` (h, w) float32, metres along the optical axis, 0 where there
    is none, aligned to ``rgb``. Either may be None, not both.
    """

    stamp: float
    rgb: NDArray[np.uint8] | None
    depth: NDArray[np.float32] | None
    intrinsics: Intrinsics


@dataclass(frozen=True, eq=False)
class Odometry:
    """The robot's own estimate of base in the odom frame: ``pose`` (7,) ``x y z qx qy qz qw``."""

    stamp: float
    pose: NDArray[np.float64]


Message = Scan | Frame | Odometry


@dataclass(frozen=True)
class RecordingInfo:
    """What a recording holds. ``counts`` are messages per stream; -1 where only reading would tell.

    ``base_T_lidar`` and ``base_T_camera`` are poses of the sensors in base, None where there is
    no such sensor. ``start`` is the first stamp and ``duration`` the time to the last (s).
    """

    name: str
    kind: str
    start: float
    duration: float
    counts: Mapping[Stream, int]
    base_T_lidar: Pose | None = None  # noqa: N815
    base_T_camera: Pose | None = None  # noqa: N815
    sensors: Mapping[str, str] = field(default_factory=dict)


@runtime_checkable
class Recording(Protocol):
    """A log that can be read from its beginning as often as wanted, in bounded memory."""

    @property
    def info(self) -> RecordingInfo:
        """What the log holds; known before any message is read."""
        ...

    @property
    def warnings(self) -> tuple[Warning, ...]:
        """What was odd in the log so far; grows while messages are read, one entry a code."""
        ...

    def messages(self, streams: Collection[Stream] = STREAMS) -> Iterator[Message]:
        """Messages of the named streams in the order of their stamps.

        Stamps that go backwards in the source are passed on as they are, with a warning.

        Raises:
            InputError: a part of the log cannot be used at all; says which and what was found.
        """
        ...


class WarningLog:
    """Collects warnings while a log is read: the first sentence of each code and how many came."""

    def __init__(self) -> None:
        """Start empty."""
        self._first: dict[str, str] = {}
        self._count: dict[str, int] = {}

    def add(self, code: str, message: str) -> None:
        """Note one more ``code``; only its first ``message`` is kept."""
        self._first.setdefault(code, message)
        self._count[code] = self._count.get(code, 0) + 1

    def clear(self) -> None:
        """Forget everything: a new pass over the log begins."""
        self._first.clear()
        self._count.clear()

    def all(self) -> tuple[Warning, ...]:
        """One warning a code, in the order of their first occurrence."""
        return tuple(
            Warning(code, text if (n := self._count[code]) == 1 else f"{text} ({n} times)")
            for code, text in self._first.items()
        )


def open_recording(path: str | Path, *, topics: Mapping[str, str] | None = None) -> Recording:
    """Open the recording at ``path``, whatever it is.

    Recognised: situgraph's folder format, ROS 2 bags (folder, ``.mcap``, ``.db3``), ROS 1 ``.bag``,
    a folder of keyframes as S-Graphs dumps them (``000000/data`` and ``cloud.pcd``), a TUM RGB-D
    folder (``rgb.txt`` and ``depth.txt``). ``topics`` names a bag's topics by role (``lidar``,
    ``rgb``, ``depth``, ``camera_info``, ``odometry``) where guessing by type is not wanted.

    Raises:
        InputError: nothing is there, or it is none of the above.
    """
    path = Path(path)
    if not path.exists():
        raise InputError(path, "no such file or folder", "give a recording")
    if path.is_file():
        if path.suffix in {".bag", ".mcap", ".db3"}:
            return _bag(path, topics)
        if path.name in {"metadata.yaml", "recording.json"}:
            return open_recording(path.parent, topics=topics)
    elif (path / "recording.json").is_file():
        from situgraph.io.folder import FolderRecording

        return FolderRecording(path)
    elif (path / "metadata.yaml").is_file() or any(path.glob("*.mcap")) or any(path.glob("*.db3")):
        return _bag(path, topics)
    elif (path / "rgb.txt").is_file() or (path / "depth.txt").is_file():
        from situgraph.io.rgbd import RgbdRecording

        return RgbdRecording(path)
    elif any(path.glob("[0-9]*/cloud.pcd")):
        from situgraph.io.keyframes import KeyframeRecording

        return KeyframeRecording(path)
    raise InputError(
        path,
        "is not a recording",
        "expected a folder with recording.json, a ROS bag (.bag, .mcap, .db3, metadata.yaml), "
        "keyframe folders with cloud.pcd, or rgb.txt and depth.txt",
    )


def _bag(path: Path, topics: Mapping[str, str] | None) -> Recording:
    from situgraph.io.rosbag import BagRecording

    return BagRecording(path, topics=topics)
