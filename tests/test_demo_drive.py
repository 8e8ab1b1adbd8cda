"""The demo drives, locates and reports."""

from __future__ import annotations

import os
import subprocess
import sys
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


def test_without_opengl_the_demo_ends_well_and_says_what_it_used(tmp_path: Path) -> None:
    """The library is hidden as moderngl looks for it; the switch is automatic."""
    quick = ("sim.robot.look_turn=2", "sim.camera.fallback_width=64", "sim.camera.rate=0.5")
    options = [word for setting in quick for word in ("--set", setting)]
    result = subprocess.run(
        [sys.executable, "-m", "situgraph.cli", "demo", "--rooms", "1", "-o", str(tmp_path / "out"),
         *options],
        env={**os.environ, "GLCONTEXT_LINUX_LIBEGL": "libnothere.so"},
        capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    assert result.returncode == 0, result.stderr
    assert "CPU ray casting" in result.stderr
    assert "Detector: network" in result.stderr
    assert (tmp_path / "out" / "report.html").is_file()
