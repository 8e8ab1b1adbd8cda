"""The verdict in a sentence."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from situgraph.matching.result import MatchResult


def reason(result: MatchResult) -> str:
    """Why the verdict is what it is, with figures."""
    return result.verdict
