"""Experiment ``detection``: the paper's table II, by detector, on estimated poses.

The whole live system drives through the six rooms (ten seeds: start, clutter, paints, noise) and
through buildings that no network was trained on; at the end its S-Graph's doors and windows are
compared with those of the building. Every detector sees the same pictures of the same drives.
"""

from __future__ import annotations

import gc
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from situgraph.detectors import oracle
from situgraph.experiments.instances import (
    FrameScores,
    average_precision,
    counts,
    mask_iou,
    rates,
)
from situgraph.experiments.results import ExperimentResult
from situgraph.experiments.runner import Experiment, RunOptions, run_experiment
from situgraph.io.recording import Frame, Odometry, Scan
from situgraph.objects.detections import Detection, Detector
from situgraph.objects.gaps import WallGap
from situgraph.objects.network import NetworkDetector
from situgraph.objects.oracle import OracleConfig
from situgraph.objects.stage import ObjectStage, View
from situgraph.pipeline import Pipeline
from situgraph.plan.six_rooms import six_rooms
from situgraph.scenegraph.graph import Object, SceneGraph
from situgraph.scenegraph.transform import transformed
from situgraph.sim.simulation import Simulation
from situgraph.sim.truth import Truth

REVISION = 9
DATA = "../shared/data"
SIX = "six rooms"
BUILDINGS = {"FZK-Haus": "ifc/AC20-FZK-Haus.ifc", "LargeBuilding": "ifc/bimwhale_LargeBuilding.ifc"}
SEEDS = {SIX: (10, 10), "FZK-Haus": (2, 10), "LargeBuilding": (2, 10)}  # default, full
FIRST_SEED = 700  # drives before it were looked at while the stage was made
CATEGORIES = ("window", "door")
DETECTORS = ("network", "oracle")
SCORED = 4  # every so-manieth picture is compared pixel by pixel
STAY = 3.0  # s; a room that the robot was in for as long should be known
# The paper's table II as errors of each picture: it misses 7 %, and 3 % of what it names is not.
PAPER_RATES = OracleConfig(miss=0.07, confusion=0.01, false_positive=0.03)


def run(options: RunOptions) -> ExperimentResult:
    """Compute it.

    Extra parameters: ``data`` (folder with ``ifc``), ``seeds`` of the six rooms, ``others`` of each
    other building.

    Without the data the six rooms alone are driven through.

    Raises:
        InputError: the shipped network is not there.
    """
    NetworkDetector()
    data = Path(str(options.extra.get("data", DATA)))
    tasks: list[dict[str, Any]] = []
    for building, sizes in SEEDS.items():
        if building != SIX and not (data / BUILDINGS[building]).is_file():
            continue
        wanted = options.extra.get("seeds" if building == SIX else "others", sizes[options.full])
        seeds = int(wanted)
        tasks += [
            {"building": building, "data": str(data), "seed": options.seed + FIRST_SEED + k}
            for k in range(seeds)
        ]
    experiment = Experiment("detection", tasks, solve, summarise, options.seed, REVISION)
    return run_experiment(experiment, options)


def solve(task: Mapping[str, Any]) -> dict[str, Any]:
    """One drive: what each detector found, missed and made up."""
    # The renderer of the drive before must not let go of its OpenGL context in the midst of this.
    gc.collect()
    drive = Simulation(_plan(task), seed=task["seed"])
    watched = [
        Watched(NetworkDetector(), drive.truth),
        Watched(oracle_of(drive.truth, task["seed"]), drive.truth),
    ]
    stages = Stages(watched)
    system = Pipeline(
        detector=watched[0],
        base_T_lidar=drive.info.base_T_lidar,
        base_T_camera=drive.info.base_T_camera,
    )
    system.objects = stages
    for message in drive.messages():
        if isinstance(message, Scan):
            system.feed(scan=message)
        elif isinstance(message, Frame):
            system.feed(image=message)
        elif isinstance(message, Odometry):
            system.feed(odometry=message)
    system.finish()
    truth = transformed(drive.truth.graph, drive.truth.building_T_map.inverse())
    asked = asked_for(drive.truth)
    found: dict[str, Any] = {}
    for stage, detector in zip(stages.all, watched):
        graph = stage.annotated(system.slam.scene_graph(), system.slam.places(), stages.gaps)
        found[detector.name] = {
            "objects": counts(_asked(graph.objects), truth.objects, asked, CATEGORIES),
            "camera": counts(_asked(_by_camera(graph)), truth.objects, asked, CATEGORIES),
            "frames": detector.scores.row(),
            "ms": 1e3 * float(np.median(detector.seconds)),
            "stage_ms": 1e3 * (sum(stages.seconds[detector.name]) - sum(detector.seconds))
            / max(1, len(detector.seconds)),
        }  # fmt: skip
    return {
        "building": task["building"], "seed": task["seed"], "pictures": len(watched[0].seconds),
        "rooms": len(system.slam.scene_graph().rooms), "detectors": found,
    }  # fmt: skip


