"""Where tasks run: here, in local processes, on a Dask cluster. All three call one function."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from situgraph.errors import InputError, MissingExtraError, SituGraphError

Row = dict[str, Any]
# The function, the experiment's name, the task's key, the task.
Argument = tuple[Callable[[Mapping[str, Any]], Row], str, str, dict[str, Any]]

# One thread a process: rows must not depend on how a library splits its sums.
_ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


class TaskError(RuntimeError):
    """A task ended in an error of ours; the message names experiment and task."""


def solve(argument: Argument) -> tuple[str, Row]:
    """Compute one row, as plain JSON values so that every way of running gives the same.

    Raises:
        SituGraphError: the task refused its input.
        TaskError: the task failed otherwise.
    """
    from situgraph.experiments.results import plain

    function, name, key, task = argument
    try:
        return key, plain(function(task))
    except SituGraphError as error:
        # Our exceptions take other arguments than their text: this one survives pickling.
        raise SituGraphError(f"experiment {name}, task {task}: {error}") from error
    except Exception as error:
        reason = f"{type(error).__name__}: {error}"
        raise TaskError(f"experiment {name}, task {task}: {reason}") from error


def serially(arguments: Sequence[Argument]) -> Iterator[tuple[str, Row]]:
    """One after the other in this process."""
    return map(solve, arguments)


def in_processes(arguments: Sequence[Argument], jobs: int) -> Iterator[tuple[str, Row]]:
    """On ``jobs`` fresh processes; rows arrive as they are finished."""
    import concurrent.futures
    import concurrent.futures.process

    context = multiprocessing.get_context("spawn")
    workers = min(jobs, len(arguments))
    with (
        _single_threaded(),
        concurrent.futures.ProcessPoolExecutor(workers, context, _die_silently) as pool,
    ):
        waiting = [pool.submit(solve, argument) for argument in arguments]
        try:
            for future in concurrent.futures.as_completed(waiting):
                yield future.result()
        except concurrent.futures.process.BrokenProcessPool as error:
            problem = "a worker process was ended (out of memory?); repeat with fewer --jobs"
            raise SituGraphError(f"{problem}, rows done before are kept") from error
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            for child in multiprocessing.active_children():
                child.terminate()
            raise


def _die_silently() -> None:
    """Let Ctrl-C end a worker without a traceback; the parent process says what is to be said."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def on_dask(arguments: Sequence[Argument], scheduler: str) -> Iterator[tuple[str, Row]]:
    """On the workers of a running Dask scheduler; rows arrive as they are finished.

    Raises:
        MissingExtraError: Dask is not installed.
        InputError: nothing answers at the address.
    """
    try:
        import distributed
    except ImportError as error:
        remedy = "Dask is not installed; pip install 'situgraph[dask]'"
        raise MissingExtraError(f"--scheduler {scheduler}: {remedy}") from error
    try:
        client = distributed.Client(scheduler, timeout=10)
    except (OSError, ValueError) as error:
        remedy = "start one with `dask scheduler` and name its address"
        raise InputError(f"--scheduler {scheduler}", "no scheduler answers", remedy) from error
    with client:
        # `pure=False`: rows are ours to keep; the cluster must not answer from an older run.
        waiting = client.map(solve, arguments, pure=False)
        for _, row in distributed.as_completed(waiting, with_results=True):
            yield row


@contextlib.contextmanager
def _single_threaded() -> Iterator[None]:
    """Child processes started in this block see one thread a library."""
    before = {name: os.environ.get(name) for name in _ONE_THREAD}
    os.environ.update(dict.fromkeys(_ONE_THREAD, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value
