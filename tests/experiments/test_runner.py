"""The runner: the same rows however and however often it is run."""

from __future__ import annotations

import importlib.util
import json
import math
import random
from pathlib import Path
from typing import Any

import pytest

from situgraph.errors import InputError, SituGraphError
from situgraph.experiments.execution import TaskError
from situgraph.experiments.runner import Experiment, RunOptions, run_experiment, task_key


def solve(task: Any) -> dict[str, Any]:
    draws = random.Random(task["seed"])
    return {"size": task["size"], "sum": sum(draws.random() for _ in range(task["size"]))}


def fail_on_seven(task: Any) -> dict[str, Any]:
    if task["seed"] == 7:
        raise InputError("plan.ifc", "no walls")
    return solve(task)


def fail_inside(task: Any) -> dict[str, Any]:
    return {"x": 1 / task["zero"]}


def summarise(rows: list[dict[str, Any]]) -> dict[str, Any]:
    return {"total": sum(r["sum"] for r in rows), "count": len(rows)}


def experiment(function: Any = solve, count: int = 12) -> Experiment:
    tasks = [{"seed": seed, "size": 10 * seed + 1} for seed in range(count)]
    return Experiment("sums", tasks, function, summarise, seed=3)


def lines(folder: Path) -> list[str]:
    return (folder / "sums.rows.jsonl").read_text().splitlines()


def test_rows_come_in_the_order_of_the_tasks() -> None:
    result = run_experiment(experiment(), RunOptions())
    assert [r["size"] for r in result.rows] == [10 * s + 1 for s in range(12)]
    assert result.summary["count"] == 12
    assert result.to_dict()["format"] == "situgraph/experiment"
    assert result.seed == 3


def test_processes_give_what_one_process_gives(tmp_path: Path) -> None:
    serial = run_experiment(experiment(), RunOptions(folder=tmp_path / "a"))
    parallel = run_experiment(experiment(), RunOptions(folder=tmp_path / "b", jobs=2))
    assert serial == parallel
    assert sorted(lines(tmp_path / "a")) == sorted(lines(tmp_path / "b"))


class Stop(BaseException):
    """Stands for Ctrl-C."""


@pytest.mark.parametrize("cut", [0, 7])
def test_an_interrupted_run_continues_where_it_stopped(tmp_path: Path, cut: int) -> None:
    def stop(done: int, total: int) -> None:
        if done == 5:
            raise Stop

    with pytest.raises(Stop):
        run_experiment(experiment(), RunOptions(folder=tmp_path, report=stop))
    store = tmp_path / "sums.rows.jsonl"
    assert len(lines(tmp_path)) == 5
    if cut:  # the machine died while the last line was written
        store.write_bytes(store.read_bytes()[:-cut])
    reported: list[tuple[int, int]] = []
    options = RunOptions(folder=tmp_path, report=lambda *state: reported.append(state))
    resumed = run_experiment(experiment(), options)
    assert reported[0] == (4 if cut else 5, 12)
    assert resumed == run_experiment(experiment(), RunOptions())
    assert run_experiment(experiment(), options) == resumed
    assert reported[-1] == (12, 12)


def test_stored_rows_of_another_revision_are_not_taken_over(tmp_path: Path) -> None:
    run_experiment(experiment(), RunOptions(folder=tmp_path))
    before = experiment()
    newer = Experiment("sums", before.tasks, solve, summarise, revision=2)
    run_experiment(newer, RunOptions(folder=tmp_path))
    assert len(lines(tmp_path)) == 24
    assert task_key(before, before.tasks[0]) != task_key(newer, newer.tasks[0])


@pytest.mark.parametrize("jobs", [1, 2])
def test_a_task_that_refuses_its_input_is_named_and_the_rest_kept(
    tmp_path: Path, jobs: int
) -> None:
    with pytest.raises(SituGraphError, match=r"task \{'seed': 7.*plan.ifc: no walls"):
        run_experiment(experiment(fail_on_seven), RunOptions(folder=tmp_path, jobs=jobs))
    assert lines(tmp_path)


def test_an_error_of_ours_is_no_bad_input() -> None:
    tasks = [{"seed": 0, "zero": 0}]
    with pytest.raises(TaskError, match="ZeroDivisionError"):
        run_experiment(Experiment("bad", tasks, fail_inside, summarise), RunOptions())


def test_equal_tasks_are_refused() -> None:
    with pytest.raises(SituGraphError, match="seed"):
        run_experiment(Experiment("same", [{"a": 1}] * 2, solve, summarise), RunOptions())


def test_a_folder_that_cannot_be_written_ends_the_run_before_it_starts(tmp_path: Path) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("not a folder")
    with pytest.raises(InputError, match="cannot be written"):
        run_experiment(experiment(), RunOptions(folder=blocked))


def infinite(task: Any) -> dict[str, Any]:
    return {"a": math.nan, "b": (1, 2), "c": {"d": math.inf}}


def test_results_are_strict_json_and_csv(tmp_path: Path) -> None:
    options = RunOptions(folder=tmp_path)
    result = run_experiment(Experiment("odd", [{"seed": 0}], infinite, lambda rows: {}), options)
    assert result.rows == [{"a": None, "b": [1, 2], "c": {"d": None}}]
    json_path, csv_path = result.write(tmp_path)
    document = json.loads(json_path.read_text(), parse_constant=pytest.fail)
    assert document["rows"] == result.rows
    assert set(document["machine"]) == {"processor", "cores", "system", "python"}
    assert csv_path.read_text() == 'a,b,c\n,"[1, 2]","{""d"": null}"\n'


@pytest.mark.skipif(importlib.util.find_spec("distributed") is None, reason="Dask is an extra")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_a_dask_cluster_gives_what_one_process_gives() -> None:
    import distributed

    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None
    ) as cluster:
        options = RunOptions(scheduler=cluster.scheduler_address)
        assert run_experiment(experiment(count=4), options) == run_experiment(
            experiment(count=4), RunOptions()
        )


def test_no_scheduler_at_the_address_is_bad_input() -> None:
    pytest.importorskip("distributed")
    with pytest.raises(InputError, match="no scheduler answers"):
        run_experiment(experiment(), RunOptions(scheduler="nonsense://nowhere"))
