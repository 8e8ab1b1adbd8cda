"""Objects seen over many keyframes: which observation is which object (paper, 'Data association').

An observation that overlaps an object of its category, ellipsoid against ellipsoid, is that object:
the points are merged and the ellipsoid is fitted anew. Each object's points are kept in the frame
of the keyframe that saw it first, so that it moves when the optimiser corrects that keyframe.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from situgraph.geometry import ellipsoids
from situgraph.geometry.poses import Array
from situgraph.objects.clusters import clusters, pooled, thin
from situgraph.objects.config import ObjectsConfig
from situgraph.objects.relations import TWO_SIDED
from situgraph.scenegraph.graph import Ellipsoid, Object

FRAMES = 64  # latest frames remembered of each object, to count those that two pieces share


@dataclass(frozen=True, eq=False)
class Observation:
    """One cluster of one category as a keyframe saw it: points (n, 3) in the keyframe's frame."""

    category: str
    score: float
    points: Array


@dataclass(eq=False)
class Track:
    """One object: its points in the frame of its anchor keyframe, and how often it was seen.

    ``hits`` (n,) counts the frames that saw each point; ``seen`` those that saw any of it, of which
    ``frames`` are the latest, and ``due`` of the ``expected`` ones. ``eye`` (3,) is where the
    camera was that saw it from nearest, in the frame of the anchor.
    """

    number: int
    category: str
    anchor: str
    points: Array
    hits: Array
    seen: int = 0
    expected: int = 0
    score: float = 0.0
    frames: tuple[int, ...] = ()
    due: tuple[int, ...] = ()
    eye: Array = field(default_factory=lambda: np.zeros(3))
    center: Array = field(default_factory=lambda: np.zeros(3))
    shape: Array = field(default_factory=lambda: np.eye(3))

    @property
    def confidence(self) -> float:
        """See ``confidence``."""
        return confidence(self.seen, self.expected, self.score)

    def core(self, share: float) -> NDArray[np.bool_]:
        """Which points were seen at least ``share`` as often as those that were seen most."""
        core: NDArray[np.bool_] = self.hits >= share * np.quantile(self.hits, 0.9)
        return core


def confidence(seen: int, expected: int, score: float) -> float:
    """Mean of the Beta posterior of being seen when it should be, times the mean score.

    ``score`` is the sum of the scores of the ``seen`` sightings.
    """
    return (1.0 + seen) / (2.0 + max(seen, expected)) * score / seen


class Sighted(Protocol):
    """How often something was ``seen``, the latest of these ``frames``, the sum of its scores; how
    often it was ``expected``, and the latest frames in which it was ``due``.
    """  # noqa: D205

    @property
    def seen(self) -> int: ...  # noqa: D102

    @property
    def expected(self) -> int: ...  # noqa: D102

    @property
    def score(self) -> float: ...  # noqa: D102

    @property
    def frames(self) -> tuple[int, ...]: ...  # noqa: D102

    @property
    def due(self) -> tuple[int, ...]: ...  # noqa: D102


def sightings(
    first: Sighted, second: Sighted
) -> tuple[int, int, float, tuple[int, ...], tuple[int, ...]]:
    """``seen``, ``expected``, ``score``, ``frames`` and ``due`` of two that are one thing.

    Its pieces in one frame are one sighting, else they would confirm each other; and a frame that
    should have shown either of them and did not is a miss.
    """
    seen = _counted(first.seen, second.seen, first.frames, second.frames)
    expected = _counted(first.expected, second.expected, first.due, second.due)
    score = (first.score + second.score) * seen / (first.seen + second.seen)
    return (
        seen,
        expected,
        score,
        _latest(first.frames, second.frames),
        _latest(first.due, second.due),
    )


def _counted(first: int, second: int, of_first: Sequence[int], of_second: Sequence[int]) -> int:
    """So many frames together; those that both have are known of the latest only."""
    return max(first + second - len(set(of_first) & set(of_second)), first, second)


def _latest(first: Sequence[int], second: Sequence[int]) -> tuple[int, ...]:
    return tuple(sorted({*first, *second})[-FRAMES:])


