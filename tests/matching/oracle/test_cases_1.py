"""The matcher against the brute force: cases 100 to 199 of 200."""

from __future__ import annotations

import pytest
from tests.matching.oracle.cases import check


@pytest.mark.parametrize("block", range(5, 10))
def test_the_same_candidates_solutions_and_verdict(block: int) -> None:
    check(block)
