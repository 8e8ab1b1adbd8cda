"""Experiment ``matching``: small sizes, the keys that DESIGN section 3 promises, what rows say."""

from __future__ import annotations

from pathlib import Path

import pytest

from situgraph.experiments import certificate, exactness, matching, paper_figure
from situgraph.experiments.results import ExperimentResult
from situgraph.experiments.runner import RunOptions

SMALL = {
    "layouts": 1,
    "growth": 1,
    "oracle_cases": 4,
    "trials": 6,
    "beyond": 4,
    "pairs": 7,
    "share": 5,
}
SYMMETRIES = {"none", "local", "global"}
SEMANTICS = {"none", "containment", "likelihood"}


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> ExperimentResult:
    monkeypatch = pytest.MonkeyPatch()
    monkeypatch.setattr(paper_figure, "PLANNED", (2, 4))
    monkeypatch.setattr(paper_figure, "SEEN", (1, 3))
    monkeypatch.setattr(paper_figure, "DENSITIES", (0.0, 0.2))
    monkeypatch.setattr(paper_figure, "GROWTH_ROOMS", 5)
    monkeypatch.setattr(exactness, "GRIDS", exactness.GRIDS[:2])
    folder = tmp_path_factory.mktemp("matching")
    found = matching.run(RunOptions(folder=folder, extra=SMALL))
    monkeypatch.undo()
    assert {p.name for p in folder.iterdir()} >= {"surfaces.png", "reliability.png"}
    return found


def test_summary_has_the_promised_keys(result: ExperimentResult) -> None:
    summary = result.to_dict()["summary"]
    for key in ("median_solutions", "median_ms", "success_rate", "candidate_reduction"):
        assert set(summary[key]) == SYMMETRIES
        assert all(set(by) == SEMANTICS for by in summary[key].values())
    assert set(summary["rooms_until_unique"]) == SYMMETRIES
    assert summary["oracle_cases"] == 4
    assert summary["oracle_missed"] == summary["oracle_invented"] == 0
    assert summary["grids_counted_right"] == summary["grids"] == 2
    assert set(summary["mirrored"]) == set(summary["foreign"]) == {"none", "likelihood"}


def test_no_trial_that_the_model_covers_is_wrongly_unique(result: ExperimentResult) -> None:
    assert result.summary["trials_covered"]["wrong"] == 0
    assert result.summary["trials_covered"]["trials"] > 0


def test_half_of_an_asymmetric_plan_is_told_from_all_else(result: ExperimentResult) -> None:
    summary = result.summary
    assert summary["unique_6x12_cases"] == 20
    assert summary["unique_6x12_wrong"] == 0
    assert all(share >= 0.8 for by in summary["unique_6x12"].values() for share in by.values())


def test_objects_help_and_do_not_hurt(result: ExperimentResult) -> None:
    rate = result.summary["success_rate"]["none"]
    assert rate["likelihood"] >= rate["none"]


def test_a_trial_is_the_same_each_time() -> None:
    task = next(iter(certificate.trial_tasks(11, 1, "covered")))
    assert certificate.solve_trial(task) == certificate.solve_trial(task)


def test_a_foreign_building_has_no_right_place(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(certificate, "FOREIGN_SHARE", 1.0)
    rows = [certificate.solve_trial(t) for t in certificate.trial_tasks(0, 5, "covered")]
    assert all(r["foreign"] and not r["admissible"] and r["outcome"] != "right" for r in rows)


def test_full_size_is_the_stated_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    seen: dict[str, int] = {}

    def count(experiment: object, options: object) -> ExperimentResult:
        for task in experiment.tasks:  # type: ignore[attr-defined]
            name = f"{task['part']} {task.get('errors', '')}".strip()
            seen[name] = seen.get(name, 0) + 1
        rows = [{**task, "answer": ""} for task in experiment.tasks]  # type: ignore[attr-defined]
        return ExperimentResult("matching", 0, "", rows, {})

    monkeypatch.setattr(matching, "run_experiment", count)
    matching.run(RunOptions(full=True))
    assert seen["brute force"] == seen["oracle"] == 5_000
    assert seen["trial covered"] == 22_000  # more than 20,000 of them are admissible
    assert seen["foreign"] == seen["mirrored"] == 2 * 200


def test_what_a_stricter_probability_would_leave_is_told() -> None:
    common = {"part": "trial", "errors": "covered", "foreign": False, "admissible": True}
    common |= {"rooms_right": False, "certified": True, "congruent": False, "aside": False}
    rows = [
        {**common, "outcome": "right", "said": [[0.99999, 1.0]]},
        {**common, "outcome": "right", "said": [[0.995, 1.0]]},
        {**common, "outcome": "wrong", "said": [[0.9995, 0.0]]},
        {**common, "outcome": "none", "said": []},
    ]
    told = certificate.summarise_trials(rows)["trials_covered"]
    assert told["from_0.999"] == {"right": 1, "wrong": 1}
    assert told["from_0.9999"] == {"right": 1, "wrong": 0}
