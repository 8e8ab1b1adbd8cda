"""``situgraph info``: what a recording holds."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from situgraph.cli.options import json_option

if TYPE_CHECKING:
    from situgraph.io.recording import Recording


@click.command()
@click.argument("log", type=click.Path(path_type=Path))
@click.option("--read", is_flag=True, help="Read all messages and report what is odd in them.")
@click.option(
    "--topic",
    "topics",
    multiple=True,
    metavar="ROLE=TOPIC",
    help="A bag's topic for lidar, rgb, depth, camera_info or odometry; may be repeated.",
)
@json_option
def command(log: Path, read: bool, topics: tuple[str, ...], as_json: bool) -> None:
    """Show what LOG (a recording or a ROS bag) holds."""
    from situgraph.cli.console import emit_json, progress
    from situgraph.io.recording import open_recording

    pairs = [t.partition("=") for t in topics]
    if any(not equals for _, equals, _ in pairs):
        raise click.UsageError("--topic takes ROLE=TOPIC, e.g. lidar=/points")
    recording = open_recording(log, topics={role: name for role, _, name in pairs})
    read_counts: dict[str, int] | None = None
    if read:
        read_counts = {}
        with progress("reading", sum(recording.info.counts.values()), quiet=as_json) as advance:
            for message in recording.messages():
                name = type(message).__name__.lower()
                read_counts[name] = read_counts.get(name, 0) + 1
                advance()
    if as_json:
        emit_json(as_dict(recording) | ({"read": read_counts} if read else {}))
    else:
        show(recording)


def as_dict(recording: Recording) -> dict[str, Any]:
    """A recording's facts as JSON."""
    info = recording.info
    return {
        "name": info.name,
        "kind": info.kind,
        "start": info.start,
        "duration": info.duration,
        "counts": dict(info.counts),
        "base_T_lidar": info.base_T_lidar,
        "base_T_camera": info.base_T_camera,
        "sensors": dict(info.sensors),
        "warnings": [{"code": w.code, "message": w.message} for w in recording.warnings],
    }


def show(recording: Recording) -> None:
    """Print a recording's facts as a table, and its warnings."""
    from situgraph.cli.console import console, print_table

    info = recording.info
    rows: list[tuple[str, object]] = [
        ("kind", info.kind),
        ("start", f"{info.start:.3f} s"),
        ("duration", f"{info.duration:.1f} s"),
        ("messages", ", ".join(_count(name, n) for name, n in info.counts.items())),
        *info.sensors.items(),
        ("lidar in base", _pose(info.base_T_lidar)),
        ("camera in base", _pose(info.base_T_camera)),
    ]
    print_table(
        info.name, ("", "value"), [(name, str(value)) for name, value in rows if value != ""]
    )
    for warning in recording.warnings:
        console().print(f"warning: {warning.code}: {warning.message}", markup=False)


def _count(name: str, count: int) -> str:
    return f"{count} {name}" if count >= 0 else f"{name} of unknown number"


def _pose(pose: tuple[float, ...] | None) -> str:
    return "" if pose is None else " ".join(f"{v:.3f}" for v in pose)
