"""The folder format: a recording as plain files (``docs/recordings.md``).

``recording.json`` says what there is; ``odometry.tum``, ``scans.csv`` and ``frames.csv`` list the
stamps; scan i is ``scans/00000i.png`` (a range image) or ``.npz`` (points), image i
``frames/00000i.jpg`` and ``.png`` (depth) or ``.d.png`` (disparity).
"""

from __future__ import annotations

import heapq
import itertools
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import Annotated, Any, Literal

import msgspec
import numpy as np

from situgraph.errors import InputError
from situgraph.io.images import read_depth, read_disparity, read_rgb, write_depth, write_rgb
from situgraph.io.recording import (
    STREAMS,
    Frame,
    Intrinsics,
    Message,
    Odometry,
    RecordingInfo,
    Scan,
    Stream,
    WarningLog,
)
from situgraph.io.scan_files import ScanFiles
from situgraph.scenegraph.graph import Pose, Warning

RANGE_STEP = 0.002  # m, of range images
DISPARITY = (19.3, 0.03125)  # m px and px: focal length times baseline, and step, of a D435

Count = Annotated[int, msgspec.Meta(ge=0)]


class Manifest(msgspec.Struct, frozen=True, kw_only=True):
    """``recording.json``. Lengths in metres, times in seconds."""

    format: Literal["situgraph/recording"] = "situgraph/recording"
    version: Literal[1] = 1
    name: str
    start: float
    duration: Annotated[float, msgspec.Meta(ge=0)]
    scans: Count
    frames: Count
    odometry: Count
    base_T_lidar: Pose | None = None  # noqa: N815
    base_T_camera: Pose | None = None  # noqa: N815
    sensors: dict[str, str] = {}
    intrinsics: Intrinsics | None = None
    lidar_rate: Annotated[float, msgspec.Meta(gt=0)] = 10.0
    range_step: Annotated[float, msgspec.Meta(gt=0)] = RANGE_STEP
    depth_unit: Annotated[float, msgspec.Meta(gt=0)] = 0.001
    disparity: tuple[float, float] = DISPARITY


class FolderRecording:
    """Reads a recording in the folder format.

    Raises:
        InputError: no ``recording.json``, or it is not what it should be.
    """

    def __init__(self, path: str | Path) -> None:
        self._path = Path(path)
        self._log = WarningLog()
        self._manifest = m = _read_manifest(self._path / "recording.json")
        self._scans = ScanFiles(self._path / "scans", m.lidar_rate, m.range_step)
        counts: dict[Stream, int] = {
            "scans": m.scans,
            "frames": m.frames,
            "odometry": m.odometry,
        }
        self.info = RecordingInfo(
            m.name,
            "folder",
            m.start,
            m.duration,
            counts,
            m.base_T_lidar,
            m.base_T_camera,
            m.sensors,
        )

    @property
    def warnings(self) -> tuple[Warning, ...]:
        """What could not be read in the last pass."""
        return self._log.all()

    def messages(self, streams: Collection[Stream] = STREAMS) -> Iterator[Message]:
        """See ``Recording.messages``; a file that cannot be read is left out with a warning."""
        self._log.clear()
        parts: list[Iterator[Message]] = []
        if "odometry" in streams and self._manifest.odometry:
            parts.append(self._odometries())
        if "scans" in streams and self._manifest.scans:
            parts.append(self._read("scans", self._scans.read))
        if "frames" in streams and self._manifest.frames:
            parts.append(self._read("frames", self._frame))
        return heapq.merge(*parts, key=lambda m: m.stamp)

    def _odometries(self) -> Iterator[Odometry]:
        for number, line in enumerate(self._lines("odometry.tum"), start=1):
            try:
                row = np.array(line.split(), dtype=float)
            except ValueError:
                row = np.zeros(0)
            if row.shape != (8,) or not np.isfinite(row).all():
                self._log.add("odometry-unreadable", f"odometry.tum, line {number}: {line[:60]!r}")
                continue
            yield Odometry(float(row[0]), row[1:])

    def _read(self, name: str, read: Any) -> Iterator[Any]:
        for index, line in enumerate(self._lines(f"{name}.csv")):
            try:
                stamp = float(line)
            except ValueError:
                stamp = np.nan
            if not np.isfinite(stamp):
                self._log.add(f"{name}-stamp", f"{name}.csv, line {index + 1}: {line[:40]!r}")
                continue
            try:
                yield read(index, stamp)
            except InputError as error:
                self._log.add(f"{name}-unreadable", str(error))

    def _lines(self, name: str) -> Iterator[str]:
        try:
            with (self._path / name).open() as file:
                for line in file:
                    if line.strip() and not line.startswith("#"):
                        yield line.strip()
        except (OSError, UnicodeDecodeError) as error:
            self._log.add("stream-missing", f"{name} cannot be read ({error})")

    def _frame(self, index: int, stamp: float) -> Frame:
        base = self._path / "frames" / f"{index:06d}"
        if self._manifest.intrinsics is None:
            raise InputError(self._path / "recording.json", "no intrinsics", "add fx, fy, cx, cy")
        rgb = read_rgb(base.with_suffix(".jpg")) if base.with_suffix(".jpg").exists() else None
        depth = None
        if base.with_suffix(".png").exists():
            depth = read_depth(base.with_suffix(".png"), self._manifest.depth_unit)
        elif base.with_suffix(".d.png").exists():
            depth = read_disparity(base.with_suffix(".d.png"), *self._manifest.disparity)
        if rgb is None and depth is None:
            raise InputError(base, "neither colour nor depth is there", "copy the recording again")
        if rgb is not None and depth is not None and rgb.shape[:2] != depth.shape:
            raise InputError(
                base, f"colour is {rgb.shape[:2]} and depth {depth.shape}", "align them first"
            )
        return Frame(stamp, rgb, depth, self._manifest.intrinsics)


