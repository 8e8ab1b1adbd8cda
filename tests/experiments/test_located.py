"""Summaries of the experiments localization and system; what their tasks are."""

from __future__ import annotations

import pytest

from situgraph.experiments import localization, system

LOCATED = {
    "building": "six rooms", "verdict": "unique", "outcome": "right", "located_s": 4.0,
    "realtime": 2.0, "ate_slam_m": 0.005, "ate_building_m": 0.01, "ate_match_only_m": 0.02,
    "moved_seen": 2, "moved_told": 1, "invented": 0, "deviation_errors_m": [-0.004],
}  # fmt: skip
LOST = {"building": "corridor of 30 m", "verdict": "ambiguous", "outcome": "ambiguous",
        "located_s": None, "realtime": 3.0, "ate_slam_m": 0.03}  # fmt: skip


def test_localization_by_building_and_over_all() -> None:
    summary = localization.summarise([LOCATED, LOST])
    assert list(summary) == ["six rooms", "corridor of 30 m", "all"]
    assert summary["six rooms"]["ate_building_m"] == {"median": 0.01, "max": 0.01}
    assert summary["six rooms"]["deviation_error_median_m"] == pytest.approx(0.004)
    assert summary["corridor of 30 m"]["located"] == 0
    assert summary["corridor of 30 m"]["ate_building_m"]["median"] is None
    assert (summary["all"]["drives"], summary["all"]["wrong"]) == (2, 0)
    assert summary["corridor of 30 m"]["ambiguous"] == 1


def test_system_counts_what_became_of_the_runs() -> None:
    usual = {"building": "grid", "events": [], "realtime": 2.0, "peak_mb": 700.0, "located_s": 5.0}
    rows = [{**usual, "outcome": o} for o in ("right", "right", "ambiguous")]
    bag = {**usual, "building": system.BAG, "outcome": "right", "placement_error_m": 0.02,
           "duration": 130.0}  # fmt: skip
    summary = system.summarise([*rows, bag])
    assert summary["runs"] == 3
    assert (summary["right"], summary["ambiguous"], summary["wrong"]) == (2, 1, 0)
    assert summary["institute bag"]["outcome"] == "right"
