"""Experiment ``relations``: which room an object is in, which wall it is on, and doorways.

Relations: the objects of plans lose their relations, are moved by a known distance in a random
direction of the plan, and get their relations back from geometry alone. Doorways: drives without a
camera through the whole SLAM; what the robot walked through is compared with the true doors.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, get_args

import msgspec
import numpy as np
import shapely

from situgraph.experiments.passages import doorway_row
from situgraph.experiments.results import ExperimentResult
from situgraph.experiments.runner import Experiment, RunOptions, run_experiment
from situgraph.geometry.poses import Array
from situgraph.objects.config import ObjectsConfig
from situgraph.objects.relations import related
from situgraph.plan.layout_config import Kind
from situgraph.plan.layouts import make_layout
from situgraph.plan.six_rooms import six_rooms
from situgraph.scenegraph.graph import Object, SceneGraph

REVISION = 3
ERRORS = (0.0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5)  # m
CLAIMED = 0.2  # m; the summary's figures are over errors up to this
LAYOUTS = (12, 60)  # default, full
LAYOUT_SEED = 4_000
REPEATS = 5  # directions in which each object is moved
DRIVES = (10, 50)
EYE_MARGIN = 0.4  # m; a robot is no nearer to a wall
TRIES = 40  # places drawn until one is in the room
# Settings whose choice is shown: share of right relations at errors of ``CLAIMED``.
SWEPT: Mapping[str, tuple[float, ...]] = {
    "wall_distance": (0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5),
    "visibility_margin": (0.0, 0.05, 0.1, 0.15, 0.2, 0.3),
    "wall_thickness": (0.1, 0.2, 0.3, 0.4, 0.6, 0.8),
}


def run(options: RunOptions) -> ExperimentResult:
    """Compute it; with a folder also draw the sweep. Extra parameters: ``layouts``, ``drives``."""
    layouts = int(options.extra.get("layouts", LAYOUTS[options.full]))
    drives = int(options.extra.get("drives", DRIVES[options.full]))
    tasks: list[dict[str, Any]] = [
        {"part": "relations", "layout": k, "footprints": known, "seed": options.seed}
        for k in range(-1, layouts)
        for known in (True, False)
    ]
    tasks += [
        {"part": "threshold", "setting": name, "value": value, "layouts": min(layouts, 6),
         "seed": options.seed}
        for name, values in SWEPT.items()
        for value in values
    ]  # fmt: skip
    tasks += [{"part": "doorways", "drive": k, "seed": options.seed + 200 + k}
              for k in range(drives)]  # fmt: skip
    experiment = Experiment("relations", tasks, solve, summarise, options.seed, REVISION)
    result = run_experiment(experiment, options)
    if options.folder is not None:
        draw(result, options.folder)
    return result


def solve(task: Mapping[str, Any]) -> dict[str, Any]:
    """One building's relations at every error, or one drive's doorways."""
    if task["part"] == "doorways":
        return {"part": "doorways", **doorway_row(_driven(task["drive"]), task["seed"])}
    if task["part"] == "threshold":
        return _threshold(task)
    plan = building(task["layout"])
    rng = np.random.default_rng([task["seed"], 31, task["layout"] + 1])
    config = ObjectsConfig()
    sweep = [_counts(plan, error, task["footprints"], rng, config) for error in ERRORS]
    return {
        "part": "relations", "building": plan.name, "footprints": task["footprints"],
        "sweep": sweep,
    }  # fmt: skip


def building(number: int) -> SceneGraph:
    """The six rooms (-1), or a layout: the kinds take turns."""
    if number < 0:
        return six_rooms()
    kinds = [k for k in get_args(Kind) if k != "storeys"]
    plan = make_layout(kinds[number % len(kinds)], 8, LAYOUT_SEED + number)
    return plan.replace(name=f"{kinds[number % len(kinds)]} {LAYOUT_SEED + number}")


def _driven(number: int) -> SceneGraph:
    return building(-1 if number % 2 == 0 else number // 2)


def _counts(
    plan: SceneGraph,
    error: float,
    footprints: bool,
    rng: np.random.Generator,
    config: ObjectsConfig,
) -> dict[str, Any]:
    """Right relations of all objects, moved by ``error`` (m) in ``REPEATS`` directions each.

    Each was seen from somewhere in its room, as a camera tells; ``unseen``: the same without that.
    """
    whole = plan
    if not footprints:
        bare = tuple(msgspec.structs.replace(r, footprint=None) for r in plan.rooms)
        plan = plan.replace(rooms=bare)
    count = {"error": error, "objects": 0, "hung": 0, "in_room": 0, "on_plane": 0,
             "in_room_unseen": 0, "on_plane_unseen": 0}  # fmt: skip
    for _ in range(REPEATS if error else 1):
        moved = plan.replace(objects=tuple(_moved(o, error, rng) for o in plan.objects))
        for eyes, suffix in ((_eyes(whole, rng), ""), ({}, "_unseen")):
            for old, new in zip(plan.objects, related(moved, config, eyes).objects):
                if old.rooms:
                    count["in_room" + suffix] += set(new.rooms) == set(old.rooms)
                if old.rooms and old.planes:
                    count["on_plane" + suffix] += set(new.planes) == set(old.planes)
        count["objects"] += sum(bool(o.rooms) for o in plan.objects)
        count["hung"] += sum(bool(o.rooms and o.planes) for o in plan.objects)
    return count


def _eyes(plan: SceneGraph, rng: np.random.Generator) -> dict[str, Array]:
    """By object a place (3,) that a robot saw it from: anywhere in its room, off the walls."""
    found = {}
    for item in plan.objects:
        room = plan.room_by_id[item.rooms[0]] if item.rooms else None
        if room is None or room.footprint is None:
            continue
        outline = shapely.Polygon(room.footprint).buffer(-EYE_MARGIN)
        x0, y0, x1, y1 = outline.bounds if not outline.is_empty else (0.0, 0.0, 0.0, 0.0)
        for x, y in rng.uniform((x0, y0), (x1, y1), (TRIES, 2)).tolist():
            if outline.contains(shapely.Point(x, y)):
                found[item.id] = np.array([x, y, room.center[2]])
                break
    return found


def _threshold(task: Mapping[str, Any]) -> dict[str, Any]:
    """Right relations, walls known and footprints not, with one setting changed."""
    config = msgspec.structs.replace(ObjectsConfig(), **{task["setting"]: task["value"]})
    rng = np.random.default_rng([task["seed"], 32])
    counts = [_counts(building(k), CLAIMED, False, rng, config) for k in range(-1, task["layouts"])]
    return {
        "part": "threshold", "setting": task["setting"], "value": task["value"],
        "in_room": _share(counts, "in_room", "objects"),
        "on_plane": _share(counts, "on_plane", "hung"),
    }  # fmt: skip


def _moved(item: Object, error: float, rng: np.random.Generator) -> Object:
    angle = rng.uniform(-np.pi, np.pi)
    x, y, z = item.center
    center = (x + error * float(np.cos(angle)), y + error * float(np.sin(angle)), z)
    return msgspec.structs.replace(item, center=center, rooms=(), planes=())


def summarise(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Shares of right relations for errors up to ``CLAIMED``; doorways over all drives.

    Without footprints (``walls_only``) a room is what its centre sees, as in the paper; rooms of
    other shapes than a rectangle are not, and are told apart with their footprints only.
    """
    steps = {
        known: [
            s
            for r in rows
            if r["part"] == "relations" and r["footprints"] == known
            for s in r["sweep"]
            if s["error"] <= CLAIMED
        ]
        for known in (True, False)
    }
    largest = [s for s in steps[True] if s["error"] == CLAIMED]
    drives = [r for r in rows if r["part"] == "doorways"]
    errors = [e for r in drives for e in r["errors"]]
    crossed = sum(r["crossed"] for r in drives)
    found = sum(r["found"] for r in drives)
    return {
        "in_room_right": _share(steps[True], "in_room", "objects"),
        "on_plane_right": _share(steps[True], "on_plane", "hung"),
        "in_room_right_at_0.2_m": _share(largest, "in_room", "objects"),
        "on_plane_right_at_0.2_m": _share(largest, "on_plane", "hung"),
        "in_room_right_at_0.2_m_unseen": _share(largest, "in_room_unseen", "objects"),
        "on_plane_right_at_0.2_m_unseen": _share(largest, "on_plane_unseen", "hung"),
        "in_room_right_unseen": _share(steps[True], "in_room_unseen", "objects"),
        "on_plane_right_unseen": _share(steps[True], "on_plane_unseen", "hung"),
        "in_room_right_walls_only": _share(steps[False], "in_room", "objects"),
        "on_plane_right_walls_only": _share(steps[False], "on_plane", "hung"),
        "objects": sum(s["objects"] for s in steps[True]),
        "drives": len(drives),
        "doorways_crossed": crossed,
        "doorways_found": found / crossed if crossed else None,
        "doorways_invented": sum(r["invented"] for r in drives),
        "doorway_plane_right": sum(r["plane_right"] for r in drives) / found if found else None,
        "doorway_error_median_m": float(np.median(errors)) if errors else None,
    }


