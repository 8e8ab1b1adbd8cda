"""Folders of keyframes as S-Graphs+ dumps them: ``000007/data`` and ``000007/cloud.pcd``.

``data`` is text: a stamp, two 4x4 matrices in the map frame (``estimate`` is that system's answer,
``odom`` its odometry), a few numbers. ``cloud.pcd`` holds points in the robot's frame, already
merged and thinned, so they carry neither times nor rings.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from pathlib import Path

import numpy as np

from situgraph.errors import InputError
from situgraph.geometry.poses import Array, matrix_to_pose
from situgraph.io.pcd import read_pcd
from situgraph.io.recording import (
    IDENTITY,
    STREAMS,
    Message,
    Odometry,
    RecordingInfo,
    Scan,
    Stream,
    WarningLog,
)
from situgraph.scenegraph.graph import Warning

_MAX_TEXT = 100_000  # bytes of a data file: it is a page
_SKEW = 1e-2  # how far a rotation matrix may be from one, after printing with six digits


class KeyframeRecording:
    """A recording of one scan and one odometry pose a keyframe."""

    def __init__(self, path: str | Path) -> None:
        self._path = Path(path)
        self._log = WarningLog()
        folders = sorted(p.parent for p in self._path.glob("[0-9]*/cloud.pcd"))
        if not folders:
            raise InputError(path, "holds no keyframes", "expected folders like 000000/cloud.pcd")
        entries = [(_read_data(f / "data"), f) for f in folders]
        self._entries = sorted(entries, key=lambda e: e[0][0])
        stamps = [e[0][0] for e in self._entries]
        counts: dict[Stream, int] = {"scans": len(stamps), "frames": 0, "odometry": len(stamps)}
        self.info = RecordingInfo(
            self._path.name,
            "S-Graphs keyframes",
            stamps[0],
            stamps[-1] - stamps[0],
            counts,
            IDENTITY,
            sensors={"lidar": "one merged cloud a keyframe", "odometry": "of the other system"},
        )

    @property
    def warnings(self) -> tuple[Warning, ...]:
        """Keyframes that could not be read."""
        return self._log.all()

    def messages(self, streams: Collection[Stream] = STREAMS) -> Iterator[Message]:
        """See ``Recording.messages``."""
        self._log.clear()
        for (stamp, odom, _), folder in self._entries:
            if "odometry" in streams:
                yield Odometry(stamp, odom)
            if "scans" in streams:
                try:
                    points, intensity = read_pcd(folder / "cloud.pcd")
                except InputError as error:
                    self._log.add("cloud-unreadable", str(error))
                    continue
                finite = np.isfinite(points).all(axis=1)
                if not finite.all():
                    self._log.add(
                        "points-not-finite", f"{folder.name}: {(~finite).sum()} points left out"
                    )
                yield Scan(
                    stamp,
                    points[finite],
                    intensity=None if intensity is None else intensity[finite],
                )

    def estimates(self) -> tuple[Array, Array]:
        """Stamps (n,) and poses (n, 7) that the other system estimated: for comparison only."""
        stamps = np.array([e[0][0] for e in self._entries])
        return stamps, np.array([e[0][2] for e in self._entries])


def _read_data(file: Path) -> tuple[float, Array, Array]:
    """Stamp (s), odometry pose (7,) and estimated pose (7,) of a keyframe."""
    try:
        with file.open("rb") as stream:
            text = stream.read(_MAX_TEXT + 1)
    except OSError as error:
        raise InputError(
            file, f"cannot be read ({error.strerror})", "see docs/recordings.md"
        ) from error
    if len(text) > _MAX_TEXT:
        raise InputError(file, "is too long", "expected a stamp and two matrices")
    words = text.decode("utf-8", "replace").split()
    stamp = _numbers(file, words, "stamp", 1)
    odom = _matrix(file, words, "odom")
    # Only for comparison, so a dump without it is as good.
    estimate = _matrix(file, words, "estimate") if "estimate" in words else odom
    return float(stamp[0]), odom, estimate


def _matrix(file: Path, words: list[str], name: str) -> Array:
    m = _numbers(file, words, name, 16).reshape(4, 4)
    turn = m[:3, :3]
    if np.abs(turn @ turn.T - np.eye(3)).max() > _SKEW or np.linalg.det(turn) < 0:
        raise InputError(file, f"{name} is not a rigid motion", "expected a 4x4 matrix")
    return matrix_to_pose(m)


def _numbers(file: Path, words: list[str], name: str, count: int) -> Array:
    try:
        at = words.index(name) + 1
        found = np.array([float(w) for w in words[at : at + count]])
    except ValueError as error:
        raise InputError(
            file, f"no {name} with {count} numbers", "see docs/recordings.md"
        ) from error
    if len(found) < count or not np.isfinite(found).all():
        raise InputError(file, f"no {name} with {count} numbers", "see docs/recordings.md")
    return found