class ObjectMap:
    """Grows objects from observations; bounded by the objects there are, not by the frames."""

    def __init__(self, config: ObjectsConfig | None = None) -> None:
        """Start without objects."""
        self.config = config or ObjectsConfig()
        self._tracks: list[Track] = []
        self._poses: dict[str, Array] = {}
        self._next = 0
        self._frame = 0

    @property
    def tracks(self) -> tuple[Track, ...]:
        """All objects, also those of little confidence."""
        return tuple(self._tracks)

    def observations(
        self, clouds: Mapping[str, Sequence[tuple[float, Array]]]
    ) -> list[Observation]:
        """Clusters of the labelled points of one keyframe: category -> (score, points (n, 3))."""
        found = []
        for category in sorted(clouds):
            parts = clouds[category]
            points = thin(np.concatenate([p for _, p in parts]), self.config.voxel)
            for group in clusters(points, self.config.cluster_gap, self.config.min_points):
                found.append(Observation(category, _score(group, parts), group))
        return found

    def add(
        self,
        keyframe: str,
        pose: Array,
        observations: Sequence[Observation],
        eye: Array | None = None,
    ) -> list[Track]:
        """Take in what a keyframe at ``pose`` (4, 4) saw; the objects it became, in order.

        ``eye`` (3,) is the camera's place in the keyframe's frame; None: the keyframe's own.
        """
        self._poses[keyframe] = np.asarray(pose, dtype=float)
        self._frame += 1
        became = []
        for observation in observations:
            hits = np.ones(len(observation.points))
            new = Track(self._next, observation.category, keyframe, observation.points, hits)
            new.seen, new.score, new.frames = 1, observation.score, (self._frame,)
            new.eye = np.zeros(3) if eye is None else np.asarray(eye, dtype=float)
            self._next += 1
            self._refit(new)
            became.append(self._merge(new))
        self._forget_poses()
        return list(dict.fromkeys(became))

    def expect(self, tracks: Sequence[Track]) -> None:
        """Count objects that a frame should have shown: unseen ones lose confidence, and in the
        end are forgotten.
        """  # noqa: D205
        for track in tracks:
            track.expected += 1
            track.due = (*track.due, self._frame)[-FRAMES:]
        self._forget()

    def correct(self, poses: Mapping[str, Array]) -> None:
        """Move objects with their anchors' corrected poses (4, 4); merge what now meets."""
        for key in self._poses.keys() & poses.keys():
            self._poses[key] = np.asarray(poses[key], dtype=float)
        for track in self._tracks:
            self._refit(track)
        for track in tuple(self._tracks):
            if track in self._tracks:
                self._tracks.remove(track)
                self._merge(track)

    def nodes(self) -> tuple[tuple[Track, Object], ...]:
        """The objects of enough confidence with their scene-graph nodes, without relations."""
        return tuple((t, _node(t)) for t in self._tracks if self._sure(t))

    def objects(self) -> tuple[Object, ...]:
        """The scene-graph nodes alone."""
        return tuple(node for _, node in self.nodes())

    def points(self, track: Track) -> Array:
        """The points (n, 3) of an object in the map frame."""
        pose = self._poses[track.anchor]
        moved: Array = track.points @ pose[:3, :3].T + pose[:3, 3]
        return moved

    def _sure(self, track: Track) -> bool:
        c = self.config
        return track.confidence >= c.min_confidence and track.seen >= c.min_seen

    def eye(self, track: Track) -> Array:
        """Where in the map (3,) the camera was that saw an object from nearest."""
        pose = self._poses[track.anchor]
        place: Array = pose[:3, :3] @ track.eye + pose[:3, 3]
        return place

    def _merge(self, new: Track) -> Track:
        """Unite ``new`` with every object of its category that it overlaps, the oldest first."""
        while True:
            met = next((t for t in self._tracks if t is not new and self._meets(t, new)), None)
            if met is None:
                break
            older, younger = (met, new) if met.number < new.number else (new, met)
            self._tracks = [t for t in self._tracks if t is not met]
            self._absorb(older, younger)
            new = older
        self._tracks.append(new)
        self._tracks.sort(key=lambda t: t.number)
        return new

    def _meets(self, first: Track, second: Track) -> bool:
        """Same category and a shared point; what stands free is grown, since each view shows only
        the side that it faces.
        """  # noqa: D205
        if first.category != second.category:
            return False
        grown = 0.0 if first.category in TWO_SIDED else self.config.merge_reach
        offset = second.center - first.center
        reach = np.sqrt(np.trace(first.shape)) + np.sqrt(np.trace(second.shape)) + 2.0 * grown
        if float(offset @ offset) > float(reach) ** 2:
            return False
        first_shape, second_shape = (_grown(t.shape, grown) for t in (first, second))
        return ellipsoids.overlap(offset, first_shape, second_shape)

    def _absorb(self, older: Track, younger: Track) -> None:
        change = np.linalg.solve(self._poses[older.anchor], self._poses[younger.anchor])
        moved = younger.points @ change[:3, :3].T + change[:3, 3]
        points, hits = pooled(
            np.concatenate([older.points, moved]),
            np.concatenate([older.hits, younger.hits]),
            self.config.voxel,
        )
        if len(points) > self.config.max_object_points:
            most = np.argsort(-hits, kind="stable")[: self.config.max_object_points]
            points, hits = points[np.sort(most)], hits[np.sort(most)]
        if _away(younger) < _away(older):
            older.eye = change[:3, :3] @ younger.eye + change[:3, 3]
        older.points, older.hits = points, hits
        older.seen, older.expected, older.score, older.frames, older.due = sightings(older, younger)
        self._refit(older)

    def _refit(self, track: Track) -> None:
        track.center, track.shape = ellipsoids.fit(
            self.points(track)[track.core(self.config.core_share)],
            self.config.ellipsoid_floor,
            self.config.stray_share,
        )

    def _forget(self) -> None:
        """Leave out what was not seen again where it should be, and the oldest of the unsure.

        Of the objects that were seen too seldom to be given out, those go that were not seen for
        longest: what is never expected again must not pile up either.
        """
        c = self.config
        kept = [t for t in self._tracks if t.confidence >= c.forget_confidence]
        unsure = sorted((t for t in kept if not self._sure(t)), key=lambda t: -t.frames[-1])
        gone = {t.number for t in unsure[c.max_unsure :]}
        if gone or len(kept) < len(self._tracks):
            self._tracks = [t for t in kept if t.number not in gone]
            self._forget_poses()

    def _forget_poses(self) -> None:
        used = {t.anchor for t in self._tracks}
        self._poses = {k: p for k, p in self._poses.items() if k in used}


