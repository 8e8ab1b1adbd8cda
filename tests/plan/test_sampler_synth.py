"""``situgraph synth``: files that belong together, and the truth apart."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import msgspec
import pytest

from situgraph.cli.app import main
from situgraph.plan.layouts import make_layout
from situgraph.plan.sample_truth import truth_from_json
from situgraph.plan.sampler import sample_online
from situgraph.plan.sampler_config import REALISTIC, DetectionRates
from situgraph.plan.six_rooms import six_rooms
from situgraph.scenegraph.codec import read_json


def run(*arguments: str) -> int:
    with pytest.raises(SystemExit) as ended:
        main(["synth", *arguments])
    return int(ended.value.code or 0)


def answer(capfdbinary: pytest.CaptureFixture[bytes], *arguments: str) -> dict[str, Any]:
    assert run(*arguments, "--json") == 0
    found = json.loads(capfdbinary.readouterr().out)
    assert isinstance(found, dict)
    return found


def test_the_files_are_what_the_library_makes(tmp_path: Path) -> None:
    folder = tmp_path / "case"
    options = ("--rooms", "20", "--see", "6", "--noise", "realistic", "--missed", "door=0.5")
    assert run(*options, "--seed", "3", "--ifc", "-o", str(folder)) == 0
    names = {p.name for p in folder.iterdir()}
    assert names == {"prior.json", "online.json", "truth.json", "prior.ifc"}
    prior = make_layout("random", 20, 3)
    rates = {"door": DetectionRates(missed=0.5)}
    config = msgspec.structs.replace(REALISTIC, detection=rates)
    sample = sample_online(prior, 6, 3, config)
    assert read_json(folder / "prior.json") == prior
    assert read_json(folder / "online.json") == sample.online
    assert truth_from_json((folder / "truth.json").read_bytes()) == sample.truth
    for name in ("prior.json", "online.json"):
        assert b"truth" not in (folder / name).read_bytes()


def test_every_noise_has_its_option(capfdbinary: pytest.CaptureFixture[bytes]) -> None:
    found = answer(
        capfdbinary, "--rooms", "60", "--see", "40", "--missing-planes", "0.3", "--false-rooms",
        "0.2", "--moved-walls", "0.2", "--missed", "0.3", "--false", "0.2", "--duplicated", "0.2",
        "--confused", "0.2", "--wrong-wall", "0.2",
    )  # fmt: skip
    assert found["prior"]["rooms"] == 60
    assert found["online"]["rooms"] == 48
    for kind in ("missing_planes", "moved_planes", "false_rooms", "missed_objects",
                 "false_objects", "duplicates", "confused", "wrong_wall"):  # fmt: skip
        assert found["truth"][kind] > 0


def test_layouts_of_all_sorts(capfdbinary: pytest.CaptureFixture[bytes]) -> None:
    grid = answer(
        capfdbinary, "--kind", "grid", "--rooms", "12", "--shape", "4x3", "--density", "0"
    )
    assert grid["prior"]["objects"] == 0
    six = answer(capfdbinary, "--six-rooms", "5", "--see", "2", "--start", "r1", "--mirror")
    assert six["prior"]["rooms"] == 5
    assert six["online"]["rooms"] == 2
    odd = answer(capfdbinary, "--symmetry", "global", "--rooms", "9", "--break", "object")
    assert odd["prior"]["rooms"] == 9


def test_any_plan_can_be_sampled(tmp_path: Path, capfdbinary: pytest.CaptureFixture[bytes]) -> None:
    assert run("--six-rooms", "6", "--ifc", "-o", str(tmp_path / "six")) == 0
    capfdbinary.readouterr()
    plan = str(tmp_path / "six" / "prior.ifc")
    found = answer(capfdbinary, "--plan", plan, "--see", "3")
    assert found["prior"]["objects"] == len(six_rooms().objects)
    assert found["online"]["rooms"] == 3


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--rooms", "0"), "rooms"),
        (("--density", "1.5"), "density"),
        (("--kind", "grid", "--shape", "wide"), "columns"),
        (("--see", "2", "--missed", "2"), "missed"),
        (("--see", "2", "--missed", "door=often"), "rate"),
        (("--wall-noise", "0.1"), "--see"),
        (("--see", "2", "--start", "kitchen"), "kitchen"),
        (("--six-rooms", "7"), "1 to 6"),
        (("--plan", "nowhere.ifc", "--see", "2"), "nowhere.ifc"),
        (("--rooms", "4", "--symmetry", "none", "--density", "0", "--break", "object"), "alter"),
    ],
)
def test_bad_requests_end_with_one_sentence(
    options: tuple[str, ...], words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(*options) == 2
    shown = capsys.readouterr()
    assert shown.out == ""
    assert words in shown.err
    assert "Traceback" not in shown.err


def test_finished_work_is_not_overwritten(tmp_path: Path) -> None:
    (tmp_path / "case").mkdir()
    (tmp_path / "case" / "mine.txt").write_text("keep")
    assert run("--rooms", "3", "-o", str(tmp_path / "case")) == 2
    assert [p.name for p in tmp_path.iterdir()] == ["case"]
    assert (tmp_path / "case" / "mine.txt").read_text() == "keep"
