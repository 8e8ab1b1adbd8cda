"""A drive through a building as a recording: streamed, nothing stored, truth apart."""

from __future__ import annotations

import heapq
import math
from collections.abc import Collection, Iterator, Sequence

import numpy as np

from situgraph.errors import InputError
from situgraph.geometry.poses import Array, Placement, matrix_to_pose, rotation2
from situgraph.io.recording import (
    STREAMS,
    Frame,
    Message,
    Odometry,
    RecordingInfo,
    Scan,
    Stream,
)
from situgraph.scenegraph.graph import Pose, SceneGraph, Warning
from situgraph.sim.camera import Camera
from situgraph.sim.clearing import build_drivable
from situgraph.sim.config import SimConfig
from situgraph.sim.deviations import Deviation
from situgraph.sim.lidar import Lidar
from situgraph.sim.motion import move
from situgraph.sim.odometry import drifting
from situgraph.sim.rays import RayCaster
from situgraph.sim.renderer import Wanted, make_renderer
from situgraph.sim.route import Ground, plan_route
from situgraph.sim.truth import RecentImages, Truth, Visit
from situgraph.sim.world import World

_VISIT = 0.1  # s between looks at which room the robot is in


class Simulation:
    """A robot driven through ``plan``; itself a ``Recording``.

    Args:
        plan: rooms with footprints; planes, objects and storeys where known (building frame).
        config: world, sensors and robot.
        seed: everything random comes from it.
        rooms: ids to visit in this order; none: all that can be reached, the nearest next.
        camera: whether to carry one.
        renderer: ``auto`` (OpenGL where there is any), ``gl`` or ``cpu``.

    Raises:
        InputError: the plan has no footprints, or a room asked for does not exist or cannot be
            reached.
    """

    def __init__(
        self,
        plan: SceneGraph,
        config: SimConfig | None = None,
        *,
        seed: int = 0,
        rooms: Sequence[str] = (),
        camera: bool = True,
        renderer: Wanted = "auto",
    ) -> None:
        self.config = config or SimConfig()
        self.seed = seed
        self.world, deviations = build_drivable(plan, self.config, rooms, seed)
        ground = Ground(self.world, self.config.robot)
        legs, notes = plan_route(ground, rooms, self._rng(1))
        self.motion = move(legs, self.config.robot, self._rng(2))
        self._frame = _map_frame(self.motion.at([0.0])[0], self.world, self.config, self._rng(3))
        self._times, self._odometry = drifting(
            self.motion, self._frame.inverse(), self.config.odometry, self._rng(4)
        )
        self._notes = (*self.world.notes, *notes)
        self._lidar = Lidar(self.world, RayCaster(self.world), self.config.lidar)
        self._camera = self._make_camera(renderer) if camera else None
        self._images = RecentImages()
        self.truth = self._truth(deviations)
        self.info = self._info(plan.name or "simulation")

    @property
    def warnings(self) -> tuple[Warning, ...]:
        """What of the plan could not be built or visited."""
        return tuple(Warning("not-simulated", note) for note in self._notes)

    def messages(self, streams: Collection[Stream] = STREAMS) -> Iterator[Message]:
        """See ``Recording.messages``; every pass gives the same messages."""
        parts: list[Iterator[Message]] = []
        if "odometry" in streams:
            parts.append(self._odometries())
        if "scans" in streams:
            parts.append(self._scans())
        if "frames" in streams:
            parts.append(self._frames())
        return heapq.merge(*parts, key=lambda m: m.stamp)

    def _rng(self, *key: int) -> np.random.Generator:
        return np.random.default_rng([self.seed, 7300, *key])

    def _stamp(self, time: float) -> float:
        """A time of the motion as a stamp: whole nanoseconds, as bags store them."""
        return round(self.config.start + time, 9)

    def _odometries(self) -> Iterator[Odometry]:
        for t, pose in zip(self._times, self._odometry):
            yield Odometry(self._stamp(float(t)), pose)

    def _scans(self) -> Iterator[Scan]:
        c, pattern = self.config.lidar, self._lidar.pattern
        rings = np.repeat(np.arange(16, dtype=np.uint8)[:, None], pattern.columns, axis=1).ravel()
        mount = pose_matrix(self.info.base_T_lidar)
        for k in range(1, int(self.motion.duration * c.rate) + 1):
            end = k / c.rate
            columns = end + pattern.times[0].astype(float)
            base = self.motion.matrices(columns if c.motion else [end])
            steps, light = self._lidar.scan(base @ mount, self._rng(5, k))
            order = pattern.order[steps.ravel()[pattern.order] > 0]
            points = pattern.points(steps, c.range_step).reshape(-1, 3)[order]
            bright = light.ravel()[order].astype(np.float32) / np.float32(255)
            times = pattern.times.ravel()[order]
            yield Scan(self._stamp(end), points, times, rings[order], bright)

    def _frames(self) -> Iterator[Frame]:
        if self._camera is None:
            return
        mount = pose_matrix(self.info.base_T_camera)
        rate = self.config.camera.rate
        for k in range(int(self.motion.duration * rate)):
            t = (k + 0.5) / rate
            picture = self._camera.take(self.motion.matrices([t])[0] @ mount, self._rng(6, k))
            stamp = self._stamp(t)
            self._images.keep(stamp, picture.ids)
            yield Frame(stamp, picture.rgb, picture.depth, self._camera.intrinsics)

    def _make_camera(self, renderer: Wanted) -> Camera:
        drawn = make_renderer(self.world, renderer)
        c = self.config.camera
        self._renderer = drawn.name
        width = c.width if drawn.name.startswith("OpenGL") else min(c.fallback_width, c.width)
        return Camera(self.world, drawn, c, width)

    def _truth(self, deviations: tuple[Deviation, ...]) -> Truth:
        stamps = np.array([self._stamp(t) for t in self._times.tolist()])
        poses = matrix_to_pose(self.motion.matrices(self._times))
        visits = _visits(self.world, self.motion.at(self._times), stamps)
        return Truth(
            self.world.graph,
            self._frame,
            stamps,
            poses,
            visits,
            deviations,
            self.world.parts,
            self._images,
        )

    def _info(self, name: str) -> RecordingInfo:
        c = self.config
        counts: dict[Stream, int] = {
            "scans": int(self.motion.duration * c.lidar.rate),
            "frames": int(self.motion.duration * c.camera.rate) if self._camera else 0,
            "odometry": len(self._times),
        }
        sensors = {
            "lidar": f"VLP-16, {c.lidar.rate:g} Hz, simulated",
            "odometry": "legs, simulated",
        }
        if self._camera:
            size = f"{self._camera.width}x{self._camera.height}"
            sensors["camera"] = f"D435, {size}, {c.camera.rate:g} Hz, simulated by {self._renderer}"
        lidar: Pose = (*c.lidar.position, 0.0, 0.0, 0.0, 1.0)
        camera = camera_mount(c.camera.position, c.camera.pitch) if self._camera else None
        return RecordingInfo(
            name, "simulation", c.start, self.motion.duration, counts, lidar, camera, sensors
        )


