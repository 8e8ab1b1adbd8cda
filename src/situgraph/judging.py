"""How good a run was, by the truth of a simulated drive. Nothing here feeds an estimator."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np

from situgraph.geometry.poses import Array, Placement, wrap_angle
from situgraph.scenegraph.transform import transformed
from situgraph.slam.evaluation import absolute_errors, associated
from situgraph.slam.map_evaluation import room_scores, wall_errors

if TYPE_CHECKING:
    from collections.abc import Sequence

    from situgraph.coupling import Deviation
    from situgraph.matching import MatchResult
    from situgraph.pipeline import Pipeline
    from situgraph.run import Run
    from situgraph.scenegraph.graph import SceneGraph
    from situgraph.sim.truth import Truth

RIGHT_DISTANCE = 0.3  # m at the mean room centre, as 'the same candidate' (DESIGN section 1)
RIGHT_ANGLE = math.radians(10.0)
SAME_HEIGHT = 0.8  # m (DESIGN section 1, 'candidate')
VISIT = 2.0  # s; rooms only touched at their doors are not counted as visited


class Judgement(msgspec.Struct, frozen=True):
    """Errors in metres, shares from 0 to 1.

    ``placement_error`` is that of the best placement at the mean room centre, None without one;
    ``placement_right`` whether the true placement is the unique one, or one of several solutions.
    ``ate_building_...``: of the trajectory in the building as coupled, nothing aligned.
    """

    ate_rmse: float
    ate_largest: float
    wall_offset_median: float
    wall_offset_largest: float
    walls_without_truth: int
    room_precision: float
    room_recall: float
    storeys: int
    true_storeys: int
    placement_error: float | None = None
    placement_right: bool | None = None
    ate_building_rmse: float | None = None
    ate_building_largest: float | None = None


def judge(
    graph: SceneGraph,
    trajectory: tuple[Array, Array],
    truth: Truth,
    result: MatchResult | None = None,
) -> Judgement:
    """Judge a map, its trajectory (stamps (n,), poses (n, 7) in the map) and its last match.

    The trajectory is aligned to the truth (ATE, rigid, by Umeyama). Walls and rooms are compared
    in the building frame under the true placement of the map's origin.
    """
    stamps, poses = trajectory
    i, j = associated(truth.stamps, stamps, 0.02)
    ate = absolute_errors(truth.poses[i], poses[j])
    placed = transformed(graph, truth.building_T_map)
    walls = wall_errors(placed, truth.graph)
    visited = sorted({v.room for v in truth.visits if v.end - v.start > VISIT})
    rooms = room_scores(placed, truth.graph, visited)
    storey_of = {r.id: r.storey for r in truth.graph.rooms}
    error, right = _placement(graph, truth, result)
    return Judgement(
        ate.rmse,
        ate.largest,
        walls.offset.median,
        walls.offset.largest,
        walls.unmatched,
        rooms.precision,
        rooms.recall,
        len(graph.storeys),
        len({storey_of.get(v) for v in visited}),
        error,
        right,
    )


def judged(run: Run, pipeline: Pipeline, log: str | Path) -> Run:
    """The run with its judgement where truth lies beside ``log``; nothing else changes."""
    from situgraph.sim.truth import has_truth, read_truth

    if not has_truth(log) or not pipeline.slam.keyframes:
        return run
    return judged_by(run, pipeline, read_truth(log))


def judged_by(run: Run, pipeline: Pipeline, truth: Truth) -> Run:
    """The run with its judgement by ``truth``."""
    trajectory = pipeline.slam.trajectory()
    found = judge(pipeline.graph, trajectory, truth, pipeline.result)
    if pipeline.located is not None:
        stamps, poses = trajectory
        errors = building_errors(stamps, pipeline.located.carrier.trajectory(stamps, poses), truth)
        found = msgspec.structs.replace(
            found,
            ate_building_rmse=float(np.sqrt(np.mean(errors**2))),
            ate_building_largest=float(errors.max()),
        )
    return msgspec.structs.replace(run, judgement=found)


def building_errors(stamps: Array, poses: Array, truth: Truth) -> Array:
    """Distances (n,) in metres of poses (n, 7) in the building from the truth; nothing aligned."""
    i, j = associated(truth.stamps, stamps, 0.02)
    return np.asarray(np.linalg.norm(poses[j, :3] - truth.poses[i, :3], axis=1))


def outcome(system: Pipeline, truth: Truth) -> dict[str, Any]:
    """What became of a run, and how far (m) its placement is off at the middle of the rooms seen.

    ``outcome`` is ``right``; ``wrong``, where the system was sure; ``ambiguous``, where several
    placements are left (of a match, or of the walls: then the true one among them); ``never``.
    ``placement_error_m`` is that of the map coupled with the plan, ``match_error_m`` the match's;
    ``readings`` are the placements that the walls allow, ``readings_apart_m`` how far they lie
    apart.
    """
    from situgraph.coupling import spread

    pairs = None if system.locator is None else system.locator.pairs
    if pairs is None or system.located is None:
        several = system.result is not None and system.result.verdict == "ambiguous"
        return {"outcome": "ambiguous" if several else "never", "placement_error_m": None}
    middle = np.mean([r.center for r in system.graph.rooms], axis=0)
    at = system.located.placement
    error, turn = apart(at, truth.building_T_map, middle)
    storey = abs(at.z - truth.building_T_map.z) <= SAME_HEIGHT
    right = error <= RIGHT_DISTANCE and turn <= RIGHT_ANGLE and storey
    told = any(
        apart(r.placement, truth.building_T_map, middle)[0] <= RIGHT_DISTANCE
        for r in system.located.readings[1:]
    )
    return {
        "outcome": "right" if right else "ambiguous" if told else "wrong",
        "placement_error_m": error,
        "match_error_m": apart(pairs.placement, truth.building_T_map, middle)[0],
        "readings": len(system.located.readings),
        "readings_apart_m": spread(system.located.readings),
    }


# What is true of a told deviation: the kinds of changes that a simulated building has.
TRUE_OF = {"moved-wall": ("moved-wall",), "missing-object": ("missing-door", "left-out")}


def judged_deviations(told: Sequence[Deviation], truth: Truth) -> dict[str, Any]:
    """Which of the told deviations are true.

    ``told_true`` and ``told_false`` count them by kind, ``told_false_what`` are the sentences of
    the false ones. A simulated building has no walls and no doors or windows beyond its plan, and
    none of them stands elsewhere on its wall, so ``extra-...``, ``missing-wall`` and
    ``moved-object`` are false.
    """
    real = {(d.kind, name) for d in truth.deviations for name in d.ids}
    counts: dict[bool, dict[str, int]] = {True: {}, False: {}}
    false = []
    for deviation in told:
        right = any((kind, deviation.prior) in real for kind in TRUE_OF.get(deviation.kind, ()))
        counts[right][deviation.kind] = counts[right].get(deviation.kind, 0) + 1
        if not right:
            false.append(f"{deviation.kind}: {deviation.message}")
    return {"told_true": counts[True], "told_false": counts[False], "told_false_what": false}


def counted(rows: Sequence[dict[str, Any]], key: str) -> dict[str, int]:
    """The sums over rows of the counts by kind that stand under ``key``."""
    kinds = sorted({kind for row in rows for kind in row.get(key, {})})
    return {kind: sum(row.get(key, {}).get(kind, 0) for row in rows) for kind in kinds}


def _placement(
    graph: SceneGraph, truth: Truth, result: MatchResult | None
) -> tuple[float | None, bool | None]:
    if result is None or not result.solutions or not graph.rooms:
        return None, None
    middle = np.mean([r.center for r in graph.rooms], axis=0)
    off = [apart(s.transform, truth.building_T_map, middle) for s in result.solutions]
    return off[0][0], any(d <= RIGHT_DISTANCE and a <= RIGHT_ANGLE for d, a in off)


def apart(a: Placement, b: Placement, at: Array) -> tuple[float, float]:
    """Distance (m) and angle (rad) between two placements at a point (3,) of the map."""
    distance = float(np.linalg.norm(a.points(at[:2]) - b.points(at[:2])))
    return distance, abs(float(wrap_angle(a.yaw - b.yaw)))
