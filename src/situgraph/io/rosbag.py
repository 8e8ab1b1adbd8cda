"""ROS bags, of ROS 2 (folder, ``.mcap``, ``.db3``) and ROS 1 (``.bag``), without ROS."""

from __future__ import annotations

import contextlib
import itertools
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from situgraph.errors import InputError
from situgraph.io.bag_decode import decode_cloud, decode_depth, decode_rgb, stamp_of
from situgraph.io.bag_order import Pairs, in_order
from situgraph.io.bag_topics import FORWARD, TRANSFORMS, Topic, Transforms, choose_topics
from situgraph.io.recording import (
    IDENTITY,
    STREAMS,
    Intrinsics,
    Message,
    Odometry,
    RecordingInfo,
    Stream,
    WarningLog,
)
from situgraph.scenegraph.graph import Pose, Warning

_HEAD = 500  # messages of a topic looked through for what never changes
_REMEDY = "copy it again, or repair it (`mcap recover`, `ros2 bag reindex`, `rosbag reindex`)"


class BagRecording:
    """Reads a bag as a recording.

    ``topics`` names topics by role (``lidar``, ``rgb``, ``depth``, ``camera_info``, ``odometry``);
    others are guessed by type and name. Poses of sensors come from the static transforms.

    Raises:
        InputError: not a bag, cut short beyond reading, or without scans and images.
    """

    def __init__(self, path: str | Path, topics: Mapping[str, str] | None = None) -> None:
        self._path = Path(path)
        self._opening = WarningLog()
        self._log = WarningLog()
        with self._opened() as reader:
            present = [
                Topic(name, t.msgtype or "several types", t.msgcount)
                for name, t in sorted(reader.topics.items())
            ]
            self._roles = choose_topics(present, topics or {}, self._path, self._opening)
            self._dynamic = [t.name for t in present if t.type in TRANSFORMS and t.name == "/tf"]
            self._intrinsics = self._read_intrinsics(reader)
            lidar, camera = self._read_mounts(reader, present)
            start = reader.start_time / 1e9
            duration = max(reader.end_time - reader.start_time, 0) / 1e9
        self.info = RecordingInfo(
            self._path.stem,
            "ROS 1 bag" if self._path.suffix == ".bag" else "ROS 2 bag",
            start,
            duration,
            self._counts(),
            lidar,
            camera,
            {role: f"{t.name} ({t.type})" for role, t in self._roles.items()},
        )

    @property
    def warnings(self) -> tuple[Warning, ...]:
        """What was odd when the bag was opened, and in the last pass."""
        return (*self._opening.all(), *self._log.all())

    def messages(self, streams: Collection[Stream] = STREAMS) -> Iterator[Message]:
        """See ``Recording.messages``."""
        self._log.clear()
        last = -np.inf
        for message in in_order(self._decoded(frozenset(streams))):
            if message.stamp < last:
                self._log.add(
                    "stamp-backwards",
                    f"a {type(message).__name__.lower()} of {message.stamp:.3f} s comes after "
                    f"{last:.3f} s",
                )
            last = max(last, message.stamp)
            yield message

    @contextlib.contextmanager
    def _opened(self) -> Iterator[Any]:
        from rosbags.highlevel import AnyReader
        from rosbags.typesys import Stores, get_typestore

        reader = None
        try:
            # Bags of older ROS 2 carry no message definitions.
            reader = AnyReader([self._path], default_typestore=get_typestore(Stores.ROS2_HUMBLE))
            reader.open()
        except Exception as error:  # the readers raise whatever their storage raises
            raise InputError(
                self._path, f"is no bag that can be read ({error})", _REMEDY
            ) from error
        try:
            yield reader
        finally:
            with contextlib.suppress(Exception):
                reader.close()

    def _counts(self) -> dict[Stream, int]:
        def of(*roles: str) -> int:
            return max((self._roles[r].count for r in roles if r in self._roles), default=0)

        odometry = of("odometry") or (-1 if self._dynamic else 0)
        return {"scans": of("lidar"), "frames": of("rgb", "depth"), "odometry": odometry}

    def _raw(self, reader: Any, names: Collection[str]) -> Iterator[tuple[str, int, Any]]:
        """Topic, number and content of each message; what cannot be read is left out, noted."""
        connections = [c for c in reader.connections if c.topic in names]
        if not connections:
            return
        numbers = dict.fromkeys(names, 0)
        source = reader.messages(connections=connections)
        while True:
            try:
                connection, _, data = next(source)
            except StopIteration:
                return
            except Exception as error:  # see _opened
                read = ", ".join(f"{n} of {t}" for t, n in numbers.items() if n) or "no message"
                self._log.add("bag-cut-short", f"the bag ends after {read} ({error})")
                return
            topic = connection.topic
            numbers[topic] += 1
            try:
                message = reader.deserialize(data, connection.msgtype)
            except Exception as error:  # damaged bytes make the parser fail in any way
                reason = str(error) or type(error).__name__
                self._log.add("message-unreadable", f"{topic}, message {numbers[topic]}: {reason}")
                continue
            yield topic, numbers[topic], message

    def _read_intrinsics(self, reader: Any) -> Intrinsics | None:
        if "rgb" not in self._roles and "depth" not in self._roles:
            return None
        topic = self._roles.get("camera_info")
        for _, _, message in self._raw(reader, [topic.name] if topic else []):
            # The matrix is `k` in ROS 2 and `K` in ROS 1.
            k = np.asarray(message.k if hasattr(message, "k") else message.K)
            if len(k) == 9 and k[0] > 0 and k[4] > 0:
                return Intrinsics(float(k[0]), float(k[4]), float(k[2]), float(k[5]))
        self._opening.add(
            "no-intrinsics",
            "images are left out: no CameraInfo with a focal length; record the camera_info topic",
        )
        return None

    def _read_mounts(self, reader: Any, present: list[Topic]) -> tuple[Pose | None, Pose | None]:
        """The poses of LiDAR and camera in base."""
        tree = Transforms()
        static = [t.name for t in present if t.type in TRANSFORMS]
        for _, _, message in itertools.islice(self._raw(reader, static), _HEAD):
            tree.add(message.transforms)
        base = "base_link"
        if "odometry" in self._roles:
            base = self._first(reader, "odometry", "child_frame_id") or base
        mounts: list[Pose | None] = []
        for roles, usual in ((("lidar",), IDENTITY), (("depth", "rgb"), FORWARD)):
            role = next((r for r in roles if r in self._roles), None)
            if role is None:
                mounts.append(None)
                continue
            frame = self._first(reader, role, "frame_id")
            pose = tree.between(base, frame) if frame else None
            if pose is None:
                self._opening.add(
                    f"mount-unknown-{role}",
                    f"no transform from {base} to {frame or 'its frame'}: {role} is taken to sit "
                    "in base, looking ahead",
                )
            mounts.append(pose or usual)
        return mounts[0], mounts[1]

    def _first(self, reader: Any, role: str, name: str) -> str:
        for _, _, message in self._raw(reader, [self._roles[role].name]):
            return str(getattr(message, name, "") or getattr(message.header, name, ""))
        return ""

    def _decoded(self, streams: frozenset[str]) -> Iterator[Message]:
        used = {"lidar": "scans", "rgb": "frames", "depth": "frames", "odometry": "odometry"}
        roles = {t.name: r for r, t in self._roles.items() if used.get(r) in streams}
        if self._intrinsics is None:
            roles = {n: r for n, r in roles.items() if r not in ("rgb", "depth")}
        names = list(roles)
        if "odometry" in streams and "odometry" not in self._roles:
            names += self._dynamic
        images = {r for r in roles.values() if r in ("rgb", "depth")}
        pairs = Pairs(images, self._intrinsics or Intrinsics(1.0, 1.0, 0.0, 0.0), self._log)
        with self._opened() as reader:
            for topic, number, message in self._raw(reader, names):
                role = roles.get(topic, "tf")
                try:
                    yield from self._message(role, message, f"{topic}, message {number}", pairs)
                except InputError as error:
                    self._log.add("message-odd", str(error))
        pairs.end()

    def _message(self, role: str, message: Any, source: str, pairs: Pairs) -> Iterator[Message]:
        if role == "lidar":
            scan, lost = decode_cloud(message, source)
            if lost:
                self._log.add("points-not-finite", f"{source}: {lost} points left out")
            yield scan
        elif role == "rgb":
            yield from pairs.add(role, stamp_of(message), decode_rgb(message, source))
        elif role == "depth":
            yield from pairs.add(role, stamp_of(message), decode_depth(message, source))
        elif role == "odometry":
            yield _odometry(
                stamp_of(message), message.pose.pose.position, message.pose.pose.orientation, source
            )
        else:
            for item in message.transforms:
                if item.header.frame_id.strip("/").endswith("odom"):
                    yield _odometry(
                        stamp_of(item), item.transform.translation, item.transform.rotation, source
                    )


def _odometry(stamp: float, at: Any, turn: Any, source: str) -> Odometry:
    pose = np.array([at.x, at.y, at.z, turn.x, turn.y, turn.z, turn.w], dtype=float)
    length = float(np.linalg.norm(pose[3:]))
    if not np.isfinite(pose).all() or length < 1e-6:
        raise InputError(source, "is not a pose (not finite, or a zero quaternion)", "")
    pose[3:] /= length
    return Odometry(stamp, pose)
