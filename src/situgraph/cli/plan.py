"""``situgraph plan``: A-Graph from a building model, and what is odd about the model."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from situgraph.cli.console import console, emit_json, print_table, progress
from situgraph.cli.options import json_option, output_option, settings_options

if TYPE_CHECKING:
    from collections.abc import Mapping

    from situgraph.config import Settings
    from situgraph.plan.report import PlanReport
    from situgraph.scenegraph.graph import SceneGraph

SHOWN = 40  # warnings listed for people; the JSON holds them all


@click.command()
@click.argument("building", nargs=-1, required=True, type=click.Path(path_type=Path))
@output_option("Write the A-Graph as scene-graph JSON to this file.")
@click.option(
    "--table", is_flag=True, help="One row a file on stdout: Markdown, or figures with --json."
)
@click.option(
    "--repeat",
    type=click.IntRange(1, 100),
    default=1,
    show_default=True,
    help="Read each file so often; the quickest time counts.",
)
@settings_options
@json_option
def command(
    building: tuple[Path, ...],
    output: Path | None,
    table: bool,
    repeat: int,
    settings: Settings,
    as_json: bool,
) -> None:
    """Read BUILDING (.ifc or .osm) as an A-Graph and say what is odd about the model.

    With --json the A-Graph goes to stdout. Several files may be named with --table. The file is
    read anew, never taken from the cache.
    """
    from situgraph import api
    from situgraph.plan.report import plan_report
    from situgraph.scenegraph.codec import to_dict

    if len(building) > 1 and (output is not None or not table):
        raise click.UsageError("several files only with --table, and without -o")
    reports = []
    with progress("reading", len(building), quiet=as_json) as advance:
        for path in building:
            graph, report = plan_report(path, settings.plan, repeat)
            reports.append(report)
            advance()
    if output is not None:
        api.save(graph, output)
    if as_json:
        emit_json(reports if table else to_dict(graph))
    elif table:
        click.echo(markdown(reports))
    else:
        _show(graph, reports[0], output)


def _show(graph: SceneGraph, report: PlanReport, output: Path | None) -> None:
    source = "derived from walls" if report.rooms_from == "walls" else "from the model"
    rows: list[tuple[str, object]] = [(f"rooms, {source}", report.rooms)]
    rows += [(f"  {storey}", count) for storey, count in report.rooms_by_storey.items()]
    rows += [
        ("planes", report.planes),
        ("  virtual", report.virtual_planes),
        ("perimeter", _perimeter(report, " with a wall behind")),
    ]
    for category, count in report.objects.items():
        rows.append((f"{category} objects", count))
        for relation, number in report.opening_relations.get(category, {}).items():
            rooms, planes = relation.split("/")
            rows.append((f"  in {rooms} rooms, on {planes} planes", number))
        agreement = report.boundaries.get(category, {})
        if agreement.get("checked"):
            text = f"{agreement['agreed']} of {agreement['checked']}"
            rows.append(("  agree with space boundaries", text))
    rows += [
        (
            "read in",
            f"{report.seconds:.2f} s ({report.cpu_seconds:.2f} s of CPU), {report.peak_mb:.0f} MB",
        )
    ]
    print_table(report.name, ("what", "found"), [(what, str(found)) for what, found in rows])
    _show_warnings(graph, report)
    if output is not None:
        console().print(f"written to {output}", markup=False, soft_wrap=True)


def _show_warnings(graph: SceneGraph, report: PlanReport) -> None:
    if not graph.warnings:
        console().print("no warnings")
        return
    counts = ", ".join(f"{code} {count}" for code, count in report.warnings.items())
    rows = [(w.code, w.message) for w in graph.warnings[:SHOWN]]
    print_table(f"{len(graph.warnings)} warnings: {counts}", ("code", "message"), rows)
    if len(graph.warnings) > SHOWN:
        console().print(f"and {len(graph.warnings) - SHOWN} more, all in the JSON")


def markdown(reports: list[PlanReport]) -> str:
    """The reports as a Markdown table."""
    head = (
        "file", "storeys", "rooms", "planes (virtual)", "perimeter backed", "doors: rooms/planes",
        "windows: rooms/planes", "boundaries agree: doors, windows", "warnings", "s", "CPU s", "MB",
    )  # fmt: skip
    lines = [f"| {' | '.join(head)} |", f"|{'---|' * len(head)}"]
    for r in reports:
        derived = " (derived)" if r.rooms_from == "walls" else ""
        cells = (
            r.name,
            str(len(r.rooms_by_storey)),
            f"{r.rooms}{derived}",
            f"{r.planes} ({r.virtual_planes})",
            _perimeter(r),
            _counts(r.opening_relations["door"]),
            _counts(r.opening_relations["window"]) or "-",
            ", ".join(_agreement(r, category) for category in ("door", "window")),
            _counts(r.warnings) or "none",
            f"{r.seconds:.2f}",
            f"{r.cpu_seconds:.2f}",
            f"{r.peak_mb:.0f}",
        )
        lines.append(f"| {' | '.join(cell.replace('|', '/') for cell in cells)} |")
    return "\n".join(lines)


def _perimeter(report: PlanReport, what: str = "") -> str:
    share = "" if report.backed is None else f", {report.backed:.1%}{what}"
    return f"{report.perimeter:.0f} m{share}"


def _counts(counts: Mapping[str, int]) -> str:
    return ", ".join(f"{key}: {count}" for key, count in counts.items())


def _agreement(report: PlanReport, category: str) -> str:
    found = report.boundaries[category]
    return f"{found['agreed']}/{found['checked']}" if found["checked"] else "-"
