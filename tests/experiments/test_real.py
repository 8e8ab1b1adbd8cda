"""Experiment ``real``: needs the real inputs beside the repository."""

from __future__ import annotations

from pathlib import Path

import pytest

from situgraph.errors import InputError
from situgraph.experiments import real
from situgraph.experiments.runner import RunOptions


def test_a_missing_folder_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="--extra data="):
        real.run(RunOptions(extra={"data": str(tmp_path / "nowhere")}))


@pytest.mark.external
def test_every_pair_of_se1_keeps_the_truth_and_none_is_wrong(shared_data: Path) -> None:
    tasks = [t for t in real.se1_tasks(shared_data, 0) if t["semantics"] == "none"]
    rows = [real.solve(task) for task in tasks]
    assert len(rows) == 42
    assert all(r["true_rank"] is not None and r["outcome"] != "wrong" for r in rows)
    assert sum(r["outcome"] == "right" for r in rows) >= 33
    by_case = real.summarise(rows)["SE1"]
    assert sum(c["right"] for c in by_case.values()) == sum(r["outcome"] == "right" for r in rows)


@pytest.mark.external
def test_se1_answers_do_not_depend_on_the_frame(
    shared_data: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(real, "FRAMES", 3)
    tasks = [
        t
        for t in real.se1_tasks(shared_data, 0)
        if t["part"] == "SE1" and t["semantics"] == "likelihood" and t["plan"] in ("T0", "T4")
    ]
    for row in map(real.solve, tasks):
        assert row["frames_alike"] == row["frames"] == 3


@pytest.mark.external
def test_logs_are_not_in_another_building(
    shared_data: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(real, "FRAMES", 1)
    tasks = [t for t in real.se1_tasks(shared_data, 0) if t["part"] == "SE1 in another building"]
    assert [real.solve(t)["outcome"] for t in tasks] == ["none"] * 5


@pytest.mark.external
def test_a_house_is_found_from_a_few_rooms(shared_data: Path) -> None:
    tasks = [
        t
        for t in real.model_tasks(shared_data, 0, 3)
        if "AC20-FZK" in t["file"] and t["rooms"] == 5 and t["semantics"] == "likelihood"
    ]
    (row,) = map(real.solve, tasks)
    assert row["wrong"] == 0
    assert row["right"] == 3


@pytest.mark.external
def test_a_pair_that_is_not_unique_names_its_rival_and_the_moved_walls(
    shared_data: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(real, "FRAMES", 0)
    (task,) = (
        t
        for t in real.se1_tasks(shared_data, 0)
        if (t["part"], t["semantics"], t["log"], t["plan"]) == ("SE1", "likelihood", "R3", "T4")
    )
    pair = real.summarise([real.solve(task)])["SE1 by pair"]["R3 x T4"]
    assert pair["outcome"] == "ambiguous"
    assert 0.01 <= pair["rival_share"] <= 1
    assert pair["rival_turned_deg"] == pytest.approx(180, abs=3)
    assert " m" in pair["moved"]
