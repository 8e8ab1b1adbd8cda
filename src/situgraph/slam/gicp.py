"""Generalised ICP of each scan against the last few, by small_gicp, one thread.

A wall has two faces a wall's thickness apart. Where the robot goes through a door, points of the
next room would find their nearest partner on the face that belongs to the last one and pull the
robot through the wall (13 cm a door, docs/slam.md). So the submap keeps faces of opposite direction
apart when it is thinned, and points whose nearest partner faces the other way are left out.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from situgraph.geometry.poses import Array
from situgraph.slam.cloud import moved, thin
from situgraph.slam.input_config import OdometryConfig
from situgraph.slam.motion import inverse, size, tidy
from situgraph.slam.odometry import Step

# The directions by which surfaces of the submap are told apart.
SIDES = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], float)


class Gicp:
    """GICP (Segal et al., RSS 2009) to a submap of key scans, nearer partners in a second half."""

    def __init__(self, config: OdometryConfig) -> None:
        """Start without a submap."""
        self._config = config
        self._scans: list[tuple[Array, Array, Array]] = []  # pose, points and normals of key scans
        self._target: tuple[Any, Any] | None = None
        self._sides = np.empty((0, 3))  # which way each point of the target faces
        self._anchor = np.eye(4)

    def register(self, points: Array, sensor: Array, guess: Array, reach: float) -> Step:
        """Align with the submap; where that fails the guess stands and a new submap begins."""
        import small_gicp

        c = self._config
        cloud, _ = small_gicp.preprocess_points(points, c.voxel, c.neighbours, 1)
        thinned = np.ascontiguousarray(np.asarray(cloud.points())[:, :3])
        normals = np.asarray(cloud.normals())[:, :3]
        away = np.einsum("ij,ij->i", normals, thinned - sensor) > 0
        normals = np.where(away[:, None], -normals, normals)
        if self._target is None:
            self._extend(guess, thinned, normals, fresh=True)
            return Step(guess, True, 1.0)
        cloud = self._facing(cloud, thinned, normals, guess)
        step = self._closing_in(cloud, guess, c.reach)
        if not step.trusted and reach > c.reach:
            step = self._closing_in(cloud, guess, reach)
        if not step.trusted:
            self._extend(guess, thinned, normals, fresh=True)
            return Step(guess, False, step.fit)
        length, angle = size(inverse(self._anchor) @ step.pose)
        if length > c.submap_step or angle > c.submap_turn:
            self._extend(step.pose, thinned, normals, fresh=False)
        return step

    def _facing(self, cloud: Any, points: Array, normals: Array, guess: Array) -> Any:
        """The scan without the points whose nearest partner faces the other way."""
        assert self._target is not None
        motion = inverse(self._anchor) @ guess
        index, squared = self._target[1].batch_nearest_neighbor_search(moved(points, motion))
        side = self._sides[np.asarray(index)]
        same = np.einsum("ij,ij->i", side, normals @ motion[:3, :3].T) > 0
        kept = same | (np.asarray(squared) > self._config.reach**2)
        return cloud if kept.mean() > 0.995 else _cloud(points[kept], self._config.neighbours)[0]

    def _closing_in(self, cloud: Any, guess: Array, reach: float) -> Step:
        """Align with partners up to ``reach`` apart, then with near ones only."""
        rough, fit = self._align(cloud, guess, reach)
        pose, _ = self._align(cloud, rough, self._config.near_reach)
        length, angle = size(inverse(guess) @ pose)
        trusted = (
            fit >= self._config.least_fit
            and bool(np.isfinite(pose).all())
            and length < reach
            and angle < self._config.largest_turn
        )
        return Step(pose, trusted, fit)

    def _align(self, cloud: Any, guess: Array, reach: float) -> tuple[Array, float]:
        import small_gicp

        assert self._target is not None
        target, tree = self._target
        result = small_gicp.align(
            target,
            cloud,
            tree,
            inverse(self._anchor) @ guess,
            registration_type="GICP",
            max_correspondence_distance=reach,
            num_threads=1,
            max_iterations=self._config.iterations,
        )
        pose = tidy(self._anchor @ result.T_target_source)
        return pose, float(result.num_inliers / max(cloud.size(), 1))

    def _extend(self, pose: Array, points: Array, normals: Array, *, fresh: bool) -> None:
        """Add the scan to the submap and drop the oldest; ``fresh`` starts over."""
        c = self._config
        scan = (pose, points, normals)
        self._scans = [scan] if fresh else [*self._scans, scan][-c.submap_scans :]
        self._anchor = pose
        back = inverse(pose)
        merged = np.concatenate([moved(p, back @ q) for q, p, _ in self._scans])
        facing = np.concatenate([n @ (back @ q)[:3, :3].T for q, _, n in self._scans])
        side = (facing @ SIDES.T).argmax(axis=1)
        parts = [thin(merged[side == k], c.voxel) for k in range(len(SIDES))]
        self._sides = np.repeat(SIDES, [len(p) for p in parts], axis=0)
        self._target = _cloud(np.concatenate(parts), c.neighbours)


def _cloud(points: Array, neighbours: int) -> tuple[Any, Any]:
    import small_gicp

    cloud = small_gicp.PointCloud(points)
    tree = small_gicp.KdTree(cloud)
    small_gicp.estimate_normals_covariances(cloud, tree, neighbours, 1)
    return cloud, tree
