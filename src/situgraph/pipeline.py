"""The live system (paper, system overview): scans, images and odometry in, a located map out.

Scans make the map of walls, rooms and storeys; images add objects and their relations; after each
keyframe that changed what a match looks at, the map is matched with the plan. While a match is
adopted, plan and map are coupled, and the robot's pose in the building is known with each scan.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np
from numpy.typing import ArrayLike

from situgraph.config import Settings
from situgraph.coupling import Located, Locator, from_slam, locate, spread
from situgraph.geometry.poses import Array, pose_to_matrix
from situgraph.matching import Matcher, MatchingConfig, PlanIndex
from situgraph.objects.detections import Camera, Detector
from situgraph.objects.doorways import DOORWAY
from situgraph.objects.gaps import WallGap
from situgraph.objects.stage import ObjectStage, View
from situgraph.scenegraph.graph import SceneGraph, Warning
from situgraph.slam.gaps import doorways, without_leaves
from situgraph.slam.keyframes import Keyframe
from situgraph.slam.notices import Notices
from situgraph.slam.odometry import ScanOdometry
from situgraph.slam.slam import Slam

if TYPE_CHECKING:
    from situgraph.io.recording import Frame, Odometry, Scan
    from situgraph.matching import MatchResult
    from situgraph.matching.matcher import Semantics

MOVED = (0.01, 0.003)  # m, rad: keyframes corrected by less need not move their objects


class State(msgspec.Struct, frozen=True):
    """What is known at ``stamp`` (s).

    ``pose`` is base in the map; ``verdict`` is that of the last match, None before the first;
    ``solutions`` counts its placements, ``advice`` says what to look at to tell them apart;
    ``probability`` is that of the best one. ``place`` is base in the building while a match is
    adopted, else None; ``apart`` (m) is how far the placements lie apart that the walls allow then,
    0 where there is but one.
    """

    stamp: float
    pose: tuple[float, ...]
    keyframes: int
    rooms: int
    objects: int
    verdict: str | None = None
    solutions: int | None = None
    advice: str | None = None
    probability: float | None = None
    place: tuple[float, ...] | None = None
    apart: float | None = None


class Pipeline:
    """Feed it what a robot measures, in the order of the stamps; ask it anything at any time.

    Attributes:
        state: what is known now.
        graph: the S-Graph with objects and relations, as of the last keyframe that was matched.
        result: the last match; None without a plan or before the first room.
        locator: adopts and withdraws matches; None without a plan.
        located: the map in the building while a match is adopted, else None.
        history: the states in which a match was made, in order.
    """

    def __init__(
        self,
        plan: SceneGraph | PlanIndex | None = None,
        settings: Settings | None = None,
        detector: Detector | None = None,
        odometry: ScanOdometry | None = None,
        *,
        base_T_lidar: ArrayLike | None = None,
        base_T_camera: ArrayLike | None = None,
        semantics: Semantics = "likelihood",
    ) -> None:
        """Start with an empty map.

        Args:
            plan: the A-Graph to locate the robot in, or its index; None: only the map is made.
            settings: those of all stages.
            detector: finds objects in images; None: images are not looked at.
            odometry: registers scans in place of the one that the settings name.
            base_T_lidar: pose (7,) of the LiDAR in base; None: base is the LiDAR.
            base_T_camera: pose (7,) of the camera's optical frame in base; None: no image is used.
            semantics: how the match uses objects.
        """
        self.settings = settings or Settings()
        self.slam = Slam(self.settings.slam, base_T_lidar, odometry)
        self.objects = ObjectStage(detector, self.settings.objects)
        self.matcher = (
            None
            if plan is None
            else Matcher(
                plan,
                semantics=semantics,
                config=as_passed(self.settings) if detector is None else self.settings.matching,
            )
        )
        self.locator = (
            None
            if self.matcher is None
            else Locator(
                self.matcher,
                self.matcher.index.prior,
                self.settings.coupling,
                self.settings.matching,
            )
        )
        self.located: Located | None = None
        self._camera = None if base_T_camera is None else pose_to_matrix(base_T_camera)
        self._waiting: deque[Frame] = deque(maxlen=self.settings.slam.images.waiting)
        self._last_image = -np.inf
        self._corrected = np.empty((0, 4, 4))
        self._matched: tuple[Any, ...] = ()
        self._notices = Notices()
        self._seconds = {"objects": 0.0, "graph out": 0.0, "matching": 0.0, "coupling": 0.0}
        self.state = State(0.0, (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0), 0, 0, 0)
        self.graph = SceneGraph(kind="online")
        self.result: MatchResult | None = None
        self.history: list[State] = []

    def feed(
        self,
        scan: Scan | None = None,
        image: Frame | None = None,
        odometry: Odometry | None = None,
    ) -> State:
        """Take in one turn of the LiDAR, an RGB-D image, a pose of the robot's own odometry."""
        if odometry is not None:
            self.slam.feed_odometry(odometry.stamp, odometry.pose)
        if image is not None:
            self._wait(image)
        if scan is not None:
            keyframe = self.slam.feed_scan(scan.stamp, scan.points, scan.times)
            self._look(scan.stamp)
            if keyframe is not None:
                self._locate(keyframe)
            self.state = msgspec.structs.replace(
                self.state, stamp=scan.stamp, pose=_row(self.slam.pose), place=self._place()
            )
        return self.state

    def finish(self) -> State:
        """Bring graph and match up to date after the last message."""
        if self.slam.keyframes:
            self._matched = ()
            self._locate(self.slam.keyframes[-1])
        return self.state

    @property
    def warnings(self) -> tuple[Warning, ...]:
        """What was odd in the input, and why free space is no room and what was seen no object."""
        reasons = (Warning(r.code, r.sentence) for r in self.slam.reasons)
        return (*self.slam.warnings, *self._notices.all(), *reasons, *self.objects.left_out)

    @property
    def seconds(self) -> dict[str, float]:
        """Time spent by stage so far."""
        return {**self.slam.seconds, **self._seconds}

    def _wait(self, image: Frame) -> None:
        """Keep an image until the next scan tells where it was taken."""
        c = self.settings.slam.images
        if self.objects.detector is None or self._camera is None:
            return
        if image.rgb is None or image.depth is None:
            self._notices.add("image-incomplete", "images without colour or depth are not used")
        elif 0.0 <= image.stamp - self._last_image < c.period:
            return
        elif float(image.rgb[::8, ::8].mean()) < c.dark:
            self._notices.add("image-dark", f"the image at {image.stamp:.3f} s is dark; left out")
        else:
            if len(self._waiting) == self._waiting.maxlen:
                self._notices.add("image-without-scan", "images came without scans; left out")
            self._waiting.append(image)
            self._last_image = image.stamp

    def _look(self, stamp: float) -> None:
        """Detect objects in the images that a scan now allows to place."""
        while self._waiting and self._waiting[0].stamp <= stamp:
            image = self._waiting.popleft()
            place = self.slam.moment(image.stamp)
            if place is None:
                continue
            number, motion = place
            with self._timed("objects"):
                self.objects.feed(self._view(image, number, motion))

    def _view(self, image: Frame, number: int, motion: Array) -> View:
        assert image.rgb is not None
        assert image.depth is not None
        assert self._camera is not None
        return View(
            keyframe=f"k{number}",
            stamp=image.stamp,
            rgb=image.rgb,
            depth=image.depth,
            camera=Camera(*image.intrinsics),
            pose=self.slam.graph.pose(number),
            keyframe_T_camera=motion @ self._camera,
        )

    def _locate(self, keyframe: Keyframe) -> None:
        """Match the map with the plan, where rooms or objects are not those of the last match."""
        with self._timed("graph out"):
            self._move_objects()
            graph = self.slam.scene_graph()
            graph = self.objects.annotated(graph, self.slam.places(), self.wall_gaps())
            seen = (self.slam.changes, _contents(graph))
        if seen != self._matched:
            self._matched = seen
            self.graph = graph
            if self.locator is not None and self.graph.rooms:
                with self._timed("matching"):
                    self.result = self.locator.update(self.graph, keyframe.stamp)
                with self._timed("coupling"):
                    self._couple()
            self.state = self._state(keyframe)
            self.history.append(self.state)
        else:
            self.state = self._state(keyframe)

    def _couple(self) -> None:
        """The map in the building, as the adopted match has it now."""
        assert self.locator is not None
        assert self.matcher is not None
        pairs = self.locator.pairs
        if pairs is None:
            self.located = None
            return
        self.located = locate(
            self.graph,
            self.matcher.index.prior,
            pairs,
            evidence=from_slam(self.slam.graph, self.graph),
            looked_for=() if self.objects.detector is None else None,
            missed=self.objects.missed,
            lines=self.locator.lines,
            found=self.locator.readings,
            config=self.settings.coupling,
        )

    def _place(self) -> tuple[float, ...] | None:
        """Base in the building now."""
        if self.located is None:
            return None
        return _row(self.located.carrier.latest(self.slam.pose))

    def wall_gaps(self) -> list[WallGap]:
        """Where the LiDAR saw openings in the walls of each storey."""
        c, found = self.settings.slam, []
        for storey in self.slam.storeys.storeys:
            walls = [p for p in self.slam.planes.on(storey.number) if p.certain(c.map)]
            openings = doorways(without_leaves(walls, c.rooms), c.rooms, walls)
            found += [WallGap(gap.ends, storey.elevation) for gap in openings]
        return found

    def _move_objects(self) -> None:
        """Objects follow the keyframes that saw them, once these moved by enough."""
        if not self.objects.map.tracks:
            return
        poses = self.slam.graph.poses([k.number for k in self.slam.keyframes])
        known = len(self._corrected)
        shift = np.abs(poses[:known] - self._corrected)
        if (shift[:, :3, 3] > MOVED[0]).any() or (shift[:, :3, :3] > MOVED[1]).any():
            self.objects.correct({f"k{n}": pose for n, pose in enumerate(poses)})
            self._corrected = poses
        else:
            self._corrected = np.concatenate([self._corrected, poses[known:]])

    def _state(self, keyframe: Keyframe) -> State:
        result = self.result
        return State(
            stamp=keyframe.stamp,
            pose=_row(self.slam.pose),
            keyframes=len(self.slam.keyframes),
            rooms=len(self.graph.rooms),
            objects=len(self.graph.objects),
            verdict=None if result is None else result.verdict,
            solutions=None if result is None else result.count,
            advice=None if result is None or result.unique else _advice(result),
            probability=None if result is None or not result.best else result.best.probability,
            place=self._place(),
            apart=None if self.located is None else spread(self.located.readings),
        )

    @contextmanager
    def _timed(self, stage: str) -> Iterator[None]:
        start = time.perf_counter()
        try:
            yield
        finally:
            self._seconds[stage] += time.perf_counter() - start


def as_passed(settings: Settings) -> MatchingConfig:
    """How doors are missed without a camera: most are not passed. What was set by hand stays."""
    matching = settings.matching
    rates = msgspec.structs.replace(
        matching.rates_of(DOORWAY), miss=settings.objects.doorway_not_passed
    )
    told = {DOORWAY: rates, **matching.category_rates}
    return msgspec.structs.replace(matching, category_rates=told)


def _row(pose: Array) -> tuple[float, ...]:
    return tuple(pose.tolist())


def _contents(graph: SceneGraph) -> list[tuple[str, tuple[str, ...], tuple[str, ...]]]:
    """What a match counts: each object's category, rooms and planes."""
    return sorted((o.category, o.rooms, o.planes) for o in graph.objects)


def _advice(result: MatchResult) -> str | None:
    """The observation that would best tell the placements apart, in words."""
    if not result.disambiguation:
        return None
    hint = result.disambiguation[0]
    where = f" of room {hint['in_room']}" if hint.get("in_room") else ""
    wall = f" on wall {hint['on_plane']}" if hint.get("on_plane") else ""
    return f"look for a {hint['look_for']}{wall}{where}"
