"""Errors of trajectories: against closed forms, and against what evo 1.38.1 prints."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from situgraph.geometry.poses import matrix_to_pose, pose_to_matrix
from situgraph.slam.evaluation import (
    absolute_errors,
    alignment,
    associated,
    relative_errors,
    statistics,
)

angle = st.floats(-3.1, 3.1)
metres = st.floats(-50, 50)


def some_path(count: int = 60) -> np.ndarray:
    """A winding path: poses (n, 7)."""
    t = np.linspace(0, 6, count)
    yaw = 0.4 * np.sin(t)
    zero = np.zeros(count)
    return np.column_stack(
        [3 * np.cos(t), 2 * np.sin(2 * t), 0.1 * t, zero, zero, np.sin(yaw / 2), np.cos(yaw / 2)]
    )


@given(angle, angle, metres, metres)
def test_a_rigid_motion_of_the_whole_is_no_error(a: float, b: float, x: float, y: float) -> None:
    path = some_path()
    turn = np.array([np.cos(a / 2), 0, np.sin(a / 2)])
    motion = pose_to_matrix([x, y, b, 0, turn[2], 0, turn[0]])
    moved = matrix_to_pose(motion @ pose_to_matrix(path))
    assert absolute_errors(path, moved).largest < 1e-6
    assert np.allclose(alignment(moved[:, :3], path[:, :3]), motion, atol=1e-6)
    shift, turned = relative_errors(path, moved)
    assert shift.largest < 1e-6
    assert turned.largest < 1e-6


def test_without_alignment_a_shift_is_the_error() -> None:
    path = some_path()
    moved = path + np.array([0.3, 0.4, 0, 0, 0, 0, 0])
    assert absolute_errors(path, moved, align=False).rmse == pytest.approx(0.5)


def test_a_constant_slip_shows_in_the_relative_error() -> None:
    straight = np.zeros((11, 7))
    straight[:, 6] = 1.0
    straight[:, 0] = np.arange(11)
    slipping = straight.copy()
    slipping[:, 0] *= 1.02
    shift, turned = relative_errors(straight, slipping)
    assert shift.mean == pytest.approx(0.02)
    assert turned.largest == pytest.approx(0.0)


def test_stamps_are_paired_with_the_nearest_within_reach() -> None:
    i, j = associated([0.0, 1.0, 2.0, 3.0], [0.004, 1.5, 2.996], 0.01)
    assert i.tolist() == [0, 3]
    assert j.tolist() == [0, 2]


def test_nothing_has_no_error() -> None:
    assert statistics([]).number == 0
    assert np.isnan(statistics([]).rmse)


def test_figures_are_those_of_evo() -> None:
    """``evo_ape tum -a`` and ``evo_rpe tum --delta 1 --delta_unit f`` print six decimals."""
    path, other = some_path(), some_path()
    k = np.arange(60)
    other[:, :3] += np.column_stack([0.05 * np.sin(0.7 * k), 0.03 * np.cos(1.1 * k), k / 6000])
    yaw = 0.4 * np.sin(np.linspace(0, 6, 60)) + 0.02 * np.sin(0.3 * k)
    other[:, 5], other[:, 6] = np.sin(yaw / 2), np.cos(yaw / 2)
    ape = absolute_errors(path, other)
    shift, turn = relative_errors(path, other)
    found = [(e.rmse, e.mean, e.median, e.largest) for e in (ape, shift, turn)]
    printed = [
        (0.040929, 0.038822, 0.041004, 0.058112),
        (0.033393, 0.031825, 0.033038, 0.051396),
        (0.004181, 0.003744, 0.004234, 0.005977),
    ]
    assert np.abs(np.array(found) - printed).max() < 1e-6
