"""``situgraph experiment NAME``: run one of the experiments and keep its results."""

from __future__ import annotations

import importlib
import importlib.util
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from situgraph.cli.console import counter, emit_json, print_table
from situgraph.cli.options import json_option, output_option, seed_option

if TYPE_CHECKING:
    from situgraph.experiments.results import ExperimentResult
    from situgraph.experiments.runner import RunOptions

# name -> what it shows; module situgraph.experiments.<name> defines `run(options)`.
EXPERIMENTS = {
    "matching": "solutions and time over rooms, objects and symmetry (the paper's figure)",
    "advice": "rooms until unique when the advice of an ambiguous match is followed",
    "exploration": "seconds of exploration until the match is unique (the paper's table I)",
    "detection": "precision and recall of doors and windows (the paper's table II)",
    "relations": "objects in rooms, on planes, doorways",
    "slam": "trajectory error, walls and rooms of the S-Graph",
    "localization": "trajectory error and deviations in the building's frame",
    "scale": "time and memory of a match as plans grow",
    "robustness": "verdicts when sensors, maps or plans are wrong",
    "real": "real building models, partial views sampled from them",
    "system": "the whole system, from sensors to a place in the building",
}


def available() -> list[str]:
    """The experiments whose module is there."""
    return [n for n in EXPERIMENTS if importlib.util.find_spec(f"situgraph.experiments.{n}")]


@click.command(
    epilog="\b\n" + "\n".join(f"{n:<13} {EXPERIMENTS[n]}" for n in available()),
)
@click.argument("name", metavar="NAME", type=click.Choice(available()))
@click.option("--full", is_flag=True, help="The stated size; the default ends within 30 minutes.")
@click.option("--jobs", type=click.IntRange(min=1), default=1, show_default=True, help="Processes.")
@click.option("--scheduler", metavar="ADDRESS", help="Run on the workers of a Dask scheduler.")
@click.option(
    "--extra",
    multiple=True,
    metavar="KEY=VALUE",
    help="A parameter of this experiment, e.g. oracle_cases=1000; may be repeated.",
)
@click.option(
    "--oracle-cases",
    type=click.IntRange(min=0),
    help="matching: cases compared with the brute-force oracle.",
)
@seed_option
@output_option("Folder for rows, results and figures [default: results/NAME].")
@json_option
def command(
    name: str,
    full: bool,
    jobs: int,
    scheduler: str | None,
    extra: tuple[str, ...],
    oracle_cases: int | None,
    seed: int,
    output: Path | None,
    as_json: bool,
) -> None:
    """Run an experiment; a run that was interrupted continues where it stopped."""
    from situgraph.experiments.runner import RunOptions
    from situgraph.experiments.tables import summary_tables

    folder = output or Path("results") / name
    parameters = dict(_parameter(text) for text in extra)
    if oracle_cases is not None:
        parameters["oracle_cases"] = oracle_cases
    with counter(f"experiment {name}", quiet=as_json) as report:
        options = RunOptions(full, jobs, scheduler, seed, folder, parameters, report)
        result = _run(name, options)
    written = result.write(folder)
    if as_json:
        emit_json(result.to_dict())
        return
    click.echo(f"{name}: {len(result.rows)} rows, seed {seed}", err=True)
    for table in summary_tables(result.summary):
        print_table(table.title, [c.replace("_", " ") for c in table.columns], table.rows)
    click.echo("written: " + ", ".join(str(path) for path in written), err=True)


def _run(name: str, options: RunOptions) -> ExperimentResult:
    run = importlib.import_module(f"situgraph.experiments.{name}").run
    result: ExperimentResult = run(options)
    return result


def _parameter(text: str) -> tuple[str, Any]:
    import yaml

    key, equals, value = text.partition("=")
    if not equals:
        raise click.UsageError(f"--extra {text}: expected KEY=VALUE")
    return key.replace("-", "_"), yaml.safe_load(value)