class FolderWriter:
    """Writes a recording in the folder format, message by message.

    Colour is stored as JPEG (lossy), everything else exactly; depth to a millimetre.
    """

    def __init__(self, path: Path, info: RecordingInfo, lidar_rate: float = 10.0) -> None:
        self._path = path
        self._info = info
        (path / "scans").mkdir()
        (path / "frames").mkdir()
        self._files = {
            name: (path / name).open("w") for name in ("odometry.tum", "scans.csv", "frames.csv")
        }
        self._rate = lidar_rate
        self._scans = ScanFiles(path / "scans", lidar_rate, RANGE_STEP)
        self._counts: dict[Stream, int] = dict.fromkeys(STREAMS, 0)
        self._stamps: tuple[float, float] | None = None
        self._intrinsics: Intrinsics | None = None

    def add(self, message: Message) -> None:
        """Store one more message."""
        if isinstance(message, Odometry):
            numbers = " ".join(repr(float(v)) for v in message.pose)
            self._files["odometry.tum"].write(f"{message.stamp!r} {numbers}\n")
            self._counts["odometry"] += 1
        elif isinstance(message, Scan):
            self._scans.write(self._counts["scans"], message)
            self._files["scans.csv"].write(f"{message.stamp!r}\n")
            self._counts["scans"] += 1
        else:
            self._write_frame(message)
        first = self._stamps[0] if self._stamps else message.stamp
        self._stamps = (first, message.stamp)

    def finish(self) -> None:
        """Close the files and write what they are."""
        for file in self._files.values():
            file.close()
        start, end = self._stamps or (self._info.start, self._info.start)
        info = self._info
        manifest = Manifest(
            name=info.name,
            start=start,
            duration=end - start,
            scans=self._counts["scans"],
            frames=self._counts["frames"],
            odometry=self._counts["odometry"],
            base_T_lidar=info.base_T_lidar,
            base_T_camera=info.base_T_camera,
            sensors=dict(info.sensors),
            intrinsics=self._intrinsics,
            lidar_rate=self._rate,
        )
        text = msgspec.json.format(msgspec.json.encode(manifest), indent=1)
        (self._path / "recording.json").write_bytes(text + b"\n")

    def _write_frame(self, frame: Frame) -> None:
        if self._intrinsics is not None and self._intrinsics != frame.intrinsics:
            raise InputError(
                self._path, "the camera's intrinsics change", "record one camera at a time"
            )
        self._intrinsics = frame.intrinsics
        base = self._path / "frames" / f"{self._counts['frames']:06d}"
        if frame.rgb is not None:
            write_rgb(base.with_suffix(".jpg"), frame.rgb)
        if frame.depth is not None:
            write_depth(base, frame.depth, *DISPARITY)
        self._files["frames.csv"].write(f"{frame.stamp!r}\n")
        self._counts["frames"] += 1


def _read_manifest(file: Path) -> Manifest:
    try:
        with file.open("rb") as stream:
            manifest = msgspec.json.decode(stream.read(1_000_000), type=Manifest)
    except OSError as error:
        raise InputError(file, f"cannot be read ({error.strerror})", "name a recording") from error
    except msgspec.MsgspecError as error:
        raise InputError(file, f"is damaged ({error})", "see docs/recordings.md") from error
    numbers = itertools.chain(
        (manifest.start, manifest.duration),
        manifest.base_T_lidar or (),
        manifest.base_T_camera or (),
        manifest.intrinsics or (),
        manifest.disparity,
    )
    if not all(np.isfinite(v) for v in numbers) or min(manifest.disparity) <= 0:
        raise InputError(file, "a number is not finite or not positive", "see docs/recordings.md")
    return manifest
