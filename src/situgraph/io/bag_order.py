"""Messages of several topics brought together: images in pairs, everything by its stamp."""

from __future__ import annotations

import heapq
from collections import deque
from collections.abc import Iterator
from typing import Any

import numpy as np

from situgraph.io.recording import Frame, Intrinsics, Message, Odometry, WarningLog

_WINDOW = 0.5  # s; messages are put in order within this
_PAIR = 0.02  # s; colour and depth nearer than this are one image
_PENDING = 30  # images that wait for their partner


class Pairs:
    """Joins colour and depth images of the same moment to frames."""

    def __init__(self, roles: set[str], intrinsics: Intrinsics, log: WarningLog) -> None:
        self._waiting: dict[str, deque[tuple[float, Any]]] = {r: deque() for r in roles}
        self._intrinsics = intrinsics
        self._log = log

    def add(self, role: str, stamp: float, image: Any) -> Iterator[Frame]:
        """Take one more image and give the frame it completes, if any."""
        other = "depth" if role == "rgb" else "rgb"
        if other not in self._waiting:
            yield self._frame(stamp, {role: image})
            return
        waiting = self._waiting[other]
        near = [i for i, (s, _) in enumerate(waiting) if abs(s - stamp) <= _PAIR]
        if not near:
            self._waiting[role].append((stamp, image))
            if len(self._waiting[role]) > _PENDING:
                self._drop(role)
            return
        for _ in range(near[0]):
            self._drop(other)
        _, partner = waiting.popleft()
        if image.shape[:2] != partner.shape[:2]:
            self._log.add(
                "images-not-aligned",
                f"at {stamp:.3f} s {role} is {image.shape[:2]} and {other} {partner.shape[:2]}; "
                "record depth aligned to colour",
            )
            return
        yield self._frame(stamp, {role: image, other: partner})

    def end(self) -> None:
        """Note the images that found no partner."""
        for role in self._waiting:
            while self._waiting[role]:
                self._drop(role)

    def _drop(self, role: str) -> None:
        stamp, _ = self._waiting[role].popleft()
        self._log.add(
            f"image-alone-{role}",
            f"the {role} image of {stamp:.3f} s has no partner within {_PAIR} s and is left out",
        )

    def _frame(self, stamp: float, images: dict[str, Any]) -> Frame:
        return Frame(stamp, images.get("rgb"), images.get("depth"), self._intrinsics)


def in_order(messages: Iterator[Message]) -> Iterator[Message]:
    """Messages by stamp as far as a window of half a second allows."""
    heap: list[tuple[float, int, int, Message]] = []
    newest = -np.inf
    for number, message in enumerate(messages):
        newest = max(newest, message.stamp)
        rank = 0 if isinstance(message, Odometry) else 1
        heapq.heappush(heap, (message.stamp, rank, number, message))
        while heap and heap[0][0] < newest - _WINDOW:
            yield heapq.heappop(heap)[3]
    while heap:
        yield heapq.heappop(heap)[3]
