"""``situgraph view``, as a user calls it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner, Result
from tests.view.buildings import ambiguous, office, seen

from situgraph.cli.app import main
from situgraph.scenegraph.codec import write_json


def run(*words: object) -> Result:
    return CliRunner().invoke(main, ["view", *(str(w) for w in words)], standalone_mode=False)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    prior = office()
    online = seen(prior, ("r0-0-0", "r0-0-1", "r0-1-0"))
    write_json(prior, tmp_path / "prior.json")
    write_json(online, tmp_path / "online.json")
    (tmp_path / "match.json").write_text(json.dumps(ambiguous(online, prior)))
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_graph_becomes_a_report_in_the_current_folder(folder: Path) -> None:
    result = run("prior.json", "--json")
    assert result.exit_code == 0
    assert json.loads(result.stdout) == {
        "file": "prior.json", "kind": "graph", "written": "prior.html"
    }  # fmt: skip
    assert (folder / "prior.html").read_text().startswith("<!doctype html>")


@pytest.mark.parametrize("show", ["best", "rivals", "advice"])
def test_a_match_is_drawn_with_its_graphs(folder: Path, show: str) -> None:
    words = ("--online", "online.json", "--prior", "prior.json", "--show", show)
    assert run("match.json", *words, "-o", "m.svg").exit_code == 0
    assert (folder / "m.svg").read_text().startswith("<?xml")


def test_a_match_may_name_its_graphs_itself(folder: Path) -> None:
    match = json.loads((folder / "match.json").read_text())
    (folder / "match.json").write_text(
        json.dumps({**match, "online": "online.json", "prior": "prior.json"})
    )
    result = run("match.json", "--json")
    assert json.loads(result.stdout)["kind"] == "match"


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("match.json",), "does not say which online graph it is of; add --online FILE"),
        (("nowhere.json",), "no such file"),
        (("prior.json", "-o", "a.gif"), "'.gif' is no picture format"),
        (("prior.json", "--storey", "9"), "has no storey '9'"),
        (("empty",), "holds no report.html"),
        (("bad.json",), "is not JSON"),
    ],
)
def test_bad_input_is_one_sentence(folder: Path, words: tuple[str, ...], sentence: str) -> None:
    (folder / "empty").mkdir()
    (folder / "bad.json").write_text('{"format": "situgraph/match", "version": 1,')
    result = CliRunner().invoke(main, ["view", *words])
    assert result.exit_code == 2
    assert sentence in result.stderr
    assert len(result.stderr.strip().splitlines()) == 1
    assert not list(folder.glob("*.html"))


def test_a_run_is_looked_at_by_its_report(folder: Path) -> None:
    run_folder = folder / "run"
    run_folder.mkdir()
    (run_folder / "report.html").write_text("<!doctype html>")
    result = run("run", "--json")
    assert json.loads(result.stdout)["written"] == "run/report.html"
    assert run("run", "-o", "copy.html").exit_code == 0
    assert (folder / "copy.html").exists()
