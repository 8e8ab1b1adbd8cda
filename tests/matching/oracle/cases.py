"""The 200 small cases on which matcher and brute force are compared in the tests.

Two files run a hundred each, so that two processes share them. The experiment ``matching`` compares
thousands of all sizes.
"""

from __future__ import annotations

import functools

from situgraph.experiments.oracle.cases import Case, draw
from situgraph.experiments.oracle.comparison import Comparison, compare
from situgraph.experiments.oracle.definition import Definition
from situgraph.experiments.oracle.problem import Problem

CASES = 200
BLOCK = 20
FIRST = 10_000
LARGEST = 26  # room pairs: 200 such cases take seconds


@functools.cache
def small_cases() -> list[Case]:
    drawn = (draw(FIRST + k) for k in range(10 * CASES))
    return [c for c in drawn if c.planned * c.seen <= LARGEST][:CASES]


def compared(block: int) -> dict[Case, Comparison]:
    """The comparisons of a block of cases."""
    found = {}
    for case in small_cases()[block * BLOCK : (block + 1) * BLOCK]:
        prior, sample = case.graphs()
        problem = Problem(sample.online, prior, case.policy, Definition())
        found[case] = compare(sample.online, prior, problem)
    return found


def check(block: int) -> None:
    found = compared(block)
    assert not {c: f for c, f in found.items() if f.missed or f.invented}
    # Solutions, verdict and probabilities, too.
    assert not {c: f for c, f in found.items() if not f.agrees}
