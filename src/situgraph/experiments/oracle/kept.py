"""The brute force's answers as text: they hold until the definition changes, and are dear.

An answer is kept under ``sources()``, so whatever is changed in the brute force or its definition
asks for it anew, and with a key of the two graphs, so that it is not taken for another case's.
"""

from __future__ import annotations

import functools
import hashlib
from pathlib import Path

import msgspec
import numpy as np

from situgraph.experiments.oracle.answer import Answer, Candidate, Start
from situgraph.experiments.oracle.explained import Fitting, Motion
from situgraph.scenegraph.graph import SceneGraph

NO_PART = {"__init__.py", "cases.py", "comparison.py", "grids.py", "kept.py"}  # of an answer


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


class _Answer(msgspec.Struct, frozen=True):
    graphs: str
    verdict: str
    probability_outside: float
    outside: float
    mirrored: float | None
    solutions: int
    candidates: list[tuple[_Place, float, float]]
    peaks: list[_Place]
    feasible: list[_Start]


@functools.cache
def sources() -> str:
    """A key that changes with the sources of the brute force and its definition."""
    return sources_key(Path(__file__).parent, NO_PART)


def sources_key(folder: Path, left_out: frozenset[str] | set[str] = frozenset()) -> str:
    """A key that changes with the Python sources of a folder, but for those left out."""
    digest = hashlib.sha256()
    for path in sorted(folder.glob("*.py")):
        if path.name not in left_out:
            digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:16]


def to_text(answer: Answer, online: SceneGraph, prior: SceneGraph) -> str:
    """The answer as JSON."""
    numbers: dict[_Place, int] = {}
    starts = [
        _Start(
            _place(start.motion),
            _grouped(start.fitting),
            numbers.setdefault(_place(start.peak), len(numbers)),
        )
        for start in answer.feasible
    ]
    kept = _Answer(
        graphs=_key(online, prior),
        verdict=answer.verdict,
        probability_outside=answer.probability_outside,
        outside=answer.outside,
        mirrored=answer.mirrored,
        solutions=len(answer.solutions),
        candidates=[(_place(k.motion), k.evidence, k.probability) for k in answer.candidates],
        peaks=list(numbers),
        feasible=starts,
    )
    return msgspec.json.encode(kept).decode()


def from_text(text: str, online: SceneGraph, prior: SceneGraph) -> Answer | None:
    """The answer that was kept, None when it is one about other graphs."""
    kept = msgspec.json.decode(text, type=_Answer)
    if kept.graphs != _key(online, prior):
        return None
    candidates = tuple(Candidate(_motion(place), *rest) for place, *rest in kept.candidates)
    peaks = [_motion(place) for place in kept.peaks]
    return Answer(
        candidates=candidates,
        solutions=candidates[: kept.solutions],
        verdict=kept.verdict,
        probability_outside=kept.probability_outside,
        outside=kept.outside,
        mirrored=kept.mirrored,
        feasible=tuple(
            Start(_motion(start.place), _ungrouped(start.fitting), peaks[start.peak])
            for start in kept.feasible
        ),
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
