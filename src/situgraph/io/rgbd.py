"""RGB-D folders in the layout of the TUM benchmark: ``rgb.txt`` and ``depth.txt`` list the images.

A line is ``stamp file``. Beside them: the camera's intrinsics in ``intrinsics.txt`` (also
``calibration.txt``, ``camera.txt``), four or five numbers ``fx fy cx cy [steps per metre]``; and
its trajectory in ``groundtruth.txt`` (also ``poses.txt``, ``trajectory.txt``), TUM lines of the
optical frame in a frame with z up, which become the odometry. Depth is 5000 steps a metre unless
the fifth number says otherwise.
"""

from __future__ import annotations

import bisect
import heapq
from collections.abc import Collection, Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from situgraph.errors import InputError
from situgraph.geometry.poses import Array, matrix_to_pose, pose_to_matrix
from situgraph.io.bag_topics import FORWARD
from situgraph.io.images import read_depth, read_rgb
from situgraph.io.recording import (
    STREAMS,
    Frame,
    Intrinsics,
    Message,
    Odometry,
    RecordingInfo,
    Stream,
    WarningLog,
)
from situgraph.io.tum import read_tum
from situgraph.scenegraph.graph import Warning

STEPS = 5000.0  # a metre, in the benchmark's depth images
_PAIR = 0.02  # s; colour and depth nearer than this are one image
_MAX_BYTES = 100_000_000
_PLAUSIBLE = (0.1, 60.0)  # m; the median depth of a room lies between
_INTRINSICS = ("intrinsics.txt", "calibration.txt", "camera.txt")
_POSES = ("groundtruth.txt", "poses.txt", "trajectory.txt")


