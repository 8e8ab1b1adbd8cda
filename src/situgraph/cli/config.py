"""``situgraph config``: every setting, where it comes from, and a file to start from."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from situgraph.cli.console import emit_json, print_table
from situgraph.cli.options import json_option, settings_options

if TYPE_CHECKING:
    from situgraph.config import Settings


@click.command()
@settings_options
@click.option("--yaml", "as_yaml", is_flag=True, help="Print YAML that --config FILE accepts.")
@json_option
def command(settings: Settings, as_yaml: bool, as_json: bool) -> None:
    """Every setting with its value, unit, source and meaning; --config and --set are applied."""
    from situgraph.config import describe, to_yaml

    if as_yaml and as_json:
        raise click.UsageError("choose one of --yaml and --json")
    if as_yaml:
        click.echo(to_yaml(settings), nl=False)
        return
    rows = describe(settings)
    if as_json:
        emit_json([{**_plain(row), "changed": row.value != row.default} for row in rows])
        return
    table = [
        (
            row.key + ("*" if row.value != row.default else ""),
            f"{row.value} {row.unit}".strip(),
            f"{row.description} ({row.source})" if row.source else row.description,
        )
        for row in rows
    ]
    print_table("Settings (* changed)", ("setting", "value", "meaning (source)"), table)


def _plain(row: object) -> dict[str, object]:
    import msgspec

    return msgspec.structs.asdict(row)  # type: ignore[arg-type]
