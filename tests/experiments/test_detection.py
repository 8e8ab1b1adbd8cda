from __future__ import annotations

import numpy as np
import pytest

from situgraph.experiments.detection import summarise
from situgraph.experiments.instances import (
    FrameScores,
    average_precision,
    counts,
    mask_iou,
    matched,
    rates,
)
from situgraph.experiments.passages import crossed_doors
from situgraph.experiments.relations import _counts
from situgraph.objects.config import ObjectsConfig
from situgraph.objects.detections import Detection
from situgraph.plan.six_rooms import six_rooms
from situgraph.scenegraph.graph import Object


def thing(key: str, x: float, category: str = "door", z: float = 1.0) -> Object:
    return Object(key, category, (x, 0.0, z))


def test_pairs_are_one_to_one_near_and_of_one_category() -> None:
    found = [thing("f0", 0.1), thing("f1", 0.3), thing("f2", 5.0, "window")]
    true = [thing("t0", 0.0), thing("t1", 0.45), thing("t2", 5.0)]
    assert matched(found, true) == [(0, 0), (1, 1)]
    assert matched(found, []) == []


def test_what_was_not_asked_for_is_right_but_nobody_misses_it() -> None:
    found = [thing("f0", 0.0), thing("f1", 3.0), thing("f2", 9.0)]
    true = [thing("t0", 0.0), thing("t1", 3.0), thing("t2", 6.0), thing("t3", 20.0)]
    parts = counts(found, true, {"t0", "t2"}, ("door",))
    assert parts["door"] == {"found": 3, "right": 2, "true": 2, "recalled": 1}
    table = rates(parts.values())
    assert table["precision"] == pytest.approx(2 / 3)
    assert (table["recall"], table["f1"]) == (0.5, pytest.approx(4 / 7))
    assert rates([])["f1"] is None


def square(top: int, left: int) -> np.ndarray:
    mask = np.zeros((80, 80), dtype=bool)
    mask[top : top + 30, left : left + 30] = True
    return mask


def test_masks_are_scored_by_overlap() -> None:
    scores = FrameScores()
    true = [("door", square(0, 0)), ("door", square(40, 40))]
    found = [
        Detection(square(0, 0), "door", 0.9),
        Detection(square(0, 45), "door", 0.8),
        Detection(square(40, 45), "door", 0.7),
    ]
    scores.add(found, true, ("door", "window"))
    row = scores.row()
    assert set(row) == {"door"}
    assert mask_iou([row["door"]]) == pytest.approx((900 + 750) / (900 + 900 + 900 + 150))
    # right, wrong, right: precision 1 up to half of the recall, 2/3 for the rest
    assert average_precision([row["door"]]) == pytest.approx(0.5 + 0.5 * 2 / 3)
    assert average_precision([]) is None
    assert mask_iou([]) is None


def test_the_summary_is_by_detector_then_category() -> None:
    part = {"found": 2, "right": 2, "true": 2, "recalled": 1}
    claims = {"shared": 5, "either": 10, "true": 1, "hits": [[0.9, True]]}
    own = {
        "objects": {"window": part, "door": part},
        "camera": {"window": part, "door": part},
        "frames": {"window": claims, "door": claims},
        "ms": 10.0,
        "stage_ms": 20.0,
    }
    row = {"building": "six rooms", "detectors": {"network": own, "oracle": own}}
    summary = summarise([row, {**row, "building": "FZK-Haus"}])
    assert set(summary) == {"network", "oracle"}
    assert summary["network"]["all"]["recall"] == 0.5
    assert summary["network"]["FZK-Haus"]["door"]["precision"] == 1.0
    assert summary["oracle"]["frames"]["mask_iou"] == {"window": 0.5, "door": 0.5}


def test_a_path_through_a_doorway_crosses_that_door_alone() -> None:
    plan = six_rooms()
    door = plan.object_by_id["o5"]
    x, y, _ = door.center
    path = np.array([[x, y - 1.0, 0.5], [x, y + 1.0, 0.5]])
    assert [d.id for d in crossed_doors(plan, path)] == ["o5"]
    assert crossed_doors(plan, path + np.array([1.5, 0.0, 0.0])) == []


@pytest.mark.parametrize("footprints", [True, False])
def test_without_errors_all_relations_of_the_six_rooms_are_right(footprints) -> None:
    count = _counts(six_rooms(), 0.0, footprints, np.random.default_rng(0), ObjectsConfig())
    assert count["in_room"] == count["objects"] > 30
    assert count["on_plane"] == count["hung"] > 25


def test_where_a_thing_was_seen_from_tells_the_side_of_the_wall() -> None:
    count = _counts(six_rooms(), 0.2, True, np.random.default_rng(0), ObjectsConfig())
    assert count["in_room"] == count["objects"]
    assert count["in_room_unseen"] < count["in_room"]
