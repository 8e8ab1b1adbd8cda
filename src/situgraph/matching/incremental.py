"""Matching a graph that grows."""

from __future__ import annotations

from situgraph.matching.config import MatchingConfig
from situgraph.matching.index import PlanIndex
from situgraph.matching.matcher import Semantics, match
from situgraph.matching.result import MatchResult
from situgraph.scenegraph.graph import SceneGraph


class Matcher:
    """Matches each state of a growing online graph with one plan.

    ``update`` gives exactly what ``match`` gives for the same graph: a new room can lower what a
    candidate has to explain of the old ones, so no earlier result may stand in for a search. What
    is kept is the last result, and a graph that did not change is not searched again.

    Attributes:
        result: the last result, None before the first update.
    """

    def __init__(
        self,
        index: PlanIndex | SceneGraph,
        *,
        semantics: Semantics = "likelihood",
        config: MatchingConfig | None = None,
    ) -> None:
        """Index the plan, unless it is indexed already; arguments as those of ``match``."""
        self.index = PlanIndex(index, config) if isinstance(index, SceneGraph) else index
        self.semantics = semantics
        self.config = config or self.index.config
        self.result: MatchResult | None = None
        self._online: SceneGraph | None = None

    def update(self, online: SceneGraph) -> MatchResult:
        """Match the graph as it is now.

        Raises:
            InputError: a room names a plane that is not there.
        """
        if self.result is None or not self._unchanged(online):
            self.result = match(online, self.index, semantics=self.semantics, config=self.config)
            self._online = online
        return self.result

    def _unchanged(self, online: SceneGraph) -> bool:
        """Whether all that a match looks at is as it was."""
        before = self._online
        return before is online or (
            before is not None
            and before.rooms == online.rooms
            and before.planes == online.planes
            and before.objects == online.objects
            and before.storeys == online.storeys
        )
