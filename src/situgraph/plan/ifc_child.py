"""Reading an IFC file in a child process with bounded memory and time.

``python -m situgraph.plan.ifc_child FILE``: settings as JSON on stdin, the answer on stdout.
"""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
import time
from pathlib import Path

import msgspec

from situgraph.errors import InputError
from situgraph.plan.config import PlanConfig
from situgraph.plan.ifc import build_graph, peak_memory_mb
from situgraph.scenegraph.graph import SceneGraph


class Answer(msgspec.Struct, frozen=True):
    """What the child found: a graph, or what is wrong; its CPU seconds and peak memory (MB)."""

    graph: SceneGraph | None
    problem: str | None
    cpu_seconds: float
    peak_mb: float


def read_in_child(path: Path, config: PlanConfig) -> tuple[SceneGraph, float, float]:
    """The A-Graph of an IFC file, and the CPU seconds and peak memory (MB) of the child.

    Raises:
        InputError: the child says so, crashed, took too long or too much memory.
        RuntimeError: the child failed in our own code.
    """
    try:
        done = subprocess.run(
            [sys.executable, "-m", "situgraph.plan.ifc_child", str(path)],
            input=msgspec.json.encode(config),
            capture_output=True,
            timeout=config.max_seconds,
            env=_environment(),
            check=False,
        )
    except subprocess.TimeoutExpired:
        problem = f"takes more than {config.max_seconds:.0f} s to read"
        raise InputError(path, problem, "raise plan.max_seconds if you trust it") from None
    if done.returncode < 0 or not done.stdout:
        if any(sign in done.stderr for sign in _OUT_OF_MEMORY):
            problem = f"needs more than {config.max_memory_mb} MB to read"
            raise InputError(path, problem, "raise plan.max_memory_mb if you trust it")
        if done.returncode < 0:
            raise InputError(path, "crashes the IFC parser", "open and export it again")
        raise RuntimeError(done.stderr.decode("utf-8", "replace")[-4000:])
    answer = msgspec.json.decode(done.stdout, type=Answer)
    if answer.graph is None:
        raise InputError(path, (answer.problem or "cannot be read").removeprefix(f"{path}: "))
    return answer.graph, answer.cpu_seconds, answer.peak_mb


# What Python, C++, OpenBLAS and the dynamic loader say when the limit is reached.
_OUT_OF_MEMORY = (
    b"MemoryError",
    b"bad_alloc",
    b"Memory allocation",
    b"allocate memory",
    b"failed to map segment",
)


def _environment() -> dict[str, str]:
    """The same packages as here, and one thread: the arrays are small, the pools are not."""
    own = {"PYTHONPATH": os.pathsep.join(p for p in sys.path if p), "PYTHONIOENCODING": "utf-8"}
    threads = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
    return {**os.environ, **own, **dict.fromkeys(threads, "1")}


def _limit_memory(megabytes: int) -> None:
    try:
        import resource
    except ImportError:
        return
    _, hard = resource.getrlimit(resource.RLIMIT_AS)
    wanted = megabytes * 1_000_000
    with contextlib.suppress(ValueError, OSError):  # a stricter limit is in force already
        resource.setrlimit(resource.RLIMIT_AS, (wanted, hard))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def _main() -> None:
    path = sys.argv[1]
    config = msgspec.json.decode(sys.stdin.buffer.read(), type=PlanConfig)
    answer_to = os.dup(1)
    # The parser's own messages go nowhere: stdout carries the answer and nothing else.
    silence = os.open(os.devnull, os.O_WRONLY)
    os.dup2(silence, 1)
    _limit_memory(config.max_memory_mb)
    graph: SceneGraph | None
    problem: str | None
    try:
        graph, problem = build_graph(path, config), None
    except InputError as error:
        graph, problem = None, str(error)
    answer = Answer(graph, problem, time.process_time(), peak_memory_mb())
    with os.fdopen(answer_to, "wb") as stream:
        stream.write(msgspec.json.encode(answer))


if __name__ == "__main__":
    _main()
