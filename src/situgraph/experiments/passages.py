"""Doorways that a drive without camera finds, against the doors that the robot walked through."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from situgraph.geometry.poses import Array
from situgraph.io.recording import Odometry, Scan
from situgraph.pipeline import Pipeline
from situgraph.scenegraph.graph import Object, Plane, SceneGraph
from situgraph.scenegraph.transform import transformed
from situgraph.sim.simulation import Simulation

SLACK = 0.1  # m past the jamb: the base's middle is where the path is
NEAR = 1.0  # m along the wall and across it; a doorway farther from a true one is another
FACE_ANGLE = math.cos(math.radians(10.0))
FACE_OFFSET = 0.3  # m


def doorway_row(plan: SceneGraph, seed: int) -> dict[str, Any]:
    """One drive through ``plan`` on LiDAR and drifting odometry: doorways crossed and found.

    ``errors`` (m) are distances in the plan of each found doorway from the middle of the true
    one; ``plane_right`` counts those whose every plane is a face of the true one.
    """
    drive = Simulation(plan, seed=seed, camera=False)
    system = Pipeline(base_T_lidar=drive.info.base_T_lidar)
    for message in drive.messages(("odometry", "scans")):
        if isinstance(message, Scan):
            system.feed(scan=message)
        elif isinstance(message, Odometry):
            system.feed(odometry=message)
    system.finish()
    back = drive.truth.building_T_map.inverse()
    truth = transformed(drive.truth.graph, back)
    path = back.points(drive.truth.poses[:, :3])
    crossed = crossed_doors(truth, path)
    found = [o for o in system.graph.objects if o.category == "door"]
    errors, right, invented = [], 0, 0
    for doorway in found:
        near = [(_apart(doorway, door), door) for door in crossed]
        apart, door = min(near, key=lambda pair: pair[0], default=(math.inf, None))
        if door is None or apart > NEAR:
            invented += 1
            continue
        crossed.remove(door)
        errors.append(round(apart, 4))
        faces = [truth.plane_by_id[p] for p in door.planes]
        own = [system.graph.plane_by_id[p] for p in doorway.planes]
        right += bool(own) and all(any(_same(p, f) for f in faces) for p in own)
    return {
        "building": plan.name, "seed": seed, "crossed": len(crossed) + len(errors),
        "found": len(errors), "invented": invented, "plane_right": right, "errors": errors,
        "rooms": len(system.graph.rooms), "rooms_true": len(plan.rooms),
        "seconds": drive.info.duration,
    }  # fmt: skip


def crossed_doors(truth: SceneGraph, path: Array) -> list[Object]:
    """The doors whose wall the path (n, 3) goes through between their jambs."""
    found = []
    for door in truth.objects:
        if door.category != "door" or not door.planes or door.ellipsoid is None:
            continue
        normal = np.array(truth.plane_by_id[door.planes[0]].normal[:2])
        away = path[:, :2] - np.array(door.center[:2])
        side = away @ normal > 0.0
        along = np.abs(away @ np.array([-normal[1], normal[0]]))
        half = max(door.ellipsoid.axes) if max(door.ellipsoid.axes[:2]) > 0.8 else 0.45
        width = max(half, 0.45) + SLACK
        level = np.abs(path[:, 2] - door.center[2]) < 1.5
        through = (side[1:] != side[:-1]) & (along[1:] < width) & level[1:]
        if through.any():
            found.append(door)
    return found


def _apart(first: Object, second: Object) -> float:
    return float(np.linalg.norm(np.array(first.center[:2]) - np.array(second.center[:2])))


def _same(own: Plane, face: Plane) -> bool:
    """Whether an estimated plane is a true face: direction, side and place."""
    facing = float(np.array(own.normal) @ np.array(face.normal))
    if facing < FACE_ANGLE:
        return False
    if face.extent is None:
        return abs(own.offset - face.offset) < FACE_OFFSET
    ends = np.array(face.extent)
    middle = np.array([*ends.mean(axis=0), 0.0])
    return abs(float(np.array(own.normal) @ middle) + own.offset) < FACE_OFFSET
