"""A whole recording through the pipeline: ``run_log`` feeds it and tells what came out."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING

import msgspec

from situgraph.coupling import Deviation, Event
from situgraph.errors import InputError
from situgraph.judging import Judgement
from situgraph.pipeline import Pipeline, State
from situgraph.scenegraph.graph import Warning

if TYPE_CHECKING:
    from situgraph.config import Settings
    from situgraph.io.recording import Message, Recording
    from situgraph.matching.matcher import Semantics
    from situgraph.objects.detections import Detector
    from situgraph.scenegraph.graph import SceneGraph

INTERRUPTED = "interrupted"
Watch = Callable[[int, State], object]


class Run(msgspec.Struct, frozen=True):
    """What a run found and what it cost.

    ``duration`` (s) is that of the log; ``seconds`` are the work's, by stage, ``reading``
    included; ``realtime`` is one divided by the other; ``located_at`` (s since the start) is when
    the match was found that is adopted at the end; ``events`` are all that were adopted, doubted
    or withdrawn; ``deviations`` say what differs from the plan.
    """

    log: str
    duration: float
    scans: int
    keyframes: int
    storeys: int
    rooms: int
    planes: int
    objects: int
    detector: str
    verdict: str | None
    solutions: int | None
    reason: str | None
    located_at: float | None
    seconds: dict[str, float]
    realtime: float
    warnings: tuple[Warning, ...]
    judgement: Judgement | None = None
    events: tuple[Event, ...] = ()
    deviations: tuple[Deviation, ...] = ()


def run_log(
    recording: Recording,
    settings: Settings,
    *,
    plan: SceneGraph | None = None,
    detector: Detector | None = None,
    semantics: Semantics = "likelihood",
    watch: Watch = lambda messages, state: None,
) -> tuple[Run, Pipeline]:
    """Feed a whole recording to a pipeline; ``watch`` is told of each message.

    An interruption (Ctrl-C) ends the recording there: what was found so far is told, with the
    warning ``interrupted``.

    Raises:
        InputError: a part of the recording cannot be used at all, or no scan can.
    """
    info = recording.info
    pipeline = Pipeline(
        plan, settings, detector, base_T_lidar=info.base_T_lidar, base_T_camera=info.base_T_camera,
        semantics=semantics,
    )  # fmt: skip
    begin = time.perf_counter()
    scans, streams = 0, ("scans", "odometry", *(("frames",) if detector else ()))
    notes: tuple[Warning, ...] = ()
    try:
        for count, message in enumerate(recording.messages(streams), start=1):
            scans += feed(pipeline, message)
            watch(count, pipeline.state)
    except KeyboardInterrupt:
        notes = (Warning(INTERRUPTED, f"stopped by hand after {scans} scans"),)
    if not pipeline.slam.keyframes:
        found = next((f"; {w.message}" for w in (*recording.warnings, *pipeline.warnings)), "")
        remedy = "SLAM needs LiDAR scans; `situgraph info LOG` shows what there is"
        raise InputError(info.name, f"holds no usable LiDAR scan{found}", remedy)
    pipeline.finish()
    total = time.perf_counter() - begin
    run = told(recording, pipeline, scans, total)
    if notes:
        driven = pipeline.state.stamp - info.start
        run = msgspec.structs.replace(
            run, duration=driven, realtime=driven / total, warnings=(*notes, *run.warnings)
        )
    return run, pipeline


def feed(pipeline: Pipeline, message: Message) -> bool:
    """Hand one message of a recording to a pipeline; whether it was a scan."""
    from situgraph.io.recording import Frame, Scan

    if isinstance(message, Scan):
        pipeline.feed(scan=message)
        return True
    if isinstance(message, Frame):
        pipeline.feed(image=message)
    else:
        pipeline.feed(odometry=message)
    return False


def told(recording: Recording, pipeline: Pipeline, scans: int, total: float) -> Run:
    """What came of feeding so many ``scans`` of a recording, in ``total`` seconds of work."""
    graph, result, spent = pipeline.graph, pipeline.result, pipeline.seconds
    detector, located, locator = pipeline.objects.detector, pipeline.located, pipeline.locator
    since = None if locator is None else locator.since
    start, duration = recording.info.start, recording.info.duration
    return Run(
        log=recording.info.name,
        duration=duration,
        scans=scans,
        keyframes=len(pipeline.slam.keyframes),
        storeys=len(graph.storeys),
        rooms=len(graph.rooms),
        planes=len(graph.planes),
        objects=len(graph.objects),
        detector="none" if detector is None else detector.name,
        verdict=None if result is None else result.verdict,
        solutions=None if result is None else result.count,
        reason=None if result is None else result.reason,
        located_at=None if since is None else since - start,
        seconds={**spent, "reading": max(total - sum(spent.values()), 0.0)},
        realtime=duration / max(total, 1e-9),
        warnings=(*recording.warnings, *pipeline.warnings),
        events=() if locator is None else tuple(locator.events),
        deviations=() if located is None else located.deviations,
    )