def _share(steps: list[dict[str, Any]], part: str, whole: str) -> float | None:
    total = sum(s[whole] for s in steps)
    return sum(s[part] for s in steps) / total if total else None


def draw(result: ExperimentResult, folder: Path) -> None:
    """Share of right relations over the error of the centre, and over each setting."""
    for known, name in ((True, "relations"), (False, "relations-walls-only")):
        steps = [
            {**step, "in_room": step["in_room"] / step["objects"],
             "on_plane": step["on_plane"] / step["hung"]}
            for row in result.rows
            if row.get("footprints") == known
            for step in row["sweep"]
            if step["hung"]
        ]  # fmt: skip
        title = "footprints known" if known else "walls only"
        _draw(steps, "error", f"Relations, {title}", "error of the centre (m)", folder / name)
    for setting in SWEPT:
        rows = [r for r in result.rows if r.get("setting") == setting]
        title = f"Relations at errors of {CLAIMED} m"
        _draw(rows, "value", title, setting, folder / f"relations-{setting.replace('_', '-')}")


def _draw(rows: list[dict[str, Any]], x: str, title: str, x_name: str, path: Path) -> None:
    from situgraph.view.experiments import draw_lines

    shares = [
        {"x": row[x], "right": 100.0 * row[part], "series": name}
        for row in rows
        for name, part in (("in room", "in_room"), ("on plane", "on_plane"))
    ]
    figure = draw_lines(
        shares, "x", "right", "series", title=title, x_name=x_name, y_name="right (%)"
    )
    figure.savefig(path.with_suffix(".png"), dpi=150, bbox_inches="tight")
