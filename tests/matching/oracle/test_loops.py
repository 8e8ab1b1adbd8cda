"""The brute force's compiled loops against the same said in a line of Python."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from situgraph.experiments.oracle.loops import (
    Crowd,
    Limits,
    best_assignment,
    least_squares,
    vertices,
)


@given(st.integers(0, 10_000))
def test_the_best_assignment_is_the_best_of_all(seed: int) -> None:
    rng = np.random.default_rng(seed)
    rows, columns = int(rng.integers(2, 5)), int(rng.integers(1, 6))
    possible = rng.random((rows, columns)) < 0.6
    fits = possible & (rng.random((rows, columns)) < 0.7)
    terms = rng.normal(size=(rows, columns))
    crossed = np.triu(rng.random((rows, rows)) < 0.5, 1)
    crossed |= crossed.T
    missing = float(rng.normal())

    def score(choice: tuple[int, ...]) -> float:
        used = [j for j in choice if j < columns]
        fitting = [i for i, j in enumerate(choice) if j < columns and fits[i, j]]
        if rows == 2 or not crossed.any():
            holds = len(fitting) == rows
        else:
            holds = any(crossed[i, k] for i, k in itertools.combinations(fitting, 2))
        possibly = all(j == columns or possible[i, j] for i, j in enumerate(choice))
        if not (possibly and holds and len(set(used)) == len(used) >= rows - 1):
            return -np.inf
        return float(sum(missing if j == columns else terms[i, j] for i, j in enumerate(choice)))

    choice = np.zeros(rows, dtype=np.int64)
    best = best_assignment(possible, fits, terms, crossed, missing, choice)
    assert best == pytest.approx(
        max(score(c) for c in itertools.product(range(columns + 1), repeat=rows))
    )
    if best > -np.inf:
        assert score(tuple(np.where(choice < 0, columns, choice))) == pytest.approx(best)


def test_vertices_are_where_tolerance_lines_cross_in_enough_boxes() -> None:
    planes = np.array([[0, 0], [1, 1]])
    crowd = Crowd(np.array([[0, 0]]), np.array([0, 2]), planes, np.eye(2), np.array([1.0, 2.0]))
    limits = Limits(0.1, 0.4, 0.15)
    everywhere = np.array([[-np.inf, -np.inf]]), np.array([[np.inf, np.inf]])
    found = vertices(crowd, limits, *everywhere, 1)
    steps = (-0.4, -0.15, 0.15, 0.4)
    assert np.allclose(found, [(1 + x, 2 + y) for x in steps for y in steps])
    assert not len(vertices(crowd, limits, *everywhere, 2))
    some = vertices(crowd, limits, np.array([[1.0, 2.0]]), np.array([[1.2, 3.0]]), 1)
    assert np.allclose(some, [(1.15, 2.15), (1.15, 2.4)])


def test_least_squares_finds_the_motion_that_was_made() -> None:
    rng = np.random.default_rng(0)
    arms, angles = rng.normal(size=(6, 2)), rng.uniform(-3, 3, 6)
    yaw, point = 0.05, np.array([1.0, -2.0])
    turn = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
    normals = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    offsets = ((arms @ turn.T + point) * normals).sum(axis=1)
    found, there = least_squares(
        arms,
        normals,
        offsets,
        np.full(6, -yaw),
        np.ones((6, 2)),
        (0.06, 0.03),
        0.0,
        np.zeros(2),
    )
    assert found == pytest.approx(yaw)
    assert there == pytest.approx(point)
