"""A-Graph + S-Graph -> solutions: where the map lies in the building, and how sure that is.

The names below are loaded when they are first used: settings alone need no compiler.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from situgraph.matching.config import MatchingConfig
    from situgraph.matching.incremental import Matcher
    from situgraph.matching.index import PlanIndex
    from situgraph.matching.matcher import match
    from situgraph.matching.result import MatchResult
    from situgraph.matching.solution import Solution

_HOME = {
    "MatchResult": "result",
    "Matcher": "incremental",
    "MatchingConfig": "config",
    "PlanIndex": "index",
    "Solution": "solution",
    "match": "matcher",
}
__all__ = ["MatchResult", "Matcher", "MatchingConfig", "PlanIndex", "Solution", "match"]


def __getattr__(name: str) -> object:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)
