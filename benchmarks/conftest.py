"""The 95th percentile of each benchmark, which the table of pytest-benchmark does not have."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

Line = tuple[str, float, float, int]
LINES = pytest.StashKey[list[Line]]()


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """The real inputs beside the repository; a benchmark that asks for them is ``external``."""
    folder = Path(__file__).resolve().parents[2] / "shared" / "data"
    if not folder.is_dir():
        pytest.skip("the real inputs are not beside the repository (../shared/data)")
    return folder


@pytest.fixture(autouse=True)
def percentile(request: pytest.FixtureRequest) -> Iterator[None]:
    """Notes ``p95`` (s) in the benchmark's ``extra_info``, and a line for the summary."""
    if "benchmark" not in request.fixturenames:
        yield
        return
    benchmark: Any = request.getfixturevalue("benchmark")
    yield
    if benchmark.stats is None:
        return
    times = benchmark.stats.stats.sorted_data
    if not times:
        return
    median, p95 = (float(q) for q in np.percentile(times, [50, 95]))
    benchmark.extra_info["p95"] = p95
    lines = request.config.stash.setdefault(LINES, [])
    lines.append((request.node.name, median, p95, len(times)))


def pytest_terminal_summary(terminalreporter: Any, config: pytest.Config) -> None:
    lines = config.stash.get(LINES, [])
    if not lines:
        return
    width = max(len(name) for name, *_ in lines)
    terminalreporter.section("median and 95th percentile, milliseconds")
    for name, median, p95, rounds in lines:
        terminalreporter.write_line(
            f"{name:{width}} {1e3 * median:12.3f} {1e3 * p95:12.3f}  {rounds} rounds"
        )
