"""Options that several commands share."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import click

F = TypeVar("F", bound=Callable[..., Any])


def json_option(function: F) -> F:
    """Add ``--json``: the function gets ``as_json: bool``."""
    return click.option(
        "--json", "as_json", is_flag=True, help="Print the result as JSON on stdout, nothing else."
    )(function)


def seed_option(function: F) -> F:
    """Add ``--seed``: the function gets ``seed: int``."""
    return click.option(
        "--seed",
        type=click.IntRange(min=0),
        default=0,
        show_default=True,
        help="All randomness comes from this number.",
    )(function)


def settings_options(function: F) -> F:
    """Add ``--config FILE`` and ``--set KEY=VALUE``: the function gets ``settings: Settings``."""
    import functools

    @functools.wraps(function)
    def with_settings(
        *args: Any, config_file: Path | None, overrides: tuple[str, ...], **kw: Any
    ) -> Any:
        from situgraph.config import load_settings

        return function(*args, settings=load_settings(config_file, overrides), **kw)

    click.option(
        "--set",
        "overrides",
        multiple=True,
        metavar="KEY=VALUE",
        help="Change one setting, e.g. --set matching.rival_ratio=0.02; may be repeated.",
    )(with_settings)
    click.option(
        "--config",
        "config_file",
        type=click.Path(path_type=Path),
        metavar="FILE",
        help="YAML file of settings (see `situgraph config`).",
    )(with_settings)
    return with_settings  # type: ignore[return-value]


def output_option(help_text: str) -> Callable[[F], F]:
    """Add ``-o / --output``: the function gets ``output: Path | None``."""
    return click.option(
        "-o", "--output", type=click.Path(path_type=Path), metavar="PATH", help=help_text
    )
