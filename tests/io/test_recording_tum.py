"""Trajectories as text."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from situgraph.errors import InputError
from situgraph.io.tum import read_tum, write_tum

numbers = st.floats(-1e4, 1e4)
quaternions = st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: np.linalg.norm(q) > 0.1)


@given(rows=st.lists(st.tuples(st.floats(0, 2e9), numbers, numbers, numbers, quaternions)))
def test_what_is_written_is_read(rows: list, tmp_path_factory: pytest.TempPathFactory) -> None:
    stamps = np.array([r[0] for r in rows])
    poses = np.array([[*r[1:4], *(np.array(r[4]) / np.linalg.norm(r[4]))] for r in rows])
    file = write_tum(tmp_path_factory.mktemp("tum") / "t.tum", stamps, poses.reshape(-1, 7))
    t, p = read_tum(file)
    assert np.allclose(t, stamps, rtol=0, atol=1e-6)
    assert np.allclose(p, poses.reshape(-1, 7), rtol=0, atol=1e-8)


def test_comments_and_commas_are_read(tmp_path: Path) -> None:
    file = tmp_path / "t.txt"
    file.write_text("# stamp x y z q\n\n1.5, 1, 2, 3, 0, 0, 0, 2\n")
    t, p = read_tum(file)
    assert t.tolist() == [1.5]
    assert p.tolist() == [[1, 2, 3, 0, 0, 0, 1]]


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("1 2 3\n", "line 1: not a pose"),
        ("# a\n1 0 0 0 0 0 0 one\n", "line 2: not a pose"),
        ("1 nan 0 0 0 0 0 1\n", "line 1: not a pose"),
        ("1 0 0 0 0 0 0 0\n", "a quaternion is zero"),
    ],
)
def test_a_bad_line_is_named(tmp_path: Path, text: str, sentence: str) -> None:
    file = tmp_path / "t.tum"
    file.write_text(text)
    with pytest.raises(InputError, match=sentence):
        read_tum(file)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none\.tum"):
        read_tum(tmp_path / "none.tum")
