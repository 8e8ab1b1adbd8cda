"""The demo: a robot with LiDAR and RGB-D camera drives through a building and finds out where.

The whole system runs while the simulator drives: nothing is recorded first. The truth is used only
to say whether the answers are right.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import msgspec
import numpy as np

from situgraph.demo import (
    NAMES,
    POLICIES,
    Policy,
    Step,
    answers_of,
    authored,
    read_rooms,
    refusals,
    table_of,
    telling,
)
from situgraph.run import Run

if TYPE_CHECKING:
    from situgraph.config import Settings
    from situgraph.geometry.poses import Placement
    from situgraph.matching import MatchResult, PlanIndex
    from situgraph.pipeline import Pipeline, State
    from situgraph.scenegraph.graph import SceneGraph
    from situgraph.sim.simulation import Simulation
    from situgraph.view.report import Report

Renderer = Literal["auto", "gl", "cpu"]
Watch = Callable[[int, int, "State"], object]


class DriveDemo(msgspec.Struct, frozen=True):
    """What the demo did.

    ``steps`` are the answers with so many rooms known, walls alone and with objects; ``shown`` and
    ``shown_policy`` the first that walls alone do not give; ``run`` is the live system's; the
    ``renderer`` says what drew the camera's images.
    """

    building: str
    rooms: int
    planes: int
    objects: int
    renderer: str
    shown: int
    shown_policy: str
    steps: tuple[Step, ...]
    run: Run
    seconds: dict[str, float]
    files: tuple[str, ...]


def run_drive(
    folder: str | os.PathLike[str],
    settings: Settings,
    *,
    plan: str | os.PathLike[str] | None = None,
    seed: int = 0,
    rooms: int = 6,
    renderer: Renderer = "auto",
    watch: Watch = lambda done, total, state: None,
) -> DriveDemo:
    """Run the demo and leave its files in ``folder``: those of a run, and the building's model.

    Args:
        folder: made where it does not exist; files of an earlier demo in it are replaced.
        settings: those of all stages.
        plan: a building model of the user's; None authors the embedded six-room building.
        seed: where the robot starts, its noise, and how the building looks.
        rooms: how many rooms it visits at most.
        renderer: who draws the camera's images.
        watch: told of each message: how many are done, how many there are, what is known.

    Raises:
        InputError: the plan cannot be read or driven through, or the folder cannot be written.
    """
    from situgraph.detectors import default_detector, make_detector
    from situgraph.judging import judged_by
    from situgraph.matching import PlanIndex
    from situgraph.pipeline import Pipeline
    from situgraph.run import feed, told
    from situgraph.run_folder import save_run

    begin = time.perf_counter()
    target = Path(folder)
    source = Path(plan) if plan is not None else authored(target)
    prior = read_rooms(source, settings)
    index = PlanIndex(prior, settings.matching)
    _warm(prior, index)
    drive = _drive(prior, settings, seed, rooms, renderer)
    info = drive.info
    system = Pipeline(
        index,
        settings,
        make_detector(default_detector(info), ""),
        base_T_lidar=info.base_T_lidar,
        base_T_camera=info.base_T_camera,
    )
    steps = _Steps(index, drive.truth.building_T_map)
    ready = time.perf_counter()
    total, scans, work = sum(info.counts.values()), 0, 0.0
    for done, message in enumerate(drive.messages(), start=1):
        before = time.perf_counter()
        scans += feed(system, message)
        work += time.perf_counter() - before
        steps.look(system)
        watch(done, total, system.state)
    system.finish()
    steps.look(system)
    driven = time.perf_counter()
    run = judged_by(told(drive, system, scans, work), system, drive.truth)
    story = steps.done()
    files = save_run(target, run, system, settings, prior, [lambda r: _tell(r, story, drive)])
    shown, policy = telling(list(story))
    written = [source.name] if plan is None else []
    return DriveDemo(
        building=prior.name or source.stem,
        rooms=len(prior.rooms),
        planes=len(prior.planes),
        objects=len(prior.objects),
        renderer=info.sensors.get("camera", "none"),
        shown=shown,
        shown_policy=policy,
        steps=story,
        run=run,
        seconds={
            "preparing": ready - begin,
            "simulating": driven - ready - work,
            "locating": work,
            "report": time.perf_counter() - driven,
        },
        files=tuple(str(target / name) for name in (*written, *files)),
    )


def _drive(
    prior: SceneGraph, settings: Settings, seed: int, rooms: int, renderer: Renderer
) -> Simulation:
    """A drive through the first rooms of the plan in their order, doors permitting."""
    from situgraph.sim.simulation import Simulation

    able = [r.id for r in prior.rooms if r.footprint]
    storey = prior.room_by_id[able[0]].storey if able else None
    visited = [r for r in able if prior.room_by_id[r].storey == storey][:rooms]
    return Simulation(prior, settings.sim, seed=seed, rooms=visited, renderer=renderer)


def _warm(prior: SceneGraph, index: PlanIndex) -> None:
    """A match of each kind that is not used: where code is compiled, that is done before it."""
    from situgraph.matching import match

    room = prior.rooms[0].id
    there = [msgspec.structs.replace(o, rooms=(room,)) for o in prior.objects if room in o.rooms]
    view = prior.replace(rooms=prior.rooms[:1], objects=tuple(there))
    for policy in POLICIES:
        match(view, index, semantics=policy)


class _Steps:
    """The answers of all policies for each number of rooms, the last while there were so many."""

    def __init__(self, index: PlanIndex, truth: Placement) -> None:
        self._index = index
        self._truth = truth
        self._seen = 0
        self._found: dict[int, Step] = {}

    def look(self, system: Pipeline) -> None:
        """Match again where the system did."""
        if len(system.history) == self._seen or not system.graph.rooms:
            return
        self._seen = len(system.history)
        graph = system.graph
        center = np.mean([r.center for r in graph.rooms], axis=0)
        answers = answers_of([self._match(graph, p) for p in POLICIES], self._truth, center)
        self._found[len(graph.rooms)] = Step(len(graph.rooms), len(graph.objects), answers)

    def done(self) -> tuple[Step, ...]:
        """In the order of the rooms."""
        return tuple(self._found[k] for k in sorted(self._found))

    def _match(self, graph: SceneGraph, policy: Policy) -> MatchResult:
        from situgraph.matching import match

        return match(graph, self._index, semantics=policy)


def _tell(report: Report, steps: tuple[Step, ...], drive: Simulation) -> None:
    """Room by room, with walls alone and with objects."""
    section = report.section("Room by room")
    section.text(
        f"The same drive, matched after each room: {', '.join(NAMES[p] for p in POLICIES)}. "
        "Numbers in brackets count the placements that fit. The sensors were simulated; "
        f"camera: {drive.info.sensors.get('camera', 'none')}."
    )
    section.table(*table_of(steps))
    refused = refusals(steps)
    if refused:
        section.text(refused)
