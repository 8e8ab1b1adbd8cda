"""``situgraph view``: look at a graph, a match or a run."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import click

from situgraph.cli.console import console, emit_json
from situgraph.cli.options import json_option, output_option, settings_options

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from situgraph.config import Settings
    from situgraph.scenegraph.graph import SceneGraph

MAX_MATCH_BYTES = 500_000_000  # ten thousand solutions of fifty rooms
_HEAD = 65_536  # bytes in which a match JSON names its format


@click.command()
@click.argument("file", type=click.Path(path_type=Path))
@output_option("Write this file: .html (default, a report), .svg, .png or .pdf.")
@click.option("--storey", "storeys", multiple=True, help="Only this storey; may be repeated.")
@click.option("--online", type=click.Path(path_type=Path), help="Of a match: the online graph.")
@click.option("--prior", type=click.Path(path_type=Path), help="Of a match: the prior graph.")
@click.option(
    "--show",
    type=click.Choice(["best", "rivals", "advice"]),
    default="best",
    show_default=True,
    help="Of a match, as .svg, .png or .pdf: which picture.",
)
@click.option("--part", type=click.Choice(["free", "fixed"]), help="Which part of a .g2o log.")
@click.option("--open", "open_it", is_flag=True, help="Open the file when it is written.")
@settings_options
@json_option
def command(
    file: Path,
    output: Path | None,
    storeys: tuple[str, ...],
    online: Path | None,
    prior: Path | None,
    show: Literal["best", "rivals", "advice"],
    part: Literal["free", "fixed"] | None,
    open_it: bool,
    settings: Settings,
    as_json: bool,
) -> None:
    """Draw FILE: a graph of any readable kind, a match JSON, or a run's folder.

    The picture is written to the current folder unless -o names a file. A match needs its two
    graphs: name them with --online and --prior.
    """
    source = _in_folder(file) if file.is_dir() else file
    target = output or Path(f"{file.resolve().stem}.html")
    match = _match(source)
    if source.suffix == ".html":
        kind, written = "report", source if output is None else _copied(source, output)
    elif match is not None:
        kind = "match"
        graphs = _graphs(source, match, online, prior, part, settings)
        written = _draw_match(match, graphs, target, show, settings)
    else:
        kind, written = "graph", _draw_graph(source, target, part, storeys, settings)
    if as_json:
        emit_json({"file": str(file), "kind": kind, "written": str(written)})
    else:
        console().print(f"{kind}: {written}", markup=False, soft_wrap=True)
    if open_it:
        click.launch(str(written))


def _in_folder(folder: Path) -> Path:
    """What to look at in a run's folder: its report, else its match or graph."""
    from situgraph.errors import InputError

    for name in ("report.html", "match.json", "online.json", "graph.json"):
        if (folder / name).is_file():
            return folder / name
    raise InputError(
        folder, "holds no report.html, match.json or online.json", "name a run's folder or a file"
    )


def _copied(source: Path, output: Path) -> Path:
    from situgraph.scenegraph.files import write_atomic

    return write_atomic(output, source.read_bytes())


def _match(file: Path) -> dict[str, Any] | None:
    """The match in a file, or None where the file holds something else."""
    import json

    from situgraph.errors import InputError

    try:
        with open(file, "rb") as stream:
            if b'"situgraph/match"' not in stream.read(_HEAD):
                return None
            stream.seek(0)
            data = stream.read(MAX_MATCH_BYTES + 1)
    except OSError:
        return None  # reading it as a graph says what is wrong
    if len(data) > MAX_MATCH_BYTES:
        raise InputError(file, "is too large for a match JSON", "repeat the match")
    try:
        found = json.loads(data)
    except (ValueError, RecursionError) as error:
        raise InputError(file, f"is not JSON ({error})", "repeat the match") from error
    is_match = isinstance(found, dict) and found.get("format") == "situgraph/match"
    return found if is_match else None


def _graphs(
    file: Path,
    match: dict[str, Any],
    online: Path | None,
    prior: Path | None,
    part: Literal["free", "fixed"] | None,
    settings: Settings,
) -> tuple[SceneGraph, SceneGraph]:
    """The two graphs of a match: as named, or as the match itself names them, beside it."""
    from situgraph import api
    from situgraph.errors import InputError

    paths = []
    for option, given in (("online", online), ("prior", prior)):
        named = match.get(option)
        if given is None and not isinstance(named, str):
            raise InputError(
                file, f"does not say which {option} graph it is of", f"add --{option} FILE"
            )
        paths.append(given or file.parent / str(named))
    seen = api.load(paths[0], part, plan=settings.plan)
    return seen, api.load_prior(paths[1], part, plan=settings.plan)


def _draw_graph(
    source: Path,
    target: Path,
    part: Literal["free", "fixed"] | None,
    storeys: tuple[str, ...],
    settings: Settings,
) -> Path:
    from situgraph import api, view

    config, graph = settings.view, api.load(source, part, plan=settings.plan)
    if target.suffix.lower() in (".html", ".htm"):
        return view.graph_report(graph, target, storeys=storeys, config=config)
    return view.save_figure(view.draw_graph(graph, config, storeys=storeys), target, config.dpi)


def _draw_match(
    match: dict[str, Any],
    graphs: tuple[SceneGraph, SceneGraph],
    target: Path,
    show: Literal["best", "rivals", "advice"],
    settings: Settings,
) -> Path:
    from situgraph import view

    config = settings.view
    if target.suffix.lower() in (".html", ".htm"):
        return view.match_report(match, *graphs, target, config=config)
    figure: Figure
    if show == "best":
        figure = view.draw_match(match, *graphs, config)
    elif show == "rivals":
        figure = view.draw_rivals(match, *graphs, config)
    else:
        figure = view.draw_advice(match, *graphs, config)
    return view.save_figure(figure, target, config.dpi)
