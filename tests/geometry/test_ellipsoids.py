from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

from situgraph.geometry import ellipsoids

size = st.floats(0.1, 2.0)
axes = st.tuples(size, size, size)
seeds = st.integers(0, 10_000)


def turned(semi_axes, seed):
    q = Rotation.random(random_state=seed).as_quat()
    return ellipsoids.shape_matrix(semi_axes, q)


@given(size, size, st.floats(0.0, 5.0))
def test_spheres_overlap_when_closer_than_their_radii(a, b, distance) -> None:
    assume(abs(distance - a - b) > 1e-6)
    shapes = [ellipsoids.shape_matrix((r, r, r), (0, 0, 0, 1)) for r in (a, b)]
    assert ellipsoids.overlap((distance, 0, 0), *shapes) == (distance < a + b)


@given(axes, axes, seeds, st.tuples(*[st.floats(-3, 3)] * 3))
def test_overlap_agrees_with_a_nearest_point_search(first, second, seed, offset) -> None:
    a, b = turned(first, seed), turned(second, seed + 1)
    half = np.linalg.cholesky(a)
    d = np.array(offset)
    inverse = np.linalg.inv(b)

    def reach(u):  # points of the first ellipsoid, seen in the metric of the second
        x = half @ (u / max(1.0, np.linalg.norm(u))) - d
        return x @ inverse @ x

    towards = np.linalg.solve(half, d)
    starts = (np.zeros(3), towards / (1e-9 + np.linalg.norm(towards)))
    options = {"xatol": 1e-8, "fatol": 1e-10}
    best = min(minimize(reach, x, method="Nelder-Mead", options=options).fun for x in starts)
    assume(abs(best - 1.0) > 1e-3)
    assert ellipsoids.overlap(d, a, b) == (best < 1.0)


@given(axes, seeds)
def test_axes_and_rotation_give_the_shape_back(semi_axes, seed) -> None:
    shape = turned(semi_axes, seed)
    lengths, q = ellipsoids.axes_and_rotation(shape)
    assert np.all(np.diff(lengths) <= 1e-9)
    assert np.allclose(ellipsoids.shape_matrix(lengths, q), shape, atol=1e-9)


def test_an_evenly_covered_face_is_reached_to_its_rim() -> None:
    u, v = np.meshgrid(np.linspace(-0.45, 0.45, 40), np.linspace(0.0, 2.1, 80))
    points = np.stack([u.ravel(), np.zeros(u.size), v.ravel()], axis=1)
    center, shape = ellipsoids.fit(points, floor=0.05, trim=0.0)
    lengths, _ = ellipsoids.axes_and_rotation(shape)
    assert np.allclose(center, (0, 0, 1.05), atol=1e-9)
    assert np.allclose(lengths, (1.05, 0.45, 0.05), rtol=0.05)


def test_one_stray_point_in_a_hundred_moves_the_centre_by_centimetres_only() -> None:
    rng = np.random.default_rng(0)
    points = rng.uniform((-0.5, -0.02, 0), (0.5, 0.02, 2), (400, 3))
    stray = np.concatenate([points, [(6.0, 3.0, 1.0)] * 4])
    center, _ = ellipsoids.fit(stray)
    assert np.linalg.norm(center - points.mean(axis=0)) < 0.03


@pytest.mark.parametrize("count", [1, 2, 3])
def test_few_points_still_give_an_ellipsoid(count) -> None:
    points = np.arange(3.0 * count).reshape(count, 3)
    _, shape = ellipsoids.fit(points)
    assert np.all(np.linalg.eigvalsh(shape) >= 0.05**2 * (1 - 1e-9))


def test_no_points_is_an_error() -> None:
    with pytest.raises(ValueError, match="at least one"):
        ellipsoids.fit(np.zeros((0, 3)))
