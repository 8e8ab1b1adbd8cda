"""The matcher against the brute force on numbered cases: what both test modules assert."""

from __future__ import annotations

from situgraph.experiments.exactness import solve_oracle


def check_candidates(number: int) -> None:
    """Not one candidate of the brute force missed, not one invented."""
    row = solve_oracle({"part": "oracle", "number": number})
    assert row["complete"], row
    assert row["missed"] == 0, row["notes"]
    assert row["invented"] == 0, row["notes"]
