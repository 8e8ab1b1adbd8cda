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
# A known fault of the matcher, one room seen: of several peaks at one placement, which differ in
# what fits and what was moved, it does not always find the highest, so its weights are too low.
OPEN = frozenset({10106, 10107, 10114})


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
    # Solutions, verdict and probabilities agree but for the open cases: one that is mended, too,
    # must be taken off the list.
    differing = {c.number for c, f in found.items() if not f.agrees}
    assert differing == OPEN & {c.number for c in found}
