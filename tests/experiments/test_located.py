"""Summaries of the experiments localization and system; what their tasks are."""

from __future__ import annotations

import numpy as np
import pytest

from situgraph.coupling import Deviation as Told
from situgraph.experiments import localization, system
from situgraph.geometry.poses import Placement
from situgraph.judging import judged_deviations
from situgraph.plan.six_rooms import six_rooms
from situgraph.sim.deviations import Deviation
from situgraph.sim.truth import Truth

LOCATED = {
    "building": "six rooms", "verdict": "unique", "outcome": "right", "located_s": 4.0,
    "realtime": 2.0, "ate_slam_m": 0.005, "ate_building_m": 0.01, "ate_match_only_m": 0.02,
    "moved_seen": 2, "moved_told": 1, "invented": 0, "deviation_errors_m": [-0.004],
    "told_false": {"extra-object": 2, "moved-wall": 1}, "normalised_errors": [1.0, -7.0],
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
    assert (summary["all"]["told_false"], summary["corridor of 30 m"]["told_false"]) == (3, 0)
    assert summary["all"]["normalised_error_rms"] == pytest.approx(5.0)
    assert summary["all"]["beyond_3_sigma"] == 0.5
    assert summary["all"]["told_false_of"] == {"extra-object": 2, "moved-wall": 1}


def test_system_counts_what_became_of_the_runs() -> None:
    usual = {"building": "grid", "events": [], "realtime": 2.0, "peak_mb": 700.0, "located_s": 5.0}
    rows = [{**usual, "outcome": o} for o in ("right", "right", "ambiguous")]
    rows[0] |= {"told_true": {"moved-wall": 2}, "told_false": {"extra-object": 1}}
    rows[1] |= {"told_true": {"moved-wall": 1}, "told_false": {}}
    bag = {**usual, "building": system.BAG, "outcome": "right", "placement_error_m": 0.02,
           "duration": 130.0}  # fmt: skip
    summary = system.summarise([*rows, bag])
    assert summary["runs"] == 3
    assert (summary["right"], summary["ambiguous"], summary["wrong"]) == (2, 1, 0)
    assert summary["institute bag"]["outcome"] == "right"
    assert (summary["told_true"], summary["told_false"]) == (3, 1)
    assert summary["told"]["false"] == {"extra-object": 1}


def test_a_told_deviation_is_true_where_the_building_was_changed() -> None:
    plan = six_rooms()
    built = (
        Deviation("moved-wall", ("p1", "p15"), (0.1, -0.1)),
        Deviation("missing-door", ("o3",)),
        Deviation("extra-furniture", ("x",)),
    )
    truth = Truth(plan, Placement(), np.zeros(0), np.zeros((0, 7)), (), built, (), lambda _: None)
    told = [
        Told("moved-wall", "wall", (0, 0, 0), "moved", prior="p1"),
        Told("moved-wall", "wall", (0, 0, 0), "not moved", prior="p2"),
        Told("missing-object", "door", (0, 0, 0), "gone", prior="o3"),
        Told("extra-object", "door", (0, 0, 0), "a phantom", online="o9"),
    ]
    judged = judged_deviations(told, truth)
    assert judged["told_true"] == {"moved-wall": 1, "missing-object": 1}
    assert judged["told_false"] == {"moved-wall": 1, "extra-object": 1}
    assert judged["told_false_what"] == ["moved-wall: not moved", "extra-object: a phantom"]
