"""``situgraph demo``: the whole system on an embedded building; saves a report."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from situgraph.cli.console import console, emit_json, print_table, progress
from situgraph.cli.options import json_option, seed_option, settings_options

if TYPE_CHECKING:
    from situgraph.config import Settings
    from situgraph.demo import Demo
    from situgraph.demo_drive import DriveDemo


@click.command()
@click.option(
    "--plan", type=click.Path(path_type=Path), metavar="FILE", help="Your building, not ours."
)
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    default=Path("situgraph-demo"),
    show_default=True,
    metavar="FOLDER",
    help="Where the report and its files go.",
)
@click.option(
    "--rooms",
    type=click.IntRange(1, 1000),
    default=6,
    show_default=True,
    help="How many rooms the robot sees at most.",
)
@click.option(
    "--sampled", is_flag=True, help="Sample what the robot sees: no sensors, a few seconds."
)
@click.option(
    "--renderer",
    type=click.Choice(["auto", "gl", "cpu"]),
    default="auto",
    show_default=True,
    help="Who draws the camera's images.",
)
@seed_option
@settings_options
@json_option
def command(
    plan: Path | None,
    output: Path,
    rooms: int,
    sampled: bool,
    renderer: Any,
    seed: int,
    settings: Settings,
    as_json: bool,
) -> None:
    """Locate a robot in a building: with walls alone, and with doors, windows and other objects.

    A simulated robot with LiDAR and RGB-D camera drives through the building, and the whole system
    finds out where it is. Without --plan the building is an embedded one of six equal rooms, which
    is its own half turn: walls alone cannot say where the robot is.
    """
    if sampled:
        demo = _sampled(plan, output, rooms, seed, settings, as_json)
        if not as_json:
            _show(demo)
        return
    from situgraph.cli.status import live
    from situgraph.demo_drive import run_drive

    if not as_json:
        console().print("a simulated robot sets out (about a minute)", markup=False)
    # The number of messages is known once the drive is planned; a drive has some ten thousand.
    with live(0, quiet=as_json) as watch:
        drive = run_drive(
            output, settings, plan=plan, seed=seed, rooms=rooms, renderer=renderer,
            watch=lambda done, total, state: watch(done, state),
        )  # fmt: skip
    if as_json:
        import msgspec

        emit_json(msgspec.to_builtins(drive))
        return
    _show_drive(drive)


def _sampled(
    plan: Path | None, output: Path, rooms: int, seed: int, settings: Settings, as_json: bool
) -> Demo:
    from situgraph.demo import STAGES, run_demo

    with progress("demo", len(STAGES), quiet=as_json) as advance:
        demo = run_demo(
            output, settings, plan=plan, seed=seed, rooms=rooms, advance=lambda _: advance()
        )
    if as_json:
        emit_json(demo)
    return demo


def _show_drive(demo: DriveDemo) -> None:
    from situgraph.cli.run import show

    _story(demo)
    run = demo.run
    if run.located_at is None:
        console().print("It never knew for sure where it was.", markup=False)
    else:
        text = f"It knew where it was after {run.located_at:.1f} s of {run.duration:.0f} s."
        console().print(text, markup=False, soft_wrap=True)
    show(run)
    text = f"Camera: {demo.renderer}. Detector: {run.detector}."
    console().print(text, markup=False, soft_wrap=True)
    _ending(demo)


def _show(demo: Demo) -> None:
    _story(demo)
    console().print("What the robot saw was sampled, not measured.", markup=False)
    _ending(demo)


def _story(demo: Demo | DriveDemo) -> None:
    from situgraph.demo import NAMES, table_of

    size = f"{demo.rooms} rooms, {demo.planes} planes, {demo.objects} objects"
    print_table(f"Where is the robot in {demo.building} ({size})?", *table_of(demo.steps))
    for step in demo.steps:
        if step.rooms == demo.shown:
            verdicts = ", ".join(f"{NAMES[a.semantics]}: {a.verdict}" for a in step.answers)
            noun = "room" if step.rooms == 1 else "rooms"
            text = f"After {step.rooms} {noun}: {verdicts}."
            console().print(text, markup=False, soft_wrap=True)


def _ending(demo: Demo | DriveDemo) -> None:
    took = ", ".join(f"{stage} {seconds:.2f}" for stage, seconds in demo.seconds.items())
    console().print(f"Seconds: {took}.", markup=False, soft_wrap=True)
    report = next(f for f in demo.files if f.endswith("report.html"))
    console().print(f"Report: {report}", markup=False, soft_wrap=True)
