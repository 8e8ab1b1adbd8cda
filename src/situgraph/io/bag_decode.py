"""ROS messages as our own: clouds, images, poses. Works on what ``rosbags`` deserialises."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
from numpy.typing import NDArray

from situgraph.errors import InputError
from situgraph.io.images import MAX_PIXELS
from situgraph.io.recording import Scan

# sensor_msgs/PointField: number of a type -> numpy's name.
_TYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 8: "f8"}
_TIMES = ("time", "t", "timestamp", "time_stamp", "offset_time", "point_time_offset")
_RINGS = ("ring", "channel", "line")
_ABSOLUTE = 1e6  # s; a larger time is no offset in a turn but a clock's
_DEPTH_DTYPES = {"16UC1": "u2", "mono16": "u2", "32FC1": "f4"}
_COLORS = {"rgb8": (3, (0, 1, 2)), "bgr8": (3, (2, 1, 0)), "rgba8": (4, (0, 1, 2)),
           "bgra8": (4, (2, 1, 0)), "mono8": (1, (0, 0, 0)), "8UC3": (3, (2, 1, 0)),
           "8UC1": (1, (0, 0, 0))}  # fmt: skip


def stamp_of(message: Any) -> float:
    """The header's stamp in seconds."""
    stamp = message.header.stamp
    # One division of whole nanoseconds gives the nearest double.
    return float((int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)) / 1e9)


def decode_cloud(message: Any, source: str) -> tuple[Scan, int]:
    """A scan of a PointCloud2 and how many of its points were not finite and left out.

    Its stamp becomes the end of the turn, whichever end the driver stamped.

    Raises:
        InputError: x, y, z are missing or the sizes do not fit; ``source`` names the message.
    """
    table = _table(message, source)
    names = table.dtype.names or ()
    xyz = np.stack([table[k].astype(np.float32) for k in ("x", "y", "z")], axis=1)
    keep = np.isfinite(xyz).all(axis=1)
    times = next((_seconds(table[k], message) for k in _TIMES if k in names), None)
    rings = next((table[k] for k in _RINGS if k in names), None)
    bright = table["intensity"].astype(np.float32) if "intensity" in names else None
    if bright is not None and len(bright) and float(np.nanmax(bright)) > 1.0:
        bright = bright / np.float32(255)
    stamp = stamp_of(message)
    if times is not None:
        keep &= np.isfinite(times)
        if keep.any():
            late = float(times[keep].max())
            if late > 0:
                stamp, times = stamp + late, times - late
    lost = int((~keep).sum())
    order = np.flatnonzero(keep)
    if times is not None and len(order) and np.any(np.diff(times[order]) < 0):
        order = order[np.argsort(times[order], kind="stable")]
    scan = Scan(
        stamp,
        xyz[order],
        None if times is None else times[order].astype(np.float32),
        None if rings is None else np.minimum(rings[order], 255).astype(np.uint8),
        None if bright is None else np.nan_to_num(bright[order]),
    )
    return scan, lost if int(message.height) <= 1 else 0


def _table(message: Any, source: str) -> NDArray[np.void]:
    fields = {f.name: f for f in message.fields}
    if not {"x", "y", "z"} <= set(fields):
        raise InputError(source, f"has fields {', '.join(fields) or 'none'}", "x, y, z are needed")
    step, count = int(message.point_step), int(message.width) * int(message.height)
    data = np.asarray(message.data, dtype=np.uint8).tobytes()
    if len(data) < step * count:
        raise InputError(
            source, f"has {len(data)} bytes where {count} points need {step * count}", ""
        )
    order = ">" if message.is_bigendian else "<"
    try:
        layout = np.dtype(
            {
                "names": list(fields),
                "formats": [order + _TYPES[int(f.datatype)] for f in fields.values()],
                "offsets": [int(f.offset) for f in fields.values()],
                "itemsize": step,
            }
        )
    except (KeyError, ValueError, TypeError) as error:
        raise InputError(source, f"has fields that do not fit ({error})", "") from error
    return np.frombuffer(data, dtype=layout, count=count)


def _seconds(values: NDArray[Any], message: Any) -> NDArray[np.float64]:
    """Times of points relative to the header's stamp, s: offsets or a clock, s or ns."""
    times = values.astype(np.float64)
    if values.dtype.kind in "iu" or (len(times) and np.nanmax(np.abs(times)) > 1e12):
        times = times * 1e-9
    if len(times) and float(np.nanmax(times)) > _ABSOLUTE:
        times = times - stamp_of(message)
    return times


def decode_rgb(message: Any, source: str) -> NDArray[np.uint8]:
    """A colour image (h, w, 3) of an Image or CompressedImage.

    Raises:
        InputError: an encoding that is not read, or too little data.
    """
    if hasattr(message, "format"):
        return np.asarray(_unpacked(bytes(message.data), source).convert("RGB"))
    encoding = str(message.encoding)
    if encoding not in _COLORS:
        raise InputError(source, f"is encoded as {encoding!r}", "rgb8 and bgr8 are read")
    channels, order = _COLORS[encoding]
    pixels = _rows(message, "u1", channels, source)
    return np.ascontiguousarray(pixels[:, :, list(order)])


def decode_depth(message: Any, source: str) -> NDArray[np.float32]:
    """A depth image (h, w) in metres, 0 for none: 16 bit millimetres or 32 bit metres.

    Raises:
        InputError: an encoding that is not read, or too little data.
    """
    if hasattr(message, "format"):
        data = bytes(message.data)
        # compressedDepth puts a header before the PNG.
        start = max(data[:64].find(b"\x89PNG"), 0)
        image = np.asarray(_unpacked(data[start:], source))
        if image.ndim != 2:
            raise InputError(source, "is a colour image, not depth", "record the depth topic")
        return (image / 1000.0).astype(np.float32)
    encoding = str(message.encoding)
    if encoding not in _DEPTH_DTYPES:
        raise InputError(source, f"is encoded as {encoding!r}", "16UC1 and 32FC1 are read")
    pixels = _rows(message, _DEPTH_DTYPES[encoding], 1, source)[:, :, 0]
    if encoding == "32FC1":
        return np.nan_to_num(pixels.astype(np.float32), nan=0.0, posinf=0.0, neginf=0.0)
    return (pixels / 1000.0).astype(np.float32)


def _rows(message: Any, dtype: str, channels: int, source: str) -> NDArray[Any]:
    kind = np.dtype(dtype).newbyteorder(">" if message.is_bigendian else "<")
    height, width, step = int(message.height), int(message.width), int(message.step)
    data = np.asarray(message.data, dtype=np.uint8)
    need = width * channels * kind.itemsize
    if height * width > MAX_PIXELS or step < need or len(data) < height * step:
        raise InputError(
            source, f"is {width}x{height} with {len(data)} bytes and a step of {step}", ""
        )
    rows = data[: height * step].reshape(height, step)[:, :need]
    return np.ascontiguousarray(rows).view(kind).reshape(height, width, channels)


def _unpacked(data: bytes, source: str) -> Any:
    from PIL import Image, UnidentifiedImageError

    try:
        image = Image.open(io.BytesIO(data))
        if image.width * image.height > MAX_PIXELS:
            raise InputError(source, f"is {image.width}x{image.height}", "scale it down")
        image.load()
    except (OSError, SyntaxError, ValueError, UnidentifiedImageError) as error:
        raise InputError(source, f"is no image that can be read ({error})", "") from error
    return image
