"""A recording with something wrong in it: what estimators must survive."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from situgraph.geometry.poses import matrix_to_pose, pose_to_matrix
from situgraph.io.recording import (
    STREAMS,
    Frame,
    Message,
    Odometry,
    Recording,
    RecordingInfo,
    Scan,
    Stream,
)
from situgraph.scenegraph.graph import Warning

Change = Callable[[Message, float, np.random.Generator], Message | None]
BURSTS = (0.3, 0.6)  # shares of the log at which two seconds of scans are lost
JUMP = 0.5  # m
BROKEN = 0.02  # share of points that are NaN or infinite


class Faulty:
    """A recording whose messages go through ``change``; everything random comes from ``seed``.

    ``change(message, share, rng)`` gives a message or None; ``share`` (0..1) is how much of the
    log lies before it.
    """

    def __init__(self, recording: Recording, change: Change, seed: int = 0) -> None:
        """Change ``recording`` as it is read."""
        self._recording = recording
        self._change = change
        self._seed = seed

    @property
    def info(self) -> RecordingInfo:
        """What the log claims to hold."""
        return self._recording.info

    @property
    def warnings(self) -> tuple[Warning, ...]:
        """What the reader noticed."""
        return self._recording.warnings

    def messages(self, streams: Collection[Stream] = STREAMS) -> Iterator[Message]:
        """See ``Recording.messages``."""
        rng = np.random.default_rng([self._seed, 4711])
        start, duration = self.info.start, max(self.info.duration, 1e-9)
        for message in self._recording.messages(streams):
            changed = self._change(message, (message.stamp - start) / duration, rng)
            if changed is not None:
                yield changed


def thinned(message: Message, share: float, rng: np.random.Generator) -> Message | None:
    """5 % of the scans are missing."""
    return None if isinstance(message, Scan) and rng.random() < 0.05 else message


def bursts(seconds: float, duration: float) -> Change:
    """Twice all scans of so many ``seconds`` are missing, of a log that lasts ``duration``."""

    def change(message: Message, share: float, rng: np.random.Generator) -> Message | None:
        lost = any(0.0 <= (share - b) * duration < seconds for b in BURSTS)
        return None if lost and isinstance(message, Scan) else message

    return change


def jump(message: Message, share: float, rng: np.random.Generator) -> Message | None:
    """Half way, the odometry is suddenly half a metre farther."""
    if share < 0.5 or not isinstance(message, Odometry):
        return message
    moved = pose_to_matrix(message.pose)
    moved[:3, 3] += moved[:3, 0] * JUMP
    return Odometry(message.stamp, matrix_to_pose(moved))


class Corrupt:
    """One scan in the middle of the log is noise, and the next has the wrong shape."""

    def __init__(self) -> None:
        """Nothing is corrupted yet."""
        self._done = 0

    def __call__(self, message: Message, share: float, rng: np.random.Generator) -> Message | None:
        """Corrupt the two scans after the middle."""
        if share < 0.5 or self._done >= 2 or not isinstance(message, Scan):
            return message
        self._done += 1
        if self._done == 2:
            return replace(message, points=message.points[:, :2])
        noise = rng.normal(0.0, 1e6, message.points.shape).astype(np.float32)
        return replace(message, points=noise)


class Dark:
    """One image in the middle of the log is black."""

    def __init__(self) -> None:
        """Every image is still as it was."""
        self._done = False

    def __call__(self, message: Message, share: float, rng: np.random.Generator) -> Message | None:
        """Blacken the first image after the middle."""
        if share < 0.5 or self._done or not isinstance(message, Frame) or message.rgb is None:
            return message
        self._done = True
        return replace(message, rgb=np.zeros_like(message.rgb))


def backwards(message: Message, share: float, rng: np.random.Generator) -> Message | None:
    """Some scans and poses are stamped a second too early."""
    if isinstance(message, Frame) or rng.random() > 0.02:
        return message
    return replace(message, stamp=message.stamp - 1.0)


def not_finite(message: Message, share: float, rng: np.random.Generator) -> Message | None:
    """Some points of each scan are NaN or infinite, and so is now and then an odometry pose."""
    if isinstance(message, Odometry) and rng.random() < 0.01:
        return Odometry(message.stamp, np.full(7, np.nan))
    if not isinstance(message, Scan):
        return message
    points = message.points.copy()
    bad = rng.random(len(points)) < BROKEN
    points[bad] = rng.choice([np.nan, np.inf, -np.inf], (int(bad.sum()), 3)).astype(np.float32)
    return replace(message, points=points)


# name -> how to make the change for a recording, and the warnings that must tell of it
FAULTS: Mapping[str, tuple[Callable[[RecordingInfo], Any], tuple[str, ...]]] = {
    "5 % of scans dropped": (lambda info: thinned, ("scans-missing",)),
    "bursts of 2 s lost": (lambda info: bursts(2.0, info.duration), ("scans-missing",)),
    "odometry jumps 0.5 m": (lambda info: jump, ("odometry-jump",)),
    "corrupt scans": (lambda info: Corrupt(), ("scan-empty", "scan-odd")),
    "a dark image": (lambda info: Dark(), ("image-dark",)),
    "stamps backwards": (
        lambda info: backwards, ("scan-out-of-order", "odometry-out-of-order"),
    ),
    "NaN and infinite points": (
        lambda info: not_finite, ("points-not-finite", "odometry-not-finite"),
    ),
}  # fmt: skip


def faulty(recording: Recording, name: str, seed: int = 0) -> Faulty:
    """``recording`` with the fault of that name."""
    make, _ = FAULTS[name]
    return Faulty(recording, make(recording.info), seed)
