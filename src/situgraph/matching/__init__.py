"""A-Graph + S-Graph -> solutions: where the map lies in the building, and how sure that is."""

from situgraph.matching.config import MatchingConfig
from situgraph.matching.index import PlanIndex
from situgraph.matching.matcher import match
from situgraph.matching.result import MatchResult
from situgraph.matching.solution import Solution

__all__ = ["MatchResult", "MatchingConfig", "PlanIndex", "Solution", "match"]