class Watched:
    """A detector whose masks are compared with the truth and whose time is taken."""

    def __init__(self, detector: Detector, truth: Truth) -> None:
        self.name = detector.name
        self.categories = detector.categories
        self.scores = FrameScores()
        self.seconds: list[float] = []
        self._detector = detector
        self._truth = truth
        names = sorted({p.object for p in truth.parts if p.object and p.category in CATEGORIES})
        number = {name: k for k, name in enumerate(names, start=1)}
        self._table = np.array([number.get(p.object or "", 0) for p in truth.parts])
        self._category = {number[p.object]: p.category for p in truth.parts if p.object in number}

    def detect(self, rgb: NDArray[np.uint8], stamp: float) -> Sequence[Detection]:
        """What the detector finds; every ``SCORED``-th picture is compared with the truth."""
        started = time.process_time()
        found = self._detector.detect(rgb, stamp)
        self.seconds.append(time.process_time() - started)
        ids = self._truth.id_image(stamp)
        if ids is not None and len(self.seconds) % SCORED == 0:
            image = self._table[ids]
            true = [(self._category[k], image == k) for k in np.unique(image[image > 0]).tolist()]
            self.scores.add(found, true, CATEGORIES)
        return found


class Stages(ObjectStage):
    """Several object stages behind one: each with its own detector, all fed the same views."""

    def __init__(self, detectors: Sequence[Detector]) -> None:
        super().__init__(detectors[0])
        others = [ObjectStage(d) for d in detectors[1:]]
        self.all: list[ObjectStage] = [ObjectStage(detectors[0]), *others]
        self.map = self.all[0].map
        self.gaps: Sequence[WallGap] = ()
        self.seconds: dict[str, list[float]] = {d.name: [] for d in detectors}

    def feed(self, view: View) -> int:
        """Feed all; the number of objects that the first one saw."""
        seen = []
        for stage in self.all:
            assert stage.detector is not None
            started = time.process_time()
            seen.append(stage.feed(view))
            self.seconds[stage.detector.name].append(time.process_time() - started)
        return seen[0]

    def annotated(
        self, graph: SceneGraph, path: NDArray[np.float64], gaps: Sequence[WallGap] = ()
    ) -> SceneGraph:
        """The bare graph: objects are asked for once, at the end, from each stage."""
        self.gaps = gaps
        return graph

    def correct(self, poses: Mapping[str, NDArray[np.float64]]) -> None:
        """Correct all."""
        for stage in self.all:
            stage.correct(poses)


def oracle_of(truth: Truth, seed: int) -> Detector:
    """The oracle with the paper's error rates."""
    made = oracle(truth, seed)
    made.config = PAPER_RATES
    return made


def asked_for(truth: Truth) -> set[str]:
    """The doors and windows of the rooms that the robot was in for a while."""
    stay: dict[str, float] = {}
    for visit in truth.visits:
        stay[visit.room] = stay.get(visit.room, 0.0) + visit.end - visit.start
    return {
        o.id
        for o in truth.graph.objects
        if o.category in CATEGORIES and any(stay.get(r, 0.0) >= STAY for r in o.rooms)
    }


def _asked(objects: Sequence[Object]) -> list[Object]:
    return [o for o in objects if o.category in CATEGORIES]


def _by_camera(graph: SceneGraph) -> list[Object]:
    """The objects that the camera had a part in: not those of the trajectory alone."""
    return [o for o in graph.objects if "vision" in str(o.attributes.get("evidence", ""))]


def _plan(task: Mapping[str, Any]) -> SceneGraph:
    if task["building"] == SIX:
        return six_rooms()
    from situgraph.api import read_plan

    return read_plan(Path(task["data"]) / BUILDINGS[task["building"]])


def summarise(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """By detector, then category, the fused objects in the six rooms.

    Beside: ``camera``, without the doors that the trajectory alone found; ``frames``, single
    pictures; and each other building by name.
    """
    summary: dict[str, Any] = {}
    for detector in DETECTORS:
        mine = [r for r in rows if r["building"] == SIX]
        summary[detector] = {
            **_table(mine, detector),
            "camera": _table(mine, detector, "camera"),
            "frames": _frames(rows, detector),
        }
        for building in BUILDINGS:
            other = [r for r in rows if r["building"] == building]
            if other:
                summary[detector][building] = _table(other, detector)
    return summary


def _table(rows: list[dict[str, Any]], detector: str, which: str = "objects") -> dict[str, Any]:
    parts = [r["detectors"][detector][which] for r in rows]
    table = {c: rates(p[c] for p in parts) for c in CATEGORIES}
    table["all"] = rates(p[c] for p in parts for c in CATEGORIES)
    return table


def _frames(rows: list[dict[str, Any]], detector: str) -> dict[str, Any]:
    """Mask IoU and instance AP by category over all buildings; milliseconds a picture."""
    own = [r["detectors"][detector] for r in rows]
    iou: dict[str, Any] = {}
    precision: dict[str, Any] = {}
    for c in CATEGORIES:
        parts = [o["frames"][c] for o in own if c in o["frames"]]
        iou[c], precision[c] = mask_iou(parts), average_precision(parts)
    return {
        "mask_iou": iou, "instance_ap": precision,
        "ms": float(np.median([o["ms"] for o in own])),
        "stage_ms": float(np.median([o["stage_ms"] for o in own])),
    }  # fmt: skip
