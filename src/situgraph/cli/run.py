"""``situgraph run``: SLAM, objects, matching and coupling on a recording."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from situgraph.cli.console import console, emit_json, print_table
from situgraph.cli.options import json_option, output_option, seed_option, settings_options

if TYPE_CHECKING:
    from situgraph.config import Settings
    from situgraph.run import Run


@click.command()
@click.argument("log", type=click.Path(path_type=Path))
@click.option(
    "--plan", type=click.Path(path_type=Path), metavar="FILE", help="The building to be located in."
)
@output_option("Folder for the results [default: LOG's name with -run].")
@click.option(
    "--detector",
    metavar="NAME",
    help="network, oracle (simulated logs only), none, or an ONNX file "
    "[default: network where its model and images are there].",
)
@click.option(
    "--semantics",
    type=click.Choice(["none", "containment", "likelihood"]),
    default="likelihood",
    show_default=True,
    help="How the match uses objects.",
)
@click.option(
    "--topic",
    "topics",
    multiple=True,
    metavar="ROLE=TOPIC",
    help="A bag's topic for lidar, rgb, depth, camera_info or odometry; may be repeated.",
)
@seed_option
@settings_options
@json_option
def command(
    log: Path,
    plan: Path | None,
    output: Path | None,
    detector: str | None,
    semantics: Any,
    topics: tuple[str, ...],
    seed: int,
    settings: Settings,
    as_json: bool,
) -> None:
    """Map the recording LOG, and with --plan say where in the building the robot was."""
    import msgspec

    from situgraph.api import read_plan
    from situgraph.cli.status import live
    from situgraph.detectors import default_detector, make_detector
    from situgraph.io.recording import open_recording
    from situgraph.judging import judged
    from situgraph.run import INTERRUPTED, run_log
    from situgraph.run_folder import save_run
    from situgraph.side_by_side import FILE, save_beside, table

    pairs = [t.partition("=") for t in topics]
    if any(not equals for _, equals, _ in pairs):
        raise click.UsageError("--topic takes ROLE=TOPIC, e.g. lidar=/points")
    recording = open_recording(log, topics={role: name for role, _, name in pairs})
    prior = None if plan is None else read_plan(plan, settings.plan)
    chosen = detector or default_detector(recording.info)
    sees = make_detector(chosen, log, seed=seed)
    total = sum(n for n in recording.info.counts.values() if n > 0)
    with live(total, quiet=as_json) as watch:
        run, pipeline = run_log(
            recording, settings, plan=prior, detector=sees, semantics=semantics, watch=watch
        )
    run = judged(run, pipeline, log)
    folder = output or Path(f"{log.resolve().name}-run")
    files = save_run(folder, run, pipeline, settings, prior)
    beside = save_beside(recording, log, pipeline, folder)
    files += () if beside is None else (FILE,)
    if as_json:
        found = {"folder": str(folder), "files": files}
        emit_json(msgspec.to_builtins(run) | found | ({"other": beside} if beside else {}))
        return
    show(run)
    if beside is not None:
        print_table("The other system's map and ours", *table(beside))
    console().print(f"results are in {folder}: {', '.join(files)}", markup=False, soft_wrap=True)
    if any(w.code == INTERRUPTED for w in run.warnings):
        raise click.Abort


def show(run: Run) -> None:
    """Print what a run found as a table, then its verdict and warnings."""
    rows: list[tuple[str, str]] = [
        ("log", f"{run.duration:.1f} s, {run.scans} scans"),
        ("map", _map(run)),
        ("objects", f"{run.objects} (detector: {run.detector})"),
    ]
    if run.judgement is not None:
        j = run.judgement
        rows += [
            ("trajectory error", f"{j.ate_rmse:.3f} m rms, {j.ate_largest:.3f} m at most (truth)"),
            ("wall offset error", f"{100 * j.wall_offset_median:.1f} cm median (truth)"),
            ("rooms", f"precision {j.room_precision:.2f}, recall {j.room_recall:.2f} (truth)"),
        ]
        if j.ate_building_rmse is not None and j.ate_building_largest is not None:
            rows.append(
                (
                    "in the building",
                    f"{j.ate_building_rmse:.3f} m rms, {j.ate_building_largest:.3f} m at most "
                    "(truth)",
                )
            )
        if j.placement_error is not None:
            right = "right" if j.placement_right else "WRONG"
            rows.append(
                ("placement", f"{right}, best one off by {j.placement_error:.3f} m (truth)")
            )
    spent = ", ".join(f"{stage} {seconds:.1f}" for stage, seconds in run.seconds.items())
    rows.append(("seconds", f"{spent}; {run.realtime:.1f} times real time"))
    print_table(run.log, ("", "value"), rows)
    for warning in run.warnings:
        console().print(f"warning: {warning.code}: {warning.message}", markup=False, soft_wrap=True)
    if run.deviations:
        lines = [(d.kind.replace("object", d.category), d.message) for d in run.deviations]
        print_table("What differs from the plan", ("", "in words"), lines)
    for event in run.events:
        if event.happening in ("doubted", "withdrawn"):
            text = f"{event.happening} with {event.rooms} rooms: {event.reason}"
            console().print(text, markup=False, soft_wrap=True)
    if run.verdict is not None:
        since = "" if run.located_at is None else f"; located after {run.located_at:.1f} s"
        text = f"{run.verdict}: {run.reason}{since}"
        console().print(text, markup=False, soft_wrap=True)


def _map(run: Run) -> str:
    return (
        f"{run.rooms} rooms, {run.planes} planes, {run.storeys} storeys, {run.keyframes} keyframes"
    )
