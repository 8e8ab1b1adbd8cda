"""Cases in which the matcher once missed a placement that the brute force found."""

from __future__ import annotations

import pytest

from situgraph.experiments.oracle.cases import draw
from situgraph.experiments.oracle.comparison import compare
from situgraph.experiments.oracle.definition import Definition
from situgraph.experiments.oracle.problem import Problem


@pytest.mark.parametrize("number", [68])  # two peaks near each other, one box that led to one
def test_nothing_is_missed(number: int) -> None:
    case = draw(number)
    prior, sample = case.graphs()
    problem = Problem(sample.online, prior, case.policy, Definition())
    assert compare(sample.online, prior, problem).missed == 0
