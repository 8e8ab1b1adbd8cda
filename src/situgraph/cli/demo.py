"""``situgraph demo``: the whole system on an embedded building; saves a report."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from situgraph.cli.console import console, emit_json, print_table, progress
from situgraph.cli.options import json_option, seed_option, settings_options

if TYPE_CHECKING:
    from situgraph.config import Settings
    from situgraph.demo import Demo


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
@seed_option
@settings_options
@json_option
def command(
    plan: Path | None, output: Path, rooms: int, seed: int, settings: Settings, as_json: bool
) -> None:
    """Locate a robot in a building: with walls alone, and with doors, windows and other objects.

    Without --plan the building is an embedded one of six equal rooms, which is its own half turn:
    walls alone cannot say where the robot is.
    """
    from situgraph.demo import STAGES, run_demo

    with progress("demo", len(STAGES), quiet=as_json) as advance:
        demo = run_demo(
            output, settings, plan=plan, seed=seed, rooms=rooms, advance=lambda _: advance()
        )
    if as_json:
        emit_json(demo)
    else:
        _show(demo)


def _show(demo: Demo) -> None:
    from situgraph.demo import NAMES, table_of

    size = f"{demo.rooms} rooms, {demo.planes} planes, {demo.objects} objects"
    print_table(f"Where is the robot in {demo.building} ({size})?", *table_of(demo.steps))
    for step in demo.steps:
        if step.rooms == demo.shown:
            verdicts = ", ".join(f"{NAMES[a.semantics]}: {a.verdict}" for a in step.answers)
            noun = "room" if step.rooms == 1 else "rooms"
            text = f"After {step.rooms} {noun}: {verdicts}."
            console().print(text, markup=False, soft_wrap=True)
    took = ", ".join(f"{stage} {seconds:.2f}" for stage, seconds in demo.seconds.items())
    console().print(f"Seconds: {took}.", markup=False, soft_wrap=True)
    console().print(f"Report: {demo.files[-1]}", markup=False, soft_wrap=True)