def camera_mount(position: tuple[float, float, float], pitch: float) -> Pose:
    """The optical frame (x right, y down, z forward) in base, looking up by ``pitch`` radians."""
    s, c = math.sin(pitch), math.cos(pitch)
    m = np.eye(4)
    m[:3, :3] = np.array([[0.0, s, c], [-1.0, 0.0, 0.0], [0.0, -c, s]])
    m[:3, 3] = position
    x, y, z, qx, qy, qz, qw = matrix_to_pose(m).tolist()
    return (x, y, z, qx, qy, qz, qw)


def pose_matrix(pose: Pose | None) -> Array:
    """The 4x4 matrix of a sensor's pose; the identity where it is unknown."""
    from situgraph.geometry.poses import pose_to_matrix

    return np.eye(4) if pose is None else pose_to_matrix(pose)


def _map_frame(
    start: Array, world: World, config: SimConfig, rng: np.random.Generator
) -> Placement:
    """The map in the building: any yaw, an origin near the robot's start, z = 0 on its floor."""
    yaw = float(rng.uniform(-math.pi, math.pi))
    shift = config.map_shift * math.sqrt(rng.random()) * rotation2(rng.uniform(-math.pi, math.pi))
    origin = start[:2] + shift[:, 0]
    floor = start[2] - config.robot.body_height
    level = min((lv.elevation for lv in world.levels), key=lambda e: abs(e - floor))
    return Placement(float(origin[0]), float(origin[1]), float(level), yaw)


def _visits(world: World, states: Array, stamps: Array) -> tuple[Visit, ...]:
    import shapely

    every = max(int(_VISIT / max(float(stamps[1] - stamps[0]), 1e-3)), 1)
    states, stamps = states[::every], stamps[::every]
    names = np.full(len(states), "", dtype=object)
    for i, level in enumerate(world.levels):
        above = world.levels[i + 1].elevation if i + 1 < len(world.levels) else np.inf
        here = (states[:, 2] >= level.elevation) & (states[:, 2] < above)
        for room, shape in level.rooms.items():
            names[here & shapely.contains_xy(shape, states[:, :2])] = room
    found: list[Visit] = []
    for name, stamp in zip(names.tolist(), stamps.tolist()):
        if found and found[-1].room == name:
            found[-1] = Visit(name, found[-1].start, stamp)
        else:
            found.append(Visit(name, stamp, stamp))
    return tuple(v for v in found if v.room)


def rooms_on(plan: SceneGraph, storey: str) -> tuple[str, ...]:
    """The ids of the rooms of one storey, named by id or name.

    Raises:
        InputError: there is no such storey.
    """
    known = [s.id for s in plan.storeys if storey in (s.id, s.name)]
    if not known:
        names = ", ".join(s.name or s.id for s in plan.storeys)
        raise InputError(plan.name or "plan", f"no storey {storey!r}", f"storeys are {names}")
    return tuple(r.id for r in plan.rooms if r.storey == known[0] and r.footprint)
