from __future__ import annotations

import pytest
from tests.matching.oracle.cases import check_candidates


@pytest.mark.parametrize("number", range(75, 150))
def test_no_candidate_is_missed_and_none_invented(number) -> None:
    check_candidates(number)
