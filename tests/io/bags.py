"""Bags written message by message with whatever oddity a test wants."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

FIELDS = {"f4": 7, "f8": 8, "u1": 2, "u2": 4, "u4": 6}


class Bag:
    """A ROS 1 bag, or a ROS 2 bag with the storage given, to be filled in a ``with`` block."""

    def __init__(self, path: Path, storage: str = "mcap") -> None:
        from rosbags.typesys import Stores, get_typestore

        self.ros1 = storage == "ros1"
        self.store: Any = get_typestore(Stores.ROS1_NOETIC if self.ros1 else Stores.ROS2_HUMBLE)
        if self.ros1:
            from rosbags.rosbag1 import Writer
            from rosbags.typesys import get_types_from_msg

            text = "geometry_msgs/TransformStamped[] transforms"
            self.store.register(get_types_from_msg(text, "tf2_msgs/msg/TFMessage"))

            self.writer: Any = Writer(path)
        else:
            from rosbags.rosbag2 import StoragePlugin, Writer

            plugin = StoragePlugin.MCAP if storage == "mcap" else StoragePlugin.SQLITE3
            self.writer = Writer(path, version=8, storage_plugin=plugin)
        self._connections: dict[str, Any] = {}

    def __enter__(self) -> Bag:
        self.writer.open()
        return self

    def __exit__(self, *error: object) -> None:
        self.writer.close()

    def make(self, name: str, *values: Any) -> Any:
        return self.store.types[name](*values)

    def add(self, topic: str, stamp: float, message: Any, cut: int | None = None) -> None:
        """Store a message; with ``cut``, only its first bytes."""
        kind = message.__msgtype__
        if topic not in self._connections:
            self._connections[topic] = self.writer.add_connection(topic, kind, typestore=self.store)
        if self.ros1:
            data = self.store.serialize_ros1(message, kind)
        else:
            data = self.store.serialize_cdr(message, kind)
        self.writer.write(self._connections[topic], round(stamp * 1e9), bytes(data)[:cut])

    def header(self, stamp: float, frame: str) -> Any:
        seconds, rest = divmod(round(stamp * 1e9), 10**9)
        time = self.make("builtin_interfaces/msg/Time", seconds, rest)
        return self.make("std_msgs/msg/Header", *([0] if self.ros1 else []), time, frame)

    def cloud(self, stamp: float, table: np.ndarray, frame: str = "velodyne") -> Any:
        """A cloud of a structured array."""
        fields = [
            self.make("sensor_msgs/msg/PointField", name, int(offset), FIELDS[kind.str[1:]], 1)
            for name, (kind, offset) in table.dtype.fields.items()
        ]
        data = np.frombuffer(table.tobytes(), np.uint8)
        step = table.dtype.itemsize
        return self.make(
            "sensor_msgs/msg/PointCloud2", self.header(stamp, frame), 1, len(table), fields,
            False, step, step * len(table), data, False,
        )  # fmt: skip

    def image(self, stamp: float, pixels: np.ndarray, encoding: str, frame: str = "cam") -> Any:
        data = np.frombuffer(np.ascontiguousarray(pixels).tobytes(), np.uint8)
        height, width = pixels.shape[:2]
        return self.make(
            "sensor_msgs/msg/Image", self.header(stamp, frame), height, width, encoding, 0,
            len(data) // height, data,
        )  # fmt: skip

    def camera_info(self, stamp: float, size: tuple[int, int], focal: float) -> Any:
        k = np.array([focal, 0, 8, 0, focal, 6, 0, 0, 1.0])
        region = self.make("sensor_msgs/msg/RegionOfInterest", 0, 0, 0, 0, False)
        return self.make(
            "sensor_msgs/msg/CameraInfo", self.header(stamp, "cam"), *size, "plumb_bob",
            np.zeros(5), k, np.eye(3).ravel(), np.zeros(12), 0, 0, region,
        )  # fmt: skip

    def odometry(self, stamp: float, x: float, turn: tuple[float, ...] = (0, 0, 0, 1)) -> Any:
        pose = self.make(
            "geometry_msgs/msg/Pose",
            self.make("geometry_msgs/msg/Point", x, 0.0, 0.0),
            self.make("geometry_msgs/msg/Quaternion", *(float(v) for v in turn)),
        )
        zero = self.make("geometry_msgs/msg/Vector3", 0.0, 0.0, 0.0)
        return self.make(
            "nav_msgs/msg/Odometry",
            self.header(stamp, "odom"),
            "base",
            self.make("geometry_msgs/msg/PoseWithCovariance", pose, np.zeros(36)),
            self.make(
                "geometry_msgs/msg/TwistWithCovariance",
                self.make("geometry_msgs/msg/Twist", zero, zero),
                np.zeros(36),
            ),
        )

    def transform(self, stamp: float, parent: str, child: str, z: float) -> Any:
        moved = self.make(
            "geometry_msgs/msg/Transform",
            self.make("geometry_msgs/msg/Vector3", 0.0, 0.0, z),
            self.make("geometry_msgs/msg/Quaternion", 0.0, 0.0, 0.0, 1.0),
        )
        stamped = self.make(
            "geometry_msgs/msg/TransformStamped", self.header(stamp, parent), child, moved
        )
        return self.make("tf2_msgs/msg/TFMessage", [stamped])


def points(n: int = 4, **columns: np.ndarray) -> np.ndarray:
    """A structured array with x, y, z = 1, 2, ... and further columns."""
    dtype = [(k, "<f4") for k in "xyz"] + [(k, v.dtype.str) for k, v in columns.items()]
    table = np.zeros(n, dtype=dtype)
    for i, axis in enumerate("xyz"):
        table[axis] = np.arange(n) + i + 1
    for name, values in columns.items():
        table[name] = values
    return table