class RgbdRecording:
    """A camera carried by hand: frames, and its poses as odometry.

    Raises:
        InputError: no images, no intrinsics, or lists that cannot be read.
    """

    def __init__(self, path: str | Path) -> None:
        self._path = Path(path)
        self._opening = WarningLog()
        self._log = WarningLog()
        rgb, depth = (self._list(name) for name in ("rgb.txt", "depth.txt"))
        self._pairs = self._paired(rgb, depth)
        if not self._pairs:
            raise InputError(path, "lists no images", "expected rgb.txt and depth.txt with lines")
        self._intrinsics, self._steps = self._read_intrinsics()
        self._stamps, self._poses = self._read_poses()
        start, end = self._pairs[0][0], self._pairs[-1][0]
        counts: dict[Stream, int] = {
            "scans": 0,
            "frames": len(self._pairs),
            "odometry": len(self._stamps),
        }
        sensors = {"camera": f"RGB-D, depth in {self._steps:g} steps a metre"}
        self.info = RecordingInfo(
            self._path.name, "RGB-D folder", start, end - start, counts, None, FORWARD, sensors
        )

    @property
    def warnings(self) -> tuple[Warning, ...]:
        """What was odd in the lists, and in the images of the last pass."""
        return (*self._opening.all(), *self._log.all())

    def messages(self, streams: Collection[Stream] = STREAMS) -> Iterator[Message]:
        """See ``Recording.messages``; an image that cannot be read is left out with a warning."""
        self._log.clear()
        parts: list[Iterator[Message]] = []
        if "odometry" in streams:
            parts.append(Odometry(float(t), p) for t, p in zip(self._stamps, self._poses))
        if "frames" in streams:
            parts.append(self._frames())
        return heapq.merge(*parts, key=lambda m: m.stamp)

    def _frames(self) -> Iterator[Frame]:
        for stamp, rgb_file, depth_file in self._pairs:
            try:
                rgb = read_rgb(rgb_file) if rgb_file else None
                depth = read_depth(depth_file, 1.0 / self._steps) if depth_file else None
            except InputError as error:
                self._log.add("image-unreadable", str(error))
                continue
            if rgb is not None and depth is not None and rgb.shape[:2] != depth.shape:
                self._log.add(
                    "images-not-aligned",
                    f"{depth_file}: depth is {depth.shape} and colour {rgb.shape[:2]}; register "
                    "depth to colour",
                )
                continue
            if depth is not None:
                self._check_scale(depth, depth_file)
            yield Frame(stamp, rgb, depth, self._intrinsics)

    def _check_scale(self, depth: NDArray[np.float32], file: Path | None) -> None:
        seen = depth[depth > 0]
        if len(seen) and not _PLAUSIBLE[0] <= float(np.median(seen)) <= _PLAUSIBLE[1]:
            self._log.add(
                "depth-scale",
                f"{file}: median depth {float(np.median(seen)):.3g} m with {self._steps:g} steps a "
                "metre; give the right number as the fifth in intrinsics.txt",
            )

    def _list(self, name: str) -> list[tuple[float, Path]]:
        """Stamps and files of a list, in order; no file leads out of the folder."""
        file = self._path / name
        if not file.is_file():
            self._opening.add("list-missing", f"{file}: there is no such list")
            return []
        if file.stat().st_size > _MAX_BYTES:
            raise InputError(file, f"larger than {_MAX_BYTES} bytes", "is it a list of images?")
        found = []
        root = self._path.resolve()
        for number, line in enumerate(file.read_text(errors="replace").splitlines(), start=1):
            words = line.split(maxsplit=1)
            if not words or words[0].startswith("#"):
                continue
            try:
                stamp, target = float(words[0]), (self._path / words[1].strip()).resolve()
            except (ValueError, IndexError, OSError):
                stamp, target = np.nan, root
            if not np.isfinite(stamp) or root not in target.parents:
                self._opening.add("list-line", f"{file}, line {number}: {line[:60]!r} is left out")
                continue
            found.append((stamp, target))
        return sorted(found, key=lambda entry: entry[0])

    def _paired(
        self, rgb: list[tuple[float, Path]], depth: list[tuple[float, Path]]
    ) -> list[tuple[float, Path | None, Path | None]]:
        """Colour images with the nearest depth image; alone where there is only one list."""
        if not rgb or not depth:
            only = [(t, f, None) for t, f in rgb] + [(t, None, f) for t, f in depth]
            return list(only)
        stamps = [t for t, _ in depth]
        pairs: list[tuple[float, Path | None, Path | None]] = []
        for stamp, file in rgb:
            near = bisect.bisect_left(stamps, stamp)
            options = [i for i in (near - 1, near) if 0 <= i < len(stamps)]
            best = min(options, key=lambda i: abs(stamps[i] - stamp))
            if abs(stamps[best] - stamp) <= _PAIR:
                pairs.append((stamp, file, depth[best][1]))
            else:
                self._opening.add(
                    "image-alone",
                    f"{file.name} of {stamp:.3f} s has no depth within {_PAIR} s and is left out",
                )
        return pairs

    def _read_intrinsics(self) -> tuple[Intrinsics, float]:
        file = next((f for n in _INTRINSICS if (f := self._path / n).is_file()), None)
        if file is None:
            raise InputError(
                self._path,
                "has no intrinsics",
                "add intrinsics.txt with fx fy cx cy and the depth steps a metre",
            )
        text = file.read_bytes()[:10_000].decode("utf-8", "replace")
        rows = [line for line in text.splitlines() if not line.lstrip().startswith("#")]
        try:
            numbers = [float(w) for w in " ".join(rows).replace(",", " ").split()]
        except ValueError:
            numbers = []
        good = len(numbers) in (4, 5, 9) and np.isfinite(numbers).all()
        if len(numbers) == 9:  # a 3x3 matrix by rows
            numbers = [numbers[0], numbers[4], numbers[2], numbers[5]]
        if not good or min(numbers[0], numbers[1], numbers[-1]) <= 0:
            raise InputError(file, "is not fx fy cx cy [steps]", "write four or five numbers")
        return Intrinsics(*numbers[:4]), numbers[4] if len(numbers) == 5 else STEPS

    def _read_poses(self) -> tuple[Array, Array]:
        """The camera's trajectory as one of base: x ahead, z up."""
        file = next((f for n in _POSES if (f := self._path / n).is_file()), None)
        if file is None:
            self._opening.add(
                "no-poses", f"{self._path}: no groundtruth.txt, so there is no odometry"
            )
            return np.zeros(0), np.zeros((0, 7))
        stamps, poses = read_tum(file)
        base = pose_to_matrix(poses) @ np.linalg.inv(pose_to_matrix(FORWARD))
        order = np.argsort(stamps, kind="stable")
        return stamps[order], matrix_to_pose(base)[order]
