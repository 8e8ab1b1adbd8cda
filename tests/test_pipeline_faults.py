"""Recordings with something wrong: a warning each, never a crash, and still a map."""

from __future__ import annotations

from collections.abc import Collection, Iterator

import numpy as np
import pytest
from tests.test_pipeline import QUICK, plan

from situgraph.config import Settings, load_settings
from situgraph.experiments.faults import FAULTS, faulty
from situgraph.io.recording import STREAMS, Message, RecordingInfo, Stream
from situgraph.objects.detections import Detection
from situgraph.run import run_log
from situgraph.scenegraph.graph import Warning
from situgraph.sim.simulation import Simulation
from situgraph.sim.truth import Truth
from situgraph.slam.evaluation import absolute_errors, associated


class Kept:
    """A drive whose messages are kept, so that each fault is tried on the same ones."""

    def __init__(self, drive: Simulation) -> None:
        self.info: RecordingInfo = drive.info
        self.warnings: tuple[Warning, ...] = ()
        self.truth: Truth = drive.truth
        self._messages = list(drive.messages())

    def messages(self, streams: Collection[Stream] = STREAMS) -> Iterator[Message]:
        return iter(self._messages)


class Blind:
    """A detector that finds nothing."""

    name = "blind"
    categories = frozenset[str]()

    def detect(self, rgb: np.ndarray, stamp: float) -> list[Detection]:
        return []


@pytest.fixture(scope="module")
def drive() -> Kept:
    config = load_settings(None, QUICK).sim
    return Kept(Simulation(plan(), config, seed=2, rooms=("a", "b"), renderer="cpu"))


@pytest.fixture(scope="module")
def usual(drive: Kept) -> float:
    return error_of(drive, None)[0]


def error_of(drive: Kept, fault: str | None) -> tuple[float, set[str], int]:
    """ATE (m), codes of the warnings, rooms."""
    recording = drive if fault is None else faulty(drive, fault, seed=1)
    run, pipeline = run_log(recording, Settings(), detector=Blind())
    stamps, poses = pipeline.slam.trajectory()
    i, j = associated(drive.truth.stamps, stamps, 0.02)
    ate = absolute_errors(drive.truth.poses[i], poses[j]).rmse
    return ate, {w.code for w in run.warnings}, run.rooms


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_is_named_and_survived(drive: Kept, usual: float, fault: str) -> None:
    ate, codes, rooms = error_of(drive, fault)
    assert set(FAULTS[fault][1]) <= codes
    assert rooms >= 1
    assert ate < max(2.0 * usual, 0.05)


def test_a_sound_drive_has_none_of_these_warnings(drive: Kept) -> None:
    _, codes, _ = error_of(drive, None)
    assert not codes & {code for _, named in FAULTS.values() for code in named}