def _away(track: Track) -> float:
    """Distance (m) of an object's points from the camera that saw it from nearest."""
    return float(np.linalg.norm(track.points.mean(axis=0) - track.eye))


def _score(group: Array, parts: Sequence[tuple[float, Array]]) -> float:
    """The best score of the masks (score, points) that a cluster's points (n, 3) came from."""
    low, high = group.min(axis=0), group.max(axis=0)
    held = [s for s, p in parts if ((p >= low) & (p <= high)).all(axis=1).any()]
    return max(held, default=max(s for s, _ in parts))


def _grown(shape: Array, by: float) -> Array:
    """The ellipsoid with semi-axes longer by ``by`` (m)."""
    if by == 0.0:
        return shape
    values, vectors = np.linalg.eigh(shape)
    out: Array = vectors @ np.diag((np.sqrt(values) + by) ** 2) @ vectors.T
    return out


def _node(track: Track) -> Object:
    axes, rotation = ellipsoids.axes_and_rotation(track.shape)
    a, b, c = (float(v) for v in axes)
    qx, qy, qz, qw = (float(v) for v in rotation)
    x, y, z = (float(v) for v in track.center)
    return Object(
        f"o{track.number}",
        track.category,
        (x, y, z),
        Ellipsoid((a, b, c), (qx, qy, qz, qw)),
        confidence=round(track.confidence, 4),
        attributes={"evidence": "vision", "seen": track.seen},
    )
