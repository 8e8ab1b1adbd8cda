"""Experiment ``slam``: the promised keys, from a drive of some seconds."""

from __future__ import annotations

from pathlib import Path

import pytest
from tests.test_pipeline import plan

from situgraph.errors import InputError
from situgraph.experiments import slam, slam_buildings
from situgraph.experiments.runner import RunOptions
from situgraph.experiments.slam_buildings import Drive


def test_a_drive_is_judged_and_measured(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    tiny = {"six rooms": lambda data, full: Drive(plan(), ("a",))}
    monkeypatch.setattr(slam_buildings, "DRIVES", tiny)
    extra = {"buildings": "six rooms; six rooms, corrupt scans", "camera": False}
    result = slam.run(RunOptions(folder=tmp_path, extra=extra))
    assert list(result.summary) == ["six rooms", "six rooms, corrupt scans"]
    figures = result.summary["six rooms"]
    assert figures["ate_m"]["max"] < 0.05
    assert figures["wall_offset_median_m"] < 0.02
    assert figures["room_precision"] == 1.0
    assert figures["realtime_factor"] > 0
    assert figures["peak_mb"] > 10
    assert "scan-odd" in result.rows[1]["warnings"]
    assert sum(figures["placed"].values()) == figures["runs"] == 1


def test_an_unknown_building_is_refused() -> None:
    with pytest.raises(InputError, match="unknown"):
        slam.run(RunOptions(extra={"buildings": "castle"}))


@pytest.mark.parametrize("full", [True, False])
@pytest.mark.parametrize("name", ["six rooms", "corridor of 30 m", "two storeys"])
def test_the_made_buildings_have_the_rooms_they_visit(name: str, full: bool) -> None:
    building, rooms = slam_buildings.drive(name, Path(), full)
    assert set(rooms) <= {r.id for r in building.rooms}
