"""Recordings as ROS 2 bags (MCAP), without ROS."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from situgraph.io.recording import Frame, Intrinsics, Message, Odometry, RecordingInfo, Scan
from situgraph.scenegraph.graph import Pose

_TOPICS = {
    "lidar": ("/points", "sensor_msgs/msg/PointCloud2"),
    "rgb": ("/camera/color/image_raw", "sensor_msgs/msg/Image"),
    "depth": ("/camera/aligned_depth_to_color/image_raw", "sensor_msgs/msg/Image"),
    "info": ("/camera/aligned_depth_to_color/camera_info", "sensor_msgs/msg/CameraInfo"),
    "odometry": ("/odom", "nav_msgs/msg/Odometry"),
    "static": ("/tf_static", "tf2_msgs/msg/TFMessage"),
    "tf": ("/tf", "tf2_msgs/msg/TFMessage"),
}
_POINT = np.dtype(
    {
        "names": ["x", "y", "z", "intensity", "ring", "time"],
        "formats": ["<f4", "<f4", "<f4", "<f4", "<u2", "<f4"],
        "offsets": [0, 4, 8, 12, 16, 18],
        "itemsize": 22,
    }
)
_FLOAT32, _UINT16 = 7, 4  # sensor_msgs/PointField
_BASE, _ODOM, _LIDAR, _CAMERA = "base_link", "odom", "velodyne", "camera_color_optical_frame"


class BagWriter:
    """Writes a recording into an existing folder as a bag, message by message."""

    def __init__(self, folder: Path, info: RecordingInfo) -> None:
        from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
        from rosbags.typesys import Stores, get_typestore

        self._folder, self._info = folder, info
        self._store: Any = get_typestore(Stores.ROS2_HUMBLE)
        # rosbags makes the folder itself; the files are moved up in the end.
        self._bag: Any = Writer(folder / "bag", version=8, storage_plugin=StoragePlugin.MCAP)
        self._bag.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
        self._bag.open()
        self._connections = {
            k: self._bag.add_connection(name, kind, typestore=self._store)
            for k, (name, kind) in _TOPICS.items()
        }
        self._started = False

    def add(self, message: Message) -> None:
        """Store one more message."""
        if not self._started:
            self._started = True
            self._write("static", message.stamp, self._mounts(message.stamp))
        if isinstance(message, Scan):
            self._write("lidar", message.stamp, self._cloud(message))
        elif isinstance(message, Odometry):
            self._write("odometry", message.stamp, self._odometry(message))
            moved = self._transform(message.stamp, _ODOM, _BASE, message.pose)
            self._write("tf", message.stamp, self._make("tf2_msgs/msg/TFMessage", [moved]))
        else:
            self._images(message)

    def finish(self) -> None:
        """Complete the bag."""
        self._bag.close()
        inner = self._folder / "bag"
        for file in sorted(inner.iterdir()):
            file.rename(self._folder / file.name)
        inner.rmdir()

    def _make(self, name: str, *values: Any) -> Any:
        return self._store.types[name](*values)

    def _write(self, key: str, stamp: float, message: Any) -> None:
        kind = _TOPICS[key][1]
        data = self._store.serialize_cdr(message, kind)
        self._bag.write(self._connections[key], round(stamp * 1e9), data)

    def _header(self, stamp: float, frame: str) -> Any:
        seconds, rest = divmod(round(stamp * 1e9), 1_000_000_000)
        time = self._make("builtin_interfaces/msg/Time", seconds, rest)
        return self._make("std_msgs/msg/Header", time, frame)

    def _cloud(self, scan: Scan) -> Any:
        table = np.zeros(len(scan.points), dtype=_POINT)
        for i, axis in enumerate("xyz"):
            table[axis] = scan.points[:, i]
        known = [("x", _FLOAT32), ("y", _FLOAT32), ("z", _FLOAT32)]
        for name, values, kind in (
            ("intensity", scan.intensity, _FLOAT32),
            ("ring", scan.rings, _UINT16),
            ("time", scan.times, _FLOAT32),
        ):
            if values is not None:
                table[name] = values
                known.append((name, kind))
        offsets: Any = _POINT.fields
        fields = [
            self._make("sensor_msgs/msg/PointField", name, int(offsets[name][1]), kind, 1)
            for name, kind in known
        ]
        step = _POINT.itemsize
        return self._make(
            "sensor_msgs/msg/PointCloud2",
            self._header(scan.stamp, _LIDAR),
            1,
            len(table),
            fields,
            False,
            step,
            step * len(table),
            np.frombuffer(table.tobytes(), dtype=np.uint8),
            True,
        )

    def _images(self, frame: Frame) -> None:
        header = self._header(frame.stamp, _CAMERA)
        for key, image, encoding in (
            ("rgb", frame.rgb, "rgb8"),
            ("depth", frame.depth, "16UC1"),
        ):
            if image is None:
                continue
            pixels = image
            if key == "depth":
                whole = np.rint(np.clip(image.astype(np.float64), 0, 65.535) * 1000)
                pixels = whole.astype("<u2")
            data = np.frombuffer(pixels.tobytes(), dtype=np.uint8)
            height, width = image.shape[:2]
            message = self._make(
                "sensor_msgs/msg/Image",
                header,
                height,
                width,
                encoding,
                0,
                len(data) // height,
                data,
            )
            self._write(key, frame.stamp, message)
            if key == "depth" or frame.depth is None:
                info = self._camera_info(header, height, width, frame.intrinsics)
                self._write("info", frame.stamp, info)

    def _camera_info(self, header: Any, height: int, width: int, k: Intrinsics) -> Any:
        matrix = np.array([k.fx, 0, k.cx, 0, k.fy, k.cy, 0, 0, 1], dtype=float)
        projection = np.array([k.fx, 0, k.cx, 0, 0, k.fy, k.cy, 0, 0, 0, 1, 0], dtype=float)
        region = self._make("sensor_msgs/msg/RegionOfInterest", 0, 0, 0, 0, False)
        return self._make(
            "sensor_msgs/msg/CameraInfo",
            header,
            height,
            width,
            "plumb_bob",
            np.zeros(5),
            matrix,
            np.eye(3).ravel(),
            projection,
            0,
            0,
            region,
        )

    def _pose_parts(self, pose: Any) -> tuple[Any, Any]:
        x, y, z, qx, qy, qz, qw = (float(v) for v in pose)
        turn = self._make("geometry_msgs/msg/Quaternion", qx, qy, qz, qw)
        return (x, y, z), turn

    def _odometry(self, message: Odometry) -> Any:
        at, turn = self._pose_parts(message.pose)
        pose = self._make(
            "geometry_msgs/msg/Pose", self._make("geometry_msgs/msg/Point", *at), turn
        )
        zero = self._make("geometry_msgs/msg/Vector3", 0.0, 0.0, 0.0)
        twist = self._make("geometry_msgs/msg/Twist", zero, zero)
        return self._make(
            "nav_msgs/msg/Odometry",
            self._header(message.stamp, _ODOM),
            _BASE,
            self._make("geometry_msgs/msg/PoseWithCovariance", pose, np.zeros(36)),
            self._make("geometry_msgs/msg/TwistWithCovariance", twist, np.zeros(36)),
        )

    def _transform(self, stamp: float, parent: str, child: str, pose: Any) -> Any:
        at, turn = self._pose_parts(pose)
        shift = self._make("geometry_msgs/msg/Vector3", *at)
        moved = self._make("geometry_msgs/msg/Transform", shift, turn)
        header = self._header(stamp, parent)
        return self._make("geometry_msgs/msg/TransformStamped", header, child, moved)

    def _mounts(self, stamp: float) -> Any:
        mounts: list[tuple[str, Pose | None]] = [
            (_LIDAR, self._info.base_T_lidar),
            (_CAMERA, self._info.base_T_camera),
        ]
        found = [self._transform(stamp, _BASE, name, pose) for name, pose in mounts if pose]
        return self._make("tf2_msgs/msg/TFMessage", found)
