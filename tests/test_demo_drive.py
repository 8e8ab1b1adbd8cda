"""The demo drives, locates and reports."""

from __future__ import annotations

import zipfile
from pathlib import Path

from situgraph.config import Settings
from situgraph.demo_drive import run_drive
from situgraph.scenegraph.codec import read_json


def test_one_room_is_enough_with_objects_and_not_without(tmp_path: Path) -> None:
    demo = run_drive(tmp_path, Settings(), rooms=1)
    walls, _, likelihood = demo.steps[0].answers
    assert (walls.verdict, likelihood.verdict) == ("ambiguous", "unique")
    assert likelihood.right
    assert demo.run.detector == "network"
    assert "simulated by" in demo.renderer
    assert demo.run.located_at is not None
    assert demo.run.judgement is not None
    assert (demo.run.judgement.ate_building_rmse or 1.0) < 0.1
    names = {Path(f).name for f in demo.files}
    assert names == {p.name for p in tmp_path.iterdir()}
    located = read_json(tmp_path / "building.json")
    assert len(located.rooms) == 1
    with zipfile.ZipFile(tmp_path / "deviations.bcfzip") as archive:
        assert "bcf.version" in archive.namelist()
    page = (tmp_path / "report.html").read_text()
    for title in (
        "Room by room",
        "Where the robot was",
        "When it knew",
        "As built",
        "What it cost",
    ):
        assert title in page
