"""The live status of a run: a progress bar and one line of what is known, on stderr."""

from __future__ import annotations

import contextlib
import math
import sys
from collections.abc import Iterator
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from situgraph.pipeline import State
    from situgraph.run import Watch

EVERY = 20  # messages between two looks at the clock and the terminal


@contextlib.contextmanager
def live(total: int, *, quiet: bool = False) -> Iterator[Watch]:
    """Show the progress of a run of ``total`` messages; silent when quiet or not a terminal."""
    if quiet or not sys.stderr.isatty():
        yield lambda messages, state: None
        return
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeElapsedColumn
    from rich.table import Column

    from situgraph.cli.console import console

    columns = (BarColumn(bar_width=20), TaskProgressColumn(), TimeElapsedColumn())
    # On a narrow terminal the words give way, not the figures before them.
    last = Column(ratio=1, no_wrap=True, overflow="ellipsis")
    said = TextColumn("{task.description}", markup=False, table_column=last)
    with Progress(*columns, said, console=console(), transient=True, expand=True) as bar:
        task = bar.add_task("starting", total=total or None)

        def watch(messages: int, state: State) -> None:
            if messages % EVERY == 0:
                bar.update(task, completed=messages, description=status_line(state))

        yield watch


def status_line(state: State) -> str:
    """What is known now, in one line."""
    pose, frame = (state.pose, "map") if state.place is None else (state.place, "building")
    yaw = 2 * math.atan2(pose[5], pose[6])
    where = f"in the {frame} at ({pose[0]:.1f}, {pose[1]:.1f}), {math.degrees(yaw):.0f} deg"
    line = f"{state.rooms} rooms, {state.objects} objects"
    if state.verdict is not None:
        many = f" ({state.solutions})" if state.verdict == "ambiguous" else ""
        line += f", {state.verdict}{many}"
    return f"{line}; {state.advice}; {where}" if state.advice else f"{line}; {where}"
