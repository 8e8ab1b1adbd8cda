"""Experiment ``scale``: the promised keys (no time is asserted)."""

from __future__ import annotations

from pathlib import Path

import pytest

from situgraph.experiments import scale
from situgraph.experiments.runner import RunOptions


def test_summary_has_the_promised_keys(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    sizes = {"6x12": scale.SIZES["6x12"], "grid 50x500": scale.Size(5, 20, "grid")}
    monkeypatch.setattr(scale, "SIZES", sizes)
    monkeypatch.setattr(scale, "LADDER", (60, 100, 200))
    monkeypatch.setattr(scale, "STEEP_FROM", 100)
    monkeypatch.setattr(scale, "_in_fresh_processes", fresh)
    options = RunOptions(folder=tmp_path, extra={"samples": 2, "buildings": 1})
    summary = scale.run(options).to_dict()["summary"]
    assert (tmp_path / "scale.png").exists()
    for key in ("median_ms", "p95_ms", "peak_mb", "index_ms"):
        assert set(summary[key]) == set(sizes)
        assert all(value > 0 for value in summary[key].values())
    assert isinstance(summary["exponent_rooms"], float)
    assert summary["first_use_s"] == 9.0


def fresh(online: object, prior: object, first: bool) -> dict[str, float]:
    found = {"fresh_process_s": 1.0, "loaded_mb": 50.0, "peak_mb": 60.0}
    return {**found, "first_use_s": 9.0} if first else found


def test_the_ladder_reaches_a_hundred_thousand_rooms() -> None:
    assert scale.LADDER[-1] == 100_000
    named = {"6x12", "10x100", "50x500", "50x10000", "grid 50x500"}
    assert set(scale.SIZES) == named | {"bent 50x500"}


def test_grids_are_as_square_as_their_number_allows() -> None:
    task = {"kind": "grid", "planned": 500, "seed": 0, "building": 0}
    assert len(scale.building(task).rooms) == 500
