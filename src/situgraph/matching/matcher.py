"""Matching an online graph with a plan: ``match``."""

from __future__ import annotations

import math
import time
from typing import Literal, get_args

from situgraph.errors import InputError
from situgraph.matching.candidates import Known
from situgraph.matching.compiled import announce_compilation
from situgraph.matching.config import MatchingConfig
from situgraph.matching.entries import run
from situgraph.matching.index import PlanIndex
from situgraph.matching.mirror import log_mirror
from situgraph.matching.posterior import judge
from situgraph.matching.preparation import prepare
from situgraph.matching.result import Found, MatchResult
from situgraph.matching.tables import CUT
from situgraph.scenegraph.graph import SceneGraph

Semantics = Literal["none", "containment", "likelihood"]
POLICIES: tuple[str, ...] = get_args(Semantics)


def match(
    online: SceneGraph,
    index: PlanIndex | SceneGraph,
    *,
    semantics: Semantics = "likelihood",
    config: MatchingConfig | None = None,
) -> MatchResult:
    """All placements of ``online`` (map frame) in a plan (building frame), and how sure they are.

    The definition of every word is in ``docs/matching.md``.

    Args:
        online: the graph to place. If it declares ``modelled_categories``, others are no evidence.
        index: the plan, or its graph (then the index is built first).
        semantics: ``none`` uses walls only; ``containment`` is the paper's filter (section
            'Semantic-enhanced graph matching'); ``likelihood`` weighs objects with error rates.
        config: settings; by default those of the index.

    Raises:
        InputError: a room names a plane that is not there, an id is there twice, a number is not
            finite; no such policy.
    """
    if isinstance(index, SceneGraph):
        index = PlanIndex(index, config)
    policy = known_policy(semantics)
    return match_knowing(online, index, policy, config or index.config, Known())


def known_policy(semantics: str) -> Semantics:
    """The policy of this name.

    Raises:
        InputError: there is none.
    """
    if semantics in POLICIES:
        return semantics  # type: ignore[return-value]
    remedy = f"it is one of {', '.join(POLICIES)}"
    raise InputError("semantics", f"there is no policy {semantics!r}", remedy)


def match_knowing(
    online: SceneGraph,
    index: PlanIndex,
    semantics: Semantics,
    settings: MatchingConfig,
    known: Known,
) -> MatchResult:
    """``match``, with what is known of earlier ones; ``known`` grows.

    It must be of a graph with the same storeys, rooms and planes, and of this plan, these settings
    and these semantics.
    """
    result = _match_whole(online, index, semantics, settings, known)
    if result.verdict != "none" or not settings.may_be_cut(len(result.inputs.kept)):
        return result
    from situgraph.matching.bent_result import in_parts

    def solve(part: SceneGraph) -> MatchResult:
        return _match_whole(part, index, semantics, settings, Known(), mirror=False)

    return in_parts(result, solve)


def _match_whole(
    online: SceneGraph,
    index: PlanIndex,
    semantics: Semantics,
    settings: MatchingConfig,
    known: Known,
    mirror: bool = True,
) -> MatchResult:
    """What one placement explains of the map; ``mirror``: whether the plan may be mirrored."""
    begin = time.perf_counter()
    announce_compilation(run)
    index = index.looked_for(online.modelled_categories)
    inputs = prepare(online, index, semantics, settings, known.inputs)
    known.read(inputs)
    searched = time.perf_counter()
    peaks = known.find(inputs, inputs.aim)
    outside = math.log(settings.outside_prior) + peaks.similar
    filtered = semantics == "containment"
    posterior = judge(
        peaks.place, peaks.shift, outside, inputs.log_spread, settings, filtered=filtered
    )
    mirrored, complete = -math.inf, not peaks.done[CUT]
    if posterior.verdict == "unique" and mirror and not filtered:
        mirrored, whole = log_mirror(inputs, posterior, known)
        complete = complete and whole
    if mirrored > -math.inf:
        elsewhere = max(outside, mirrored) + math.log1p(math.exp(-abs(outside - mirrored)))
        posterior = judge(peaks.place, peaks.shift, elsewhere, inputs.log_spread, settings)
    end = time.perf_counter()
    found = Found(posterior, peaks.alike, peaks.done, complete, mirrored - posterior.total)
    return MatchResult(inputs, found, (end - searched, end - begin))
