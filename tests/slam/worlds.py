"""Tiny analytic worlds and a VLP-16 that drives through them: scans without any simulator.

Walls are boxes with openings; a ray is cut with every vertical rectangle, the floor and the
ceiling, so each scan is exact but for the noise asked for.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
ELEVATIONS = np.radians(np.arange(-15.0, 16.0, 2.0))


@dataclass
class World:
    """Vertical rectangles (x0, y0, x1, y1, z0, z1), a floor at 0 and a ceiling."""

    ceiling: float = 2.6
    faces: list[tuple[float, float, float, float, float, float]] = field(default_factory=list)
    rooms: dict[str, Array] = field(default_factory=dict)

    def wall(
        self,
        a: tuple[float, float],
        b: tuple[float, float],
        thickness: float = 0.2,
        doors: tuple[tuple[float, float], ...] = (),
        lintel: float = 2.0,
    ) -> None:
        """A wall along a-b (centre line); ``doors`` are (distance of the middle from a, width)."""
        p, q = np.asarray(a, float), np.asarray(b, float)
        length = float(np.linalg.norm(q - p))
        t = (q - p) / length
        n = np.array([-t[1], t[0]]) * thickness / 2
        cuts = sorted((m - w / 2, m + w / 2) for m, w in doors)
        edges = [0.0, *(x for cut in cuts for x in cut), length]
        for i in range(len(edges) - 1):
            u, v, z0 = edges[i], edges[i + 1], 0.0 if i % 2 == 0 else lintel
            if v - u < 1e-9 or z0 >= self.ceiling:
                continue
            c = [p + t * u + n, p + t * v + n, p + t * v - n, p + t * u - n]
            for k in range(4):
                r, s = c[k], c[(k + 1) % 4]
                self.faces.append((*r, *s, z0, self.ceiling))

    def box(self, x0: float, y0: float, x1: float, y1: float, height: float) -> None:
        """A piece of furniture."""
        c = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
        for k in range(4):
            self.faces.append((*c[k], *c[(k + 1) % 4], 0.0, height))

    def cast(self, origins: Array, directions: Array, limit: float = 60.0) -> Array:
        """Ranges (n,) of rays from ``origins`` (n, 3) along unit ``directions`` (n, 3)."""
        f = np.array(self.faces)
        a, e = f[:, :2], f[:, 2:4] - f[:, :2]
        o, d = origins[:, None, :], directions[:, None, :]
        with np.errstate(divide="ignore", invalid="ignore"):
            det = d[..., 0] * e[:, 1] - d[..., 1] * e[:, 0]
            w = a - o[..., :2]
            t = (w[..., 0] * e[:, 1] - w[..., 1] * e[:, 0]) / det
            u = (w[..., 0] * d[..., 1] - w[..., 1] * d[..., 0]) / det
            z = o[..., 2] + t * d[..., 2]
            hit = (t > 1e-6) & (u >= 0) & (u <= 1) & (z >= f[:, 4]) & (z <= f[:, 5])
            walls = np.where(hit, t, np.inf).min(axis=1)
            dz = directions[:, 2]
            flat = np.where(dz < 0, -origins[:, 2] / dz, (self.ceiling - origins[:, 2]) / dz)
        flat = np.where(np.abs(dz) < 1e-9, np.inf, flat)
        r = np.minimum(walls, flat)
        return np.where(r > limit, np.inf, r)


@dataclass(frozen=True)
class Sweep:
    """One scan with its truth: pose (7,) of the sensor at the stamp, in the world.

    ``odometry`` (7,) is what the robot believes: it drifts in scale and heading.
    """

    stamp: float
    points: NDArray[np.float32]
    times: NDArray[np.float32]
    rings: NDArray[np.uint8]
    truth: Array
    odometry: Array


def scan(
    world: World,
    poses: Array,
    stamp: float,
    noise: float = 0.01,
    rng: np.random.Generator | None = None,
    columns: int = 450,
    period: float = 0.1,
    odometry: Array | None = None,
) -> Sweep:
    """A turn of the LiDAR that ends at ``stamp``; ``poses`` (columns, 4) are x y z yaw."""
    rng = rng or np.random.default_rng(0)
    azimuth = np.linspace(0, -2 * np.pi, columns, endpoint=False)
    times = np.linspace(-period, 0, columns, endpoint=False) + period / columns
    el = np.tile(ELEVATIONS, columns)
    az = np.repeat(azimuth, 16)
    body = np.stack([np.cos(el) * np.cos(az), np.cos(el) * np.sin(az), np.sin(el)], axis=1)
    yaw = np.repeat(poses[:, 3], 16)
    c, s = np.cos(yaw), np.sin(yaw)
    world_dir = np.stack(
        [c * body[:, 0] - s * body[:, 1], s * body[:, 0] + c * body[:, 1], body[:, 2]], axis=1
    )
    r = world.cast(np.repeat(poses[:, :3], 16, axis=0), world_dir)
    r = r + rng.normal(0, noise, len(r))
    keep = np.isfinite(r) & (r > 0.4)
    end = poses[-1]
    truth = np.array([*end[:3], 0, 0, np.sin(end[3] / 2), np.cos(end[3] / 2)])
    believed = truth if odometry is None else odometry
    return Sweep(
        stamp,
        (body * r[:, None])[keep].astype(np.float32),
        np.repeat(times, 16)[keep].astype(np.float32),
        np.tile(np.arange(16, dtype=np.uint8), columns)[keep],
        truth,
        believed,
    )


def path(
    waypoints: list[tuple[float, float]], speed: float = 0.8, turn: float = 1.0, dt: float = 0.02
) -> Array:
    """Poses (n, 3) x y yaw every ``dt``: turn on the spot, then go straight, waypoint by waypoint.

    Each move starts and ends at rest; ``speed`` (m/s) and ``turn`` (rad/s) are its means.
    """

    def shares(steps: int) -> Array:
        u = np.arange(1, steps + 1) / steps
        return u * u * (3 - 2 * u)

    out = []
    x, y = waypoints[0]
    yaw = float(np.arctan2(waypoints[1][1] - y, waypoints[1][0] - x))
    for gx, gy in waypoints[1:]:
        goal = float(np.arctan2(gy - y, gx - x))
        delta = (goal - yaw + np.pi) % (2 * np.pi) - np.pi
        for share in shares(max(1, int(abs(delta) / turn / dt))):
            out.append((x, y, yaw + delta * share))
        yaw = goal
        for share in shares(max(1, int(np.hypot(gx - x, gy - y) / speed / dt))):
            out.append((x + (gx - x) * share, y + (gy - y) * share, yaw))
        x, y = gx, gy
    return np.array(out)


def drive(
    world: World,
    waypoints: list[tuple[float, float]],
    *,
    seed: int = 0,
    height: float = 0.65,
    columns: int = 450,
    noise: float = 0.01,
    speed: float = 0.8,
) -> Iterator[Sweep]:
    """Scans at 10 Hz along the waypoints, with motion distortion."""
    rng = np.random.default_rng(seed)
    p = path(waypoints, speed)
    when = np.arange(len(p)) * 0.02
    yaw = np.unwrap(p[:, 2])
    believed = _believed(p, yaw, rng)
    for i in range(1, int(when[-1] / 0.1)):
        t = i * 0.1 + np.linspace(-0.1, 0, columns, endpoint=False) + 0.1 / columns
        poses = np.stack(
            [
                np.interp(t, when, p[:, 0]),
                np.interp(t, when, p[:, 1]),
                np.full(columns, height),
                np.interp(t, when, yaw),
            ],
            axis=1,
        )
        x, y, a = (np.interp(i * 0.1, when, believed[:, k]) for k in range(3))
        odometry = np.array([x, y, height, 0, 0, np.sin(a / 2), np.cos(a / 2)])
        yield scan(world, poses, i * 0.1, noise, rng, columns, odometry=odometry)


def _believed(p: Array, yaw: Array, rng: np.random.Generator) -> Array:
    """Dead reckoning along the path: 1.5 % too short, the heading wanders by 1 deg a minute."""
    drift = np.cumsum(rng.normal(0, 3e-4, len(p)))
    dx, dy = np.diff(p[:, 0], prepend=p[0, 0]), np.diff(p[:, 1], prepend=p[0, 1])
    x = p[0, 0] + 0.985 * np.cumsum(np.cos(drift) * dx - np.sin(drift) * dy)
    y = p[0, 1] + 0.985 * np.cumsum(np.sin(drift) * dx + np.cos(drift) * dy)
    return np.stack([x, y, yaw + drift], axis=1)


def rectangle(x0: float, y0: float, x1: float, y1: float) -> Array:
    """A footprint."""
    return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]], float)


def six_rooms() -> tuple[World, list[tuple[float, float]]]:
    """Three rooms on each side of a corridor, and a drive into each of them."""
    w = World()
    W, H, c = 15.0, 12.0, (5.0, 7.0)
    w.wall((-0.1, 0), (W + 0.1, 0))
    w.wall((-0.1, H), (W + 0.1, H))
    w.wall((0, -0.1), (0, H + 0.1))
    w.wall((W, -0.1), (W, H + 0.1))
    w.wall((0, c[0]), (W, c[0]), doors=((2.5, 0.9), (7.0, 0.9), (12.5, 0.9)))
    w.wall((0, c[1]), (W, c[1]), doors=((2.0, 0.9), (8.0, 0.9), (12.0, 0.9)))
    for x in (4.5, 9.5):
        w.wall((x, 0), (x, c[0]))
    for x in (5.5, 10.0):
        w.wall((x, c[1]), (x, H))
    w.rooms = {
        "corridor": rectangle(0.1, 5.1, 14.9, 6.9),
        "a": rectangle(0.1, 0.1, 4.4, 4.9),
        "b": rectangle(4.6, 0.1, 9.4, 4.9),
        "c": rectangle(9.6, 0.1, 14.9, 4.9),
        "d": rectangle(0.1, 7.1, 5.4, 11.9),
        "e": rectangle(5.6, 7.1, 9.9, 11.9),
        "f": rectangle(10.1, 7.1, 14.9, 11.9),
    }
    way = [
        (1.0, 6.0),
        (2.5, 6.0),
        (2.5, 2.5),
        (1.5, 1.5),
        (2.5, 3.0),
        (2.5, 6.0),
        (2.0, 6.0),
        (2.0, 9.5),
        (4.0, 10.5),
        (2.0, 9.0),
        (2.0, 6.0),
        (7.0, 6.0),
        (7.0, 2.5),
        (8.0, 1.5),
        (7.0, 3.0),
        (7.0, 6.0),
        (8.0, 6.0),
        (8.0, 9.5),
        (7.0, 10.5),
        (8.0, 9.0),
        (8.0, 6.0),
        (12.0, 6.0),
        (12.0, 9.5),
        (13.5, 10.5),
        (12.0, 9.0),
        (12.0, 6.0),
        (12.5, 6.0),
        (12.5, 2.5),
        (11.0, 1.5),
        (12.5, 3.0),
        (12.5, 6.0),
        (14.0, 6.0),
        (1.0, 6.0),
    ]
    return w, way


def corridor() -> tuple[World, list[tuple[float, float]]]:
    """A featureless corridor of 30 m with a room at each end and one at its side."""
    w = World()
    w.wall((-0.1, 0), (30.1, 0))
    w.wall((0, 2), (30, 2))
    w.wall((0, -2), (0, 4.1), doors=((3.0, 0.9),))
    w.wall((30, -2), (30, 4.1), doors=((3.0, 0.9),))
    for x0, x1 in ((-5.0, 0.0), (30.0, 34.0)):
        w.wall((x0 - 0.1, -2), (x1 + 0.1, -2))
        w.wall((x0 - 0.1, 4), (x1 + 0.1, 4))
        x = x0 if x0 < 0 else x1
        w.wall((x, -2.1), (x, 4.1))
    w.rooms = {
        "corridor": rectangle(0.1, 0.1, 29.9, 1.9),
        "west": rectangle(-4.9, -1.9, -0.1, 3.9),
        "east": rectangle(30.1, -1.9, 33.9, 3.9),
    }
    way = [
        (-2.5, 1.0),
        (-3.5, 3.0),
        (-2.5, 1.0),
        (32.0, 1.0),
        (32.5, -0.5),
        (32.0, 3.0),
        (31.5, 1.0),
        (-2.5, 1.0),
        (-3.0, -1.0),
    ]
    return w, way
