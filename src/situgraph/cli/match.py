"""``situgraph match``: place an online scene graph in a prior one."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import click

from situgraph.cli.console import console, emit_json, print_table
from situgraph.cli.explain import find_room, print_pair, print_stages
from situgraph.cli.options import json_option, output_option, settings_options
from situgraph.errors import InputError

if TYPE_CHECKING:
    from situgraph.config import Settings
    from situgraph.scenegraph.graph import SceneGraph

PICTURES = (".svg", ".png", ".pdf", ".html")
SHOWN = 10  # solutions listed for people; the JSON holds them all


@click.command()
@click.argument("online", type=click.Path(path_type=Path))
@click.argument("prior", type=click.Path(path_type=Path))
@click.argument("rooms", nargs=-1, metavar="[ROOM PRIOR_ROOM]")
@click.option(
    "--semantics",
    type=click.Choice(["none", "containment", "likelihood"]),
    default="likelihood",
    show_default=True,
    help="What objects count: nothing, the paper's filter, or their likelihood.",
)
@click.option(
    "--part",
    type=click.Choice(["free", "fixed"]),
    help="Part of a .g2o log [default: free of ONLINE, FIXed of PRIOR].",
)
@click.option(
    "--explain",
    is_flag=True,
    help="Say what each stage kept; with ROOM PRIOR_ROOM, how these two compare.",
)
@click.option(
    "--picture",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="Draw the match, or the rivals of an ambiguous one (.svg .png .pdf), or a report (.html).",
)
@output_option("Write the match as JSON to this file.")
@settings_options
@json_option
def command(
    online: Path,
    prior: Path,
    rooms: tuple[str, ...],
    semantics: Literal["none", "containment", "likelihood"],
    part: Literal["free", "fixed"] | None,
    explain: bool,
    picture: Path | None,
    output: Path | None,
    settings: Settings,
    as_json: bool,
) -> None:
    """Place the graph ONLINE in the graph PRIOR: unique, ambiguous or none.

    Both may be scene-graph JSON, IFC, OSM or an S-Graphs .g2o log. The exit code is 0 whatever the
    verdict.
    """
    from situgraph import api
    from situgraph.matching import PlanIndex, match

    if rooms and (len(rooms) != 2 or not explain):
        raise click.UsageError("rooms come in pairs and with --explain: --explain ROOM PRIOR_ROOM")
    if picture is not None and picture.suffix.lower() not in PICTURES:
        raise InputError(picture, "is no kind of picture", f"name it {', '.join(PICTURES)}")
    seen = api.load(online, part, plan=settings.plan)
    planned = api.load_prior(prior, part, plan=settings.plan)
    for path, graph in ((online, seen), (prior, planned)):
        if not graph.rooms:
            raise InputError(path, "has no rooms to match", "match a graph with at least one room")
    pair = (
        (find_room(seen, rooms[0], online), find_room(planned, rooms[1], prior)) if rooms else None
    )
    index = PlanIndex(planned, settings.matching)
    result = match(seen, index, semantics=semantics, config=settings.matching)
    document = result.to_dict()
    if output is not None:
        import msgspec

        from situgraph.scenegraph.files import write_atomic

        write_atomic(output, msgspec.json.format(msgspec.json.encode(document), indent=1) + b"\n")
    if picture is not None:
        _draw(picture, document, seen, planned, settings)
    if as_json:
        emit_json(document)
        return
    _show(document)
    if explain:
        print_stages(document["stats"])
    if pair:
        from situgraph.matching.explanation import explain_pair

        print_pair(document, seen, planned, *pair)
        told = explain_pair(result, pair[0].id, pair[1].id)
        text = f"{pair[0].id} x {pair[1].id}, {told.stage}: {told.sentence}"
        console().print(text, soft_wrap=True, markup=False)


def _draw(
    picture: Path,
    match: dict[str, Any],
    online: SceneGraph,
    prior: SceneGraph,
    settings: Settings,
) -> None:
    from situgraph.view.canvas import save_figure
    from situgraph.view.match import draw_match
    from situgraph.view.match_report import match_report
    from situgraph.view.rivals import draw_rivals

    if picture.suffix.lower() == ".html":
        match_report(match, online, prior, picture, config=settings.view)
        return
    draw = draw_rivals if match["verdict"] == "ambiguous" else draw_match
    save_figure(draw(match, online, prior, settings.view), picture, settings.view.dpi)


def _show(match: dict[str, Any]) -> None:
    """The match for people, on stderr."""
    from rich.markup import escape

    colour = {"unique": "green", "ambiguous": "yellow", "none": "red"}[match["verdict"]]
    certified = ", certified" if match["certified"] else ""
    head = f"[bold {colour}]{match['verdict']}[/]{certified}"
    console().print(f"{head}: {escape(match['reason'])}", soft_wrap=True)
    solutions = match["solutions"]
    print_solutions(solutions, match["count"])
    if solutions:
        _print_best(solutions[0])
    for hint in match.get("disambiguation") or ():
        where = f" on plane {hint['on_plane']}" if hint.get("on_plane") else ""
        text = f"look for a {hint['look_for']}{where} in room {hint['in_room']}: it splits the rest"
        console().print(escape(text), soft_wrap=True)
    seconds = match["stats"]["seconds"]["total"]
    took = f"{seconds:.2f} s" if seconds >= 1 else f"{seconds * 1e3:.2f} ms"
    console().print(f"model: {escape(match['stats']['model'])}; {took}", soft_wrap=True)


def print_solutions(solutions: list[dict[str, Any]], count: int) -> None:
    """The best solutions as a table."""
    rows = [
        (
            number,
            *_place(s["transform"]),
            len(s["rooms"]),
            len(s["planes"]),
            len(s["objects"]),
            f"{s['rms']:.3f}",
            f"{s['probability']:.1%}",
        )
        for number, s in enumerate(solutions[:SHOWN], start=1)
    ]
    if not rows:
        return
    more = f", the best {SHOWN} of {count}" if count > SHOWN else ""
    columns = ("", "x", "y", "z", "yaw", "rooms", "planes", "obj.", "rms", "prob.")
    print_table(f"Placements, map to building (m, deg{more})", columns, rows)


def _place(transform: dict[str, float]) -> tuple[str, ...]:
    return (
        *(f"{transform[axis]:.3f}" for axis in "xyz"),
        f"{math.degrees(transform['yaw']):.2f}",
    )


def _print_best(solution: dict[str, Any]) -> None:
    covers = solution.get("also_covers") or {}
    rooms = [(s, a, ", ".join(covers.get(s, ()))) for s, a in solution["rooms"].items()]
    print_table("Rooms of the best", ("online", "prior", "also covers"), rooms)
    parts = [
        (len(part["rooms"]), *_place(part["transform"]), f"{part['rms']:.3f}")
        for part in solution.get("parts", ())
    ]
    if parts:
        header = ("rooms", "x", "y", "z", "yaw", "rms")
        print_table("Parts of the map, map to building (m, deg)", header, parts)
    if solution["deviations"]:
        moved = [
            (
                d["plane"],
                solution["planes"].get(d["plane"]),
                f"{d['offset']:+.3f}",
                f"{d['sigma']:.3f}",
            )
            for d in solution["deviations"]
        ]
        columns = ("online plane", "prior plane", "offset m", "sigma m")
        print_table("Walls that are not where they were planned", columns, moved)
