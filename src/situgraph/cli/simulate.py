"""``situgraph simulate``: drive a simulated robot through a building."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from situgraph.cli.options import json_option, seed_option, settings_options

if TYPE_CHECKING:
    from situgraph.config import Settings


@click.command()
@click.argument("building", type=click.Path(path_type=Path))
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    required=True,
    metavar="FOLDER",
    help="Where the recording goes; its ground truth goes to FOLDER/truth.",
)
@click.option("--rooms", metavar="ID,ID,...", help="Rooms to visit, in this order.")
@click.option("--storey", metavar="NAME", help="Visit all rooms of one storey.")
@click.option(
    "--format",
    "kind",
    type=click.Choice(["folder", "ros2"]),
    default="folder",
    show_default=True,
    help="Plain files, or a ROS 2 bag.",
)
@click.option(
    "--moved-walls", type=click.IntRange(min=0), metavar="N", help="Walls not built where planned."
)
@click.option("--no-camera", is_flag=True, help="LiDAR and odometry only.")
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
    building: Path,
    output: Path,
    rooms: str | None,
    storey: str | None,
    kind: Any,
    moved_walls: int | None,
    no_camera: bool,
    renderer: Any,
    seed: int,
    settings: Settings,
    as_json: bool,
) -> None:
    """Drive a simulated robot through BUILDING (a building model or a layout)."""
    import msgspec

    from situgraph.api import load_prior
    from situgraph.cli.console import progress
    from situgraph.sim.record import record
    from situgraph.sim.simulation import Simulation, rooms_on

    if rooms and storey:
        raise click.UsageError("give --rooms or --storey, not both")
    plan = load_prior(building, plan=settings.plan)
    config = settings.sim
    if moved_walls is not None:
        world = msgspec.structs.replace(config.world, moved_walls=moved_walls)
        config = msgspec.structs.replace(config, world=world)
    wanted = rooms_on(plan, storey) if storey else tuple((rooms or "").split(",")) if rooms else ()
    simulation = Simulation(
        plan, config, seed=seed, rooms=wanted, camera=not no_camera, renderer=renderer
    )
    total = sum(simulation.info.counts.values())
    with progress("driving", total, quiet=as_json) as advance:
        record(simulation, output, kind, lambda _: advance())
    _report(simulation, output, as_json)


def _report(simulation: Any, output: Path, as_json: bool) -> None:
    from situgraph.cli.console import console, emit_json
    from situgraph.cli.info import as_dict, show

    summary = as_dict(simulation) | {
        "output": str(output),
        "deviations": [f"{d.kind} {', '.join(d.ids)}" for d in simulation.truth.deviations],
        "visited": [v.room for v in simulation.truth.visits],
    }
    if as_json:
        emit_json(summary)
        return
    show(simulation)
    for deviation in summary["deviations"]:
        console().print(f"deviation: {deviation}", markup=False)
    console().print(f"recording and truth are in {output}", markup=False)
