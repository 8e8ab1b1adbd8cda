"""What the brute force found, as text: it holds until the definition changes, and is dear.

It is kept under ``sources()``, so whatever is changed in the brute force or its definition asks for
it anew, and with a key of the two graphs, so that it is not taken for another case's. The verdict
is no part of it: that is judged again each time.
"""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Iterable
from pathlib import Path

import msgspec
import numpy as np

from situgraph.experiments.oracle.answer import Candidate, Found, Start
from situgraph.experiments.oracle.explained import Fitting, Motion
from situgraph.scenegraph.graph import SceneGraph

# Of no account for what is kept.
NO_PART = ("__init__.py", "cases.py", "comparison.py", "grids.py", "kept.py", "verdict.py")


class _Place(msgspec.Struct, frozen=True, array_like=True):
    """A placement: yaw, where the mean online room centre goes, the shift in height."""

    yaw: float
    x: float
    y: float
    z: float


class _Start(msgspec.Struct, frozen=True, array_like=True):
    place: _Place
    fitting: tuple[tuple[int, ...], ...]  # of each room pair: the rooms, then pairs of planes
    peak: int


class _Found(msgspec.Struct, frozen=True):
    graphs: str
    outside: float
    mirrored: float | None
    candidates: list[tuple[_Place, float]]
    peaks: list[_Place]
    feasible: list[_Start]


@functools.cache
def sources() -> str:
    """A key that changes with the sources of the brute force and its definition."""
    return sources_key(p for p in Path(__file__).parent.glob("*.py") if p.name not in NO_PART)


def sources_key(paths: Iterable[Path]) -> str:
    """A key that changes with the names and the content of files."""
    digest = hashlib.sha256()
    for path in sorted(paths):
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:16]


def to_text(found: Found, online: SceneGraph, prior: SceneGraph) -> str:
    """What was found as JSON."""
    numbers: dict[_Place, int] = {}
    starts = [
        _Start(
            _place(start.motion),
            _grouped(start.fitting),
            numbers.setdefault(_place(start.peak), len(numbers)),
        )
        for start in found.feasible
    ]
    kept = _Found(
        graphs=_key(online, prior),
        outside=found.outside,
        mirrored=found.mirrored,
        candidates=[(_place(k.motion), k.evidence) for k in found.candidates],
        peaks=list(numbers),
        feasible=starts,
    )
    return msgspec.json.encode(kept).decode()


def from_text(text: str, online: SceneGraph, prior: SceneGraph) -> Found | None:
    """What was kept, None when it is about other graphs."""
    kept = msgspec.json.decode(text, type=_Found)
    if kept.graphs != _key(online, prior):
        return None
    peaks = [_motion(place) for place in kept.peaks]
    return Found(
        candidates=tuple(Candidate(_motion(place), height) for place, height in kept.candidates),
        feasible=tuple(
            Start(_motion(start.place), _ungrouped(start.fitting), peaks[start.peak])
            for start in kept.feasible
        ),
        outside=kept.outside,
        mirrored=kept.mirrored,
    )


def _key(online: SceneGraph, prior: SceneGraph) -> str:
    digest = hashlib.sha256()
    for graph in (online, prior):
        digest.update(msgspec.json.encode(graph) + b"\0")
    return digest.hexdigest()[:16]


def _place(at: Motion) -> _Place:
    x, y = at.point.tolist()
    return _Place(float(at.yaw), x, y, float(at.z))


def _motion(place: _Place) -> Motion:
    return Motion(place.yaw, np.array([place.x, place.y]), place.z)


def _grouped(fitting: frozenset[Fitting]) -> tuple[tuple[int, ...], ...]:
    rooms: dict[tuple[int, int], list[int]] = {}
    for r, a, i, j in sorted(fitting):
        rooms.setdefault((r, a), []).extend((i, j))
    return tuple((*pair, *planes) for pair, planes in rooms.items())


def _ungrouped(groups: tuple[tuple[int, ...], ...]) -> frozenset[Fitting]:
    return frozenset(
        (r, a, i, j) for r, a, *planes in groups for i, j in zip(planes[::2], planes[1::2])
    )
