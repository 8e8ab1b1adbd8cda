"""Experiment ``localization``: the trajectory in the building, and what deviates, by the truth.

The driven world differs from the plan by walls moved 5 to 40 cm. The whole live system runs on
each drive; errors are taken in the building frame, nothing aligned: with the coupling, and with the
placement of the match alone.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np

from situgraph.experiments.results import ExperimentResult
from situgraph.experiments.runner import Experiment, RunOptions, run_experiment
from situgraph.judging import counted

if TYPE_CHECKING:
    from situgraph.coupling import Located
    from situgraph.geometry.poses import Array, Placement
    from situgraph.sim.truth import Truth

REVISION = 6
DATA = "../shared/data"
# Each building, and how many of its walls are moved: where a few rooms are visited, in full.
BUILDINGS = {
    "six rooms": (1, 2),
    "FZK-Haus": (1, 2),
    "Institute": (8, 8),
    "LargeBuilding": (2, 2),
    "corridor of 30 m": (1, 1),
}
# LargeBuilding is two flats of four rooms each with the same walls, and the robot cannot leave its
# own: it visits all of it.
FLAT = ("LargeBuilding", 4)
NO_DATA = ("six rooms", "corridor of 30 m")  # need no building model
SEEDS = (2, 5)
OFFSETS = (0.05, 0.10, 0.20, 0.30, 0.40)  # m, in turn over buildings and seeds


def run(options: RunOptions) -> ExperimentResult:
    """Compute it.

    Extra parameters: ``data`` (folder with ``ifc``), ``buildings`` (names with semicolons between),
    ``seeds``, ``camera`` (false: LiDAR and odometry only).
    """
    data = Path(str(options.extra.get("data", DATA)))
    wanted = [n.strip() for n in str(options.extra.get("buildings", "")).split(";") if n.strip()]
    names = wanted or [n for n in BUILDINGS if data.is_dir() or n in NO_DATA]
    seeds = int(options.extra.get("seeds", SEEDS[options.full]))
    tasks = [
        {
            "building": name,
            "seed": options.seed + seed,
            "moved_by": OFFSETS[(number + seed) % len(OFFSETS)],
            "full": options.full,
            "data": str(data),
            "camera": bool(options.extra.get("camera", True)),
        }
        for seed in range(seeds)
        for number, name in enumerate(names)
    ]
    experiment = Experiment("localization", tasks, solve, summarise, options.seed, REVISION)
    return run_experiment(experiment, options)


def solve(task: Mapping[str, Any]) -> dict[str, Any]:
    """One drive through one building as built."""
    from situgraph.config import Settings
    from situgraph.detectors import default_detector, make_detector
    from situgraph.experiments.slam_buildings import drive
    from situgraph.judging import building_errors, judge, judged_deviations, outcome
    from situgraph.run import run_log
    from situgraph.sim.simulation import Simulation

    settings = Settings()
    plan, rooms = drive(task["building"], Path(task["data"]), task["full"])
    if task["building"] == FLAT[0]:
        rooms = tuple(r.id for r in plan.rooms[: FLAT[1]])
    walls = BUILDINGS[task["building"]][task["full"]]
    world = msgspec.structs.replace(
        settings.sim.world, moved_walls=walls, moved_by=task["moved_by"]
    )
    config = msgspec.structs.replace(settings.sim, world=world)
    simulation = Simulation(plan, config, seed=task["seed"], rooms=rooms, camera=task["camera"])
    detector = make_detector(default_detector(simulation.info), "")
    told, system = run_log(simulation, settings, plan=plan, detector=detector)
    row: dict[str, Any] = {
        **task,
        "duration": told.duration,
        "rooms": told.rooms,
        "verdict": told.verdict,
        "located_s": told.located_at,
        "events": [f"{e.happening}: {e.reason}" for e in told.events],
        "realtime": told.realtime,
        "coupling_s": told.seconds["coupling"],
    }
    stamps, poses = system.slam.trajectory()
    truth = simulation.truth
    judged = judge(system.graph, (stamps, poses), truth, system.result)
    row |= {"ate_slam_m": judged.ate_rmse, **outcome(system, truth)}
    located = system.located
    if located is None or system.locator is None or system.locator.pairs is None:
        return row
    with_plan = building_errors(stamps, located.carrier.trajectory(stamps, poses), truth)
    alone = building_errors(stamps, _placed(poses, system.locator.pairs.placement), truth)
    return row | {
        "ate_building_m": _rms(with_plan),
        "ate_building_max_m": float(with_plan.max()),
        "ate_match_only_m": _rms(alone),
        **_deviations(located, truth),
        **judged_deviations(located.deviations, truth),
    }


def _placed(poses: Array, placement: Placement) -> Array:
    from situgraph.geometry.poses import matrix_to_pose, pose_to_matrix

    return matrix_to_pose(placement.matrix() @ pose_to_matrix(poses))


def _rms(errors: Array) -> float:
    return float(np.sqrt(np.mean(errors**2)))


def _deviations(located: Located, truth: Truth) -> dict[str, Any]:
    """Errors of the moved faces that were seen, and what of them was told.

    ``normalised_errors``: of the offsets of all faces that were seen, in standard deviations.
    """
    true = {
        name: offset
        for d in truth.deviations
        if d.kind == "moved-wall"
        for name, offset in zip(d.ids, d.offsets)
    }
    told = {d.prior: d.offset or 0.0 for d in located.deviations if d.kind == "moved-wall"}
    seen = {w.prior for w in located.coupled.walls}
    errors = [told[name] - offset for name, offset in true.items() if name in told]
    walls = located.coupled.walls
    scaled = [(w.offset - true.get(w.prior, 0.0)) / w.offset_sigma for w in walls]
    return {
        "moved_seen": sum(name in seen for name in true),
        "moved_told": len(errors),
        "invented": sum(name not in true for name in told),
        "invented_told": [
            d.message for d in located.deviations if d.kind == "moved-wall" and d.prior not in true
        ],
        "deviation_errors_m": errors,
        "normalised_errors": scaled,
        "wall_rms_m": located.coupled.rms,
    }


def summarise(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """By building; ``all`` is over every drive."""
    names = list(dict.fromkeys(str(r["building"]) for r in rows))
    summary = {name: _summary([r for r in rows if r["building"] == name]) for name in names}
    return {**summary, "all": _summary(rows)}


def _summary(rows: list[dict[str, Any]]) -> dict[str, Any]:
    located = [r for r in rows if "ate_building_m" in r]
    false = counted(located, "told_false")
    scaled = np.array([e for r in located for e in r.get("normalised_errors", ())])
    errors = [abs(e) for r in located for e in r["deviation_errors_m"]]
    return {
        "drives": len(rows),
        "located": len(located),
        **{k: sum(r["outcome"] == k for r in rows) for k in ("ambiguous", "never", "wrong")},
        "ate_building_m": _spread([r["ate_building_m"] for r in located]),
        "ate_match_only_m": _spread([r["ate_match_only_m"] for r in located]),
        "ate_slam_m": _spread([r["ate_slam_m"] for r in rows]),
        "deviation_error_median_m": float(np.median(errors)) if errors else None,
        "deviation_error_max_m": max(errors, default=None),
        "normalised_error_rms": float(np.sqrt(np.mean(scaled**2))) if len(scaled) else None,
        "beyond_3_sigma": float(np.mean(np.abs(scaled) > 3.0)) if len(scaled) else None,
        "moved_faces_seen": sum(r["moved_seen"] for r in located),
        "moved_faces_told": sum(r["moved_told"] for r in located),
        "invented": sum(r["invented"] for r in located),
        "told_false": sum(false.values()),
        "told_false_of": false,
        "seconds_to_located": _median([r["located_s"] for r in located]),
        "realtime": _median([r["realtime"] for r in rows]),
    }


def _spread(values: list[float]) -> dict[str, float | None]:
    return {"median": _median(values), "max": max(values, default=None)}


def _median(values: list[float]) -> float | None:
    return float(np.median(values)) if values else None
