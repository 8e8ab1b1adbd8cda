"""What a run says about the building, once located: trajectory, deviations, issues, report."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np

if TYPE_CHECKING:
    from situgraph.config import Settings
    from situgraph.coupling import Located
    from situgraph.geometry.poses import Array
    from situgraph.pipeline import Pipeline
    from situgraph.run import Run
    from situgraph.scenegraph.graph import SceneGraph
    from situgraph.view.report import Report

NAMES = ("located.json", "building.json", "trajectory_building.tum", "deviations.bcfzip")
DEVIATION_COLUMNS = ("", "what", "where", "offset", "deviation", "tilt", "element", "in words")
HAPPENED = {
    "located": "located",
    "doubted": "in doubt",
    "confirmed": "sure again",
    "withdrawn": "withdrawn",
}


def save_located(
    target: Path, run: Run, pipeline: Pipeline, settings: Settings, plan: SceneGraph
) -> list[str]:
    """Write ``located.json``, ``building.json`` (the S-Graph in the building), the trajectory and
    ``deviations.bcfzip`` into ``target``, pictures too; returns their names.

    Raises:
        InputError: the folder cannot be written to.
    """  # noqa: D205
    from situgraph.coupling import write_bcf
    from situgraph.io.tum import write_tum
    from situgraph.scenegraph.codec import write_json
    from situgraph.scenegraph.files import write_atomic
    from situgraph.view import draw_deviations, draw_track, save_figure

    located, view = pipeline.located, settings.view
    assert located is not None
    document = located.to_dict()
    write_atomic(
        target / "located.json", msgspec.json.format(msgspec.json.encode(document), indent=1)
    )
    write_json(located.graph.replace(name=run.log), target / "building.json")
    stamps, poses = building_trajectory(pipeline, located)
    write_tum(target / "trajectory_building.tum", stamps, poses)
    write_bcf(located.deviations, plan, target / "deviations.bcfzip", created=_date(stamps))
    since = None if pipeline.locator is None else pipeline.locator.since
    figures = {
        "track.png": draw_track(plan, stamps, poses[:, :3], view, located=since),
        "deviations.png": draw_deviations(plan, document["deviations"], located.graph, view),
    }
    for name, figure in figures.items():
        save_figure(figure, target / name, view.dpi)
    return [*NAMES, *figures]


def building_trajectory(pipeline: Pipeline, located: Located) -> tuple[Array, Array]:
    """Stamps (n,) and poses (n, 7) of base in the building."""
    stamps, poses = pipeline.slam.trajectory()
    return stamps, located.carrier.trajectory(stamps, poses)


def tell_located(
    report: Report, run: Run, pipeline: Pipeline, plan: SceneGraph, settings: Settings
) -> None:
    """Add to a report where the robot was, when it knew and what differs from the plan."""
    from situgraph.view import Status, draw_history, draw_track

    located, view = pipeline.located, settings.view
    start = pipeline.history[0].stamp if pipeline.history else 0.0
    if located is not None:
        stamps, poses = building_trajectory(pipeline, located)
        since = None if pipeline.locator is None else pipeline.locator.since
        where = report.section("Where the robot was")
        where.picture(
            draw_track(plan, stamps, poses[:, :3], view, located=since, heading=False),
            "The trajectory in the building, its colour telling the time.",
        )
    knew = report.section("When it knew")
    history = [
        Status(s.stamp, s.rooms, s.objects, s.solutions or 0, s.verdict or "")
        for s in pipeline.history
    ]
    knew.picture(draw_history(history, title=""), "Rooms, objects and placements that fit.")
    events = [] if pipeline.locator is None else pipeline.locator.events
    rows = [(f"{e.stamp - start:.1f} s", e.rooms, HAPPENED[e.happening], e.reason) for e in events]
    if rows:
        knew.table(("after", "rooms", "", "why"), rows)
    else:
        knew.text("It never knew: no match was unique.")
    if located is not None:
        _tell_deviations(report, located, plan, settings)
    costs = report.section("What it cost")
    costs.text(
        f"{run.duration:.0f} s of log in {sum(run.seconds.values()):.0f} s: "
        f"{run.realtime:.1f} times real time. Detector: {run.detector}."
    )
    costs.timings(run.seconds, "Time by stage")


def _tell_deviations(
    report: Report, located: Located, plan: SceneGraph, settings: Settings
) -> None:
    from situgraph.view import draw_deviations

    section = report.section("As built, against the plan")
    walls = located.coupled.walls
    rms = 100.0 * located.coupled.rms
    section.text(
        f"{len(walls)} faces of walls were associated with the plan; those that stand where they "
        f"were planned do so within {rms:.1f} cm (rms). Offsets are positive along the planned "
        "normal into the room. Doors and windows that were not found may have been overlooked."
    )
    document = [msgspec.to_builtins(d) for d in located.deviations]
    section.picture(
        draw_deviations(plan, document, located.graph, settings.view, heading=False),
        "Faces as seen, over the plan; numbers as in the table.",
    )
    if document:
        section.table(DEVIATION_COLUMNS, deviation_rows(document, plan))
    else:
        section.text("Nothing differs from the plan by more than can be told.")


def deviation_rows(deviations: list[dict[str, Any]], plan: SceneGraph) -> list[tuple[Any, ...]]:
    """Deviations (as JSON) for people, a row each, for ``DEVIATION_COLUMNS``."""
    rows = []
    for number, d in enumerate(deviations, start=1):
        offset, sigma, tilt = d.get("offset"), d.get("sigma"), d.get("tilt")
        names = [plan.room_by_id[r].name or r for r in d.get("rooms", ()) if r in plan.room_by_id]
        rows.append(
            (
                number,
                d["kind"].replace("object", d["category"]).replace("-", " "),
                ", ".join(names),
                None if offset is None else f"{100.0 * offset:+.1f} cm",
                None if sigma is None else f"± {100.0 * sigma:.1f} cm",
                None if tilt is None else f"{math.degrees(tilt):+.1f}°",
                d.get("element"),
                d["message"],
            )
        )
    return rows


def _date(stamps: Array) -> str:
    """The day of the recording; 1970 where its clock did not tell."""
    import datetime

    last = float(stamps[-1]) if len(stamps) else 0.0
    zone = datetime.UTC
    moment = datetime.datetime.fromtimestamp(last if np.isfinite(last) else 0.0, zone)
    return moment.replace(microsecond=0).isoformat().replace("+00:00", "Z")
