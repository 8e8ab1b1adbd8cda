"""The brute force's answers, kept and taken up again."""

from __future__ import annotations

from pathlib import Path

import pytest

from situgraph.experiments import exactness, matching
from situgraph.experiments.oracle import kept
from situgraph.experiments.oracle.answer import search
from situgraph.experiments.oracle.cases import draw
from situgraph.experiments.oracle.comparison import compare
from situgraph.experiments.oracle.definition import Definition
from situgraph.experiments.oracle.problem import Problem
from situgraph.experiments.runner import RunOptions

SMALL = dict.fromkeys(matching.SIZES, 0) | {"oracle_cases": 3}


@pytest.mark.parametrize("number", [1, 5, 7])
def test_a_kept_answer_compares_as_a_new_one(number: int) -> None:
    case = draw(number)
    prior, sample = case.graphs()
    problem = Problem(sample.online, prior, case.policy, Definition())
    text = kept.to_text(search(problem), sample.online, prior)
    again = kept.from_text(text, sample.online, prior)
    assert again is not None
    assert kept.to_text(again, sample.online, prior) == text
    assert compare(sample.online, prior, problem, again) == compare(sample.online, prior, problem)
    # It is no answer about other graphs.
    assert kept.from_text(text, prior, sample.online) is None


def test_the_key_of_the_sources_follows_them(tmp_path: Path) -> None:
    one, two = tmp_path / "one.py", tmp_path / "two.py"
    one.write_text("a = 1\n")
    two.write_text("a = 1\n")
    first = kept.sources_key([one])
    assert kept.sources_key([one, two]) == kept.sources_key([two, one]) != first
    one.write_text("a = 2\n")
    assert kept.sources_key([one]) != first


def test_a_changed_search_is_held_against_the_answers_that_are_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(exactness, "GRIDS", ())
    options = RunOptions(folder=tmp_path, extra=SMALL)
    first = matching.run(options).rows
    changed = kept.sources_key

    def never(task: object) -> dict[str, object]:
        raise AssertionError("the brute force was asked again")

    monkeypatch.setattr(exactness, "solve_brute_force", never)
    monkeypatch.setattr(kept, "sources_key", lambda *a: changed(*a)[::-1])
    again = matching.run(options).rows
    assert [r["search"] for r in again] != [r["search"] for r in first]
    assert [{**r, "search": ""} for r in again] == [{**r, "search": ""} for r in first]
