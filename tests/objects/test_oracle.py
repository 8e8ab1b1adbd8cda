from __future__ import annotations

import numpy as np

from situgraph.objects.oracle import OracleConfig, OracleDetector

IDS = np.zeros((120, 160), dtype=np.int32)
IDS[20:100, 30:70] = 1
IDS[30:70, 100:140] = 2
RGB = np.zeros((120, 160, 3), np.uint8)
CATEGORIES = {1: "door", 2: "window"}
PERFECT = OracleConfig(miss=0, confusion=0, false_positive=0, erosion=0)


def oracle(config=None, seed=0, depth=None):
    return OracleDetector(lambda stamp: (IDS, depth), CATEGORIES, config, seed)


def test_without_errors_it_is_the_truth() -> None:
    door, window = oracle(PERFECT).detect(RGB, 1.0)
    assert (door.category, window.category) == ("door", "window")
    assert np.array_equal(door.mask, IDS == 1)


def test_the_same_frame_always_gets_the_same_errors() -> None:
    one, two = oracle(), oracle()
    two.detect(RGB, 5.0)
    for stamp in (1.0, 2.0, 3.0):
        a, b = one.detect(RGB, stamp), two.detect(RGB, stamp)
        assert [d.category for d in a] == [d.category for d in b]
        assert all(np.array_equal(x.mask, y.mask) for x, y in zip(a, b))


def test_rates_are_met() -> None:
    config = OracleConfig(miss=0.2, confusion=0.1, false_positive=0.0, erosion=0)
    frames = [oracle(config).detect(RGB, 0.1 * k) for k in range(2000)]
    doors = [d for f in frames for d in f if np.array_equal(d.mask, IDS == 1)]
    assert abs(len(doors) / 2000 - 0.8) < 0.03
    assert abs(np.mean([d.category == "window" for d in doors]) - 0.1) < 0.03


def test_far_instances_are_missed_more_often() -> None:
    def rate(distance):
        depth = np.full(IDS.shape, distance)
        detector = oracle(OracleConfig(false_positive=0), depth=depth)
        return np.mean([len(detector.detect(RGB, 0.1 * k)) for k in range(500)])

    assert rate(6.0) < 0.6 * rate(2.0)
