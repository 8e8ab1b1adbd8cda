"""What people see on stderr and machines on stdout."""

from __future__ import annotations

import contextlib
import json
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any, Literal, Protocol

if TYPE_CHECKING:
    from rich.console import Console


WHOLE_NAME = 40  # characters
LOG_WIDTH = 140  # characters


class Advance(Protocol):
    """Moves a progress bar on by so many steps."""

    def __call__(self, steps: int = 1) -> None:
        """Move on."""


def console() -> Console:
    """A rich console on stderr: stdout belongs to results."""
    from rich.console import Console

    # A log file has no width of its own; rich would take 80 and fold wide tables.
    width = None if sys.stderr.isatty() or "COLUMNS" in os.environ else LOG_WIDTH
    return Console(stderr=True, highlight=False, width=width)


def emit_json(value: Any) -> None:
    """Print ``value`` (JSON-able, or a msgspec record) as strict JSON on stdout.

    Raises:
        ValueError: a number is NaN or infinite, which JSON cannot say.
    """
    import msgspec

    plain = msgspec.to_builtins(value, enc_hook=_plain)
    text = json.dumps(plain, indent=2, ensure_ascii=False, allow_nan=False)
    # Bytes, so that a name in any script goes out as UTF-8 whatever the locale.
    sys.stdout.flush()
    sys.stdout.buffer.write(text.encode("utf-8", "replace") + b"\n")
    sys.stdout.buffer.flush()


def print_table(title: str, columns: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    """A table on stderr; numbers stand right, None is left empty, markup in names is inert."""
    from rich.markup import escape
    from rich.table import Table

    body = [list(row) for row in rows]
    table = Table(
        title=escape(title), title_justify="left", title_style="bold", header_style="bold"
    )
    for index, column in enumerate(columns):
        numeric = bool(body) and all(isinstance(r[index], int | float | None) for r in body)
        # Short names in front are easier to find unbroken; the other columns give way.
        whole = index == 0 and all(len(str(r[0])) <= WHOLE_NAME for r in body)
        justify: Literal["right", "left"] = "right" if numeric else "left"
        table.add_column(escape(column), justify=justify, overflow="fold", no_wrap=whole)
    for row in body:
        table.add_row(*(_cell(value, escape) for value in row))
    console().print(table)


@contextlib.contextmanager
def counter(
    description: str, *, quiet: bool = False
) -> Iterator[Callable[[int, int | None], None]]:
    """A progress bar on stderr; yields ``report(done, total)``. Silent like ``progress``."""
    if quiet or not sys.stderr.isatty():
        yield lambda done, total: None
        return
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn())
    with Progress(*columns, TimeElapsedColumn(), console=console(), transient=True) as bar:
        task = bar.add_task(description, total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)


@contextlib.contextmanager
def progress(
    description: str, total: int | None = None, *, quiet: bool = False
) -> Iterator[Advance]:
    """A progress bar on stderr; yields ``advance(steps)``. Silent when quiet or not a terminal."""
    done = 0
    with counter(description, quiet=quiet) as report:

        def advance(steps: int = 1) -> None:
            nonlocal done
            done += steps
            report(done, total)

        report(0, total)
        yield advance


def _cell(value: object, escape: Callable[[str], str]) -> str:
    if value is None:
        return ""
    if isinstance(value, float):
        return f"{value:.4g}"
    return escape(str(value))


def _plain(value: Any) -> Any:
    """Numpy scalars and arrays as plain numbers and lists."""
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"{type(value).__name__} is not JSON")
