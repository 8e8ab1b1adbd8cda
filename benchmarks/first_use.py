"""Time of the first index and match of a process, before and after anything was compiled.

``python -m benchmarks.first_use [ROUNDS]`` prints the least of so many rounds, three by default.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time

TARGETS = {"empty cache folder": 20.0, "compiled code found": 1.5}
ONCE = "once"


def first_match() -> tuple[float, float]:
    """Index 12 rooms and match 6 of them: seconds, and seconds of one processor."""
    import situgraph as sg
    from situgraph.plan.layouts import make_layout
    from situgraph.plan.sampler import sample_online
    from situgraph.plan.sampler_config import REALISTIC

    prior = make_layout("random", 12, 0)
    online = sample_online(prior, 6, 0, REALISTIC).online
    wall, processor = time.perf_counter(), time.process_time()
    result = sg.match(online, sg.PlanIndex(prior))
    times = time.perf_counter() - wall, time.process_time() - processor
    assert result.verdict == "unique"
    return times


def in_new_process(folder: str) -> tuple[float, float]:
    """The same in a process of its own, which keeps compiled code in this folder."""
    given = os.environ | {"SITUGRAPH_CACHE": folder}
    given.pop("NUMBA_CACHE_DIR", None)
    command = [sys.executable, "-m", "benchmarks.first_use", ONCE]
    answer = subprocess.run(command, env=given, check=True, stdout=subprocess.PIPE, text=True)
    wall, processor = map(float, answer.stdout.split())
    return wall, processor


def main(rounds: int = 3) -> None:
    """Print both as a table."""
    times: dict[str, list[tuple[float, float]]] = {name: [] for name in TARGETS}
    for _ in range(rounds):
        with tempfile.TemporaryDirectory() as folder:
            for row in times.values():
                row.append(in_new_process(folder))
    print("| first index and match | seconds | of one processor | target |")
    print("|---|---|---|---|")
    for name, row in times.items():
        wall, processor = map(min, zip(*row))
        print(f"| {name} | {wall:.1f} | {processor:.1f} | {TARGETS[name]:g} |")


if __name__ == "__main__":
    if sys.argv[1:] == [ONCE]:
        print(*first_match())
    else:
        main(*map(int, sys.argv[1:]))
