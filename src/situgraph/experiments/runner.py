"""One runner for all experiments: tasks in, rows out, resumable, on one core, several or a cluster.

An experiment is a list of tasks (JSON-able parameters, each with its own seed), a pure top-level
function from a task to a row, and a summary of the rows. Each finished row is appended to a store
beside the results, so a sweep that was interrupted continues where it stopped; rows come out in the
order of the tasks whatever the number of processes, and are the same bit for bit.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from situgraph import __version__
from situgraph.errors import InputError, SituGraphError
from situgraph.experiments.results import ExperimentResult, machine, strict_json

Task = Mapping[str, Any]
Row = dict[str, Any]
Solve = Callable[[Task], Row]
Report = Callable[[int, int], None]


@dataclass(frozen=True)
class Experiment:
    """What there is to compute.

    ``solve`` must be a top-level function and depend on nothing but its task: it runs in other
    processes, and its row is kept under the task's hash. ``revision`` is raised when ``solve``
    changes what it computes, so that rows of the older one are not taken over.
    """

    name: str
    tasks: Sequence[Task]
    solve: Solve
    summarise: Callable[[list[Row]], dict[str, Any]]
    seed: int = 0
    revision: int = 1


@dataclass(frozen=True)
class RunOptions:
    """How to compute it: size, processes or cluster, seed, the folder for store and results.

    ``extra`` holds parameters of one experiment; ``report`` is told (rows done, rows in all).
    """

    full: bool = False
    jobs: int = 1
    scheduler: str | None = None
    seed: int = 0
    folder: Path | None = None
    extra: Mapping[str, Any] = field(default_factory=dict)
    report: Report = lambda done, total: None


def run_experiment(experiment: Experiment, options: RunOptions) -> ExperimentResult:
    """Compute the rows that are not stored yet, and summarise all of them.

    Raises:
        InputError: the store cannot be read or written, or the scheduler cannot be reached.
        MissingExtraError: a scheduler is named and Dask is not installed.
        SituGraphError, TaskError: a task failed; the message names it, rows done are kept.
    """
    keys = [task_key(experiment, task) for task in experiment.tasks]
    if len(set(keys)) < len(keys):
        raise SituGraphError(
            f"experiment {experiment.name}: two tasks are the same; give each a seed"
        )
    store = RowStore(options.folder / f"{experiment.name}.rows.jsonl" if options.folder else None)
    done = store.read(set(keys))
    options.report(len(done), len(keys))
    open_tasks = [(k, t) for k, t in zip(keys, experiment.tasks) if k not in done]
    with store:
        for key, row in _solved(experiment, open_tasks, options):
            done[key] = row
            store.append(key, row)
            options.report(len(done), len(keys))
    rows = [done[key] for key in keys]
    return ExperimentResult(
        name=experiment.name,
        seed=experiment.seed,
        situgraph=__version__,
        rows=rows,
        summary=experiment.summarise(rows),
        machine=machine(),
        full=options.full,
    )


def task_key(experiment: Experiment, task: Task) -> str:
    """The hash under which a task's row is stored: experiment, revision, version and parameters."""
    identity = [experiment.name, experiment.revision, __version__, dict(task)]
    return hashlib.sha256(strict_json(identity, sort_keys=True).encode()).hexdigest()[:32]


class RowStore:
    """Rows by task hash in a JSON-lines file; a line cut short by a crash is ignored and ended."""

    def __init__(self, path: Path | None) -> None:
        self.path = path
        self._file: Any = None

    def read(self, keys: set[str]) -> dict[str, Row]:
        """The stored rows of these tasks."""
        found: dict[str, Row] = {}
        if self.path is None or not self.path.exists():
            return found
        try:
            with open(self.path, "rb") as file:
                for line in file:
                    entry = _entry(line)
                    if entry is not None and entry[0] in keys:
                        found[entry[0]] = entry[1]
        except OSError as error:
            raise InputError(self.path, f"cannot be read ({error.strerror})") from error
        return found

    def __enter__(self) -> RowStore:
        if self.path is not None:
            try:
                self.path.parent.mkdir(parents=True, exist_ok=True)
                self._file = open(self.path, "ab")
                if self._file.tell() and not _ends_with_newline(self.path):
                    self._write(b"\n")
            except OSError as error:
                raise self._cannot_write(error) from error
        return self

    def append(self, key: str, row: Row) -> None:
        """Store a row for good."""
        if self._file is None:
            return
        try:
            self._write(strict_json({"task": key, "row": row}).encode() + b"\n")
        except OSError as error:
            raise self._cannot_write(error) from error

    def _write(self, data: bytes) -> None:
        self._file.write(data)
        self._file.flush()

    def __exit__(self, *_: object) -> None:
        if self._file is not None:
            self._file.close()
            self._file = None

    def _cannot_write(self, error: OSError) -> InputError:
        remedy = "rows stored before are kept; make room and repeat the command"
        return InputError(self.path, f"cannot be written ({error.strerror})", remedy)


def _entry(line: bytes) -> tuple[str, Row] | None:
    try:
        entry = json.loads(line)
        return str(entry["task"]), dict(entry["row"])
    except (ValueError, KeyError, TypeError):
        return None


def _ends_with_newline(path: Path) -> bool:
    with open(path, "rb") as file:
        file.seek(-1, os.SEEK_END)
        return file.read(1) == b"\n"


def _solved(
    experiment: Experiment, tasks: list[tuple[str, Task]], options: RunOptions
) -> Iterator[tuple[str, Row]]:
    """Keys and rows, in the order in which they are finished."""
    from situgraph.experiments import execution

    arguments = [(experiment.solve, experiment.name, key, dict(task)) for key, task in tasks]
    if options.scheduler is not None:
        return execution.on_dask(arguments, options.scheduler)
    if options.jobs > 1 and len(tasks) > 1:
        return execution.in_processes(arguments, options.jobs)
    return execution.serially(arguments)
