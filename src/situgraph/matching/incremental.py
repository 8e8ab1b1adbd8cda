"""Matching a graph that grows."""

from __future__ import annotations

from situgraph.matching.candidates import Known
from situgraph.matching.config import MatchingConfig
from situgraph.matching.index import PlanIndex
from situgraph.matching.matcher import Semantics, known_policy, match_knowing
from situgraph.matching.result import MatchResult
from situgraph.scenegraph.graph import SceneGraph


class Matcher:
    """Matches each state of a growing online graph with one plan.

    ``update`` gives exactly what ``match`` gives for the same graph. Where walls find candidates
    and objects only weigh them (all policies but ``containment``), a graph whose rooms and planes
    are as they were is not searched again: its peaks are known, and only its objects are weighed
    anew. With rooms more than before it is searched where the former search could not rule
    placements out, and where the new rooms can be explained (``memory``). Where a room went or is
    not as it was, the search begins anew.

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
        """Index the plan, unless it is indexed already; arguments as those of ``match``.

        Raises:
            InputError: a room of the plan names a plane that is not there; no such policy.
        """
        self.index = PlanIndex(index, config) if isinstance(index, SceneGraph) else index
        self.semantics = known_policy(semantics)
        self.config = config or self.index.config
        self.result: MatchResult | None = None
        self._online: SceneGraph | None = None
        self._known = Known(grows=True)

    def update(self, online: SceneGraph) -> MatchResult:
        """Match the graph as it is now.

        Raises:
            InputError: a room names a plane that is not there.
        """
        same = self._same_walls(online)
        if self.result is not None and same and self._same_objects(online):
            return self.result
        if not same:
            self._known.forget_peaks()
        self.result = match_knowing(online, self.index, self.semantics, self.config, self._known)
        self._online = online
        return self.result

    def _same_walls(self, online: SceneGraph) -> bool:
        before = self._online
        return before is online or (
            before is not None
            and before.rooms == online.rooms
            and before.planes == online.planes
            and before.storeys == online.storeys
        )

    def _same_objects(self, online: SceneGraph) -> bool:
        before = self._online
        return (
            before is not None
            and before.objects == online.objects
            and before.modelled_categories == online.modelled_categories
        )
