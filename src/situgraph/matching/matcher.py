"""Matching an online graph with a plan: ``match``."""

from __future__ import annotations

import time
from typing import Literal

import numpy as np

from situgraph.matching.compiled import announce_compilation
from situgraph.matching.config import MatchingConfig
from situgraph.matching.containment import content_of, no_content
from situgraph.matching.entries import find_peaks
from situgraph.matching.index import PlanIndex
from situgraph.matching.posterior import judge, log_outside
from situgraph.matching.reading import limits_of, plan_lines, raw_rooms, seen_table, storey_heights
from situgraph.matching.result import MatchResult
from situgraph.matching.solution import Inputs
from situgraph.matching.storeys import storey_shifts
from situgraph.scenegraph.graph import SceneGraph

Semantics = Literal["none", "containment", "likelihood"]


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
        online: the graph to place.
        index: the plan, or its graph (then the index is built first).
        semantics: ``none`` uses walls only; ``containment`` is the paper's filter (section
            'Semantic-enhanced graph matching'); ``likelihood`` weighs objects with error rates.
        config: settings; by default those of the index.

    Raises:
        InputError: a room names a plane that is not there.
    """
    begin = time.perf_counter()
    if isinstance(index, SceneGraph):
        index = PlanIndex(index, config)
    settings = config or index.config
    limits = limits_of(settings)
    announce_compilation(find_peaks)
    centers, planes, names, counts = raw_rooms(online)
    kept, first, normal, distance, source = plan_lines(
        centers, planes, names, counts, settings.usable_tilt
    )
    heights, storeys = np.unique(storey_heights(online)[kept], return_inverse=True)
    every = np.zeros(len(counts), dtype=np.int64)
    every[kept] = storeys
    seen, middle = seen_table(centers, kept, first, normal, distance, source, every, limits)
    shifts, mapping = storey_shifts(heights, index.elevations, settings.storey_tolerance)
    content = no_content()
    if semantics == "containment":
        room_ids = [online.rooms[k].id for k in kept]
        row_ids = [online.planes[k].id for k in source]
        content = content_of(online, index.stock, room_ids, row_ids)
    least = settings.least_rooms(len(kept))
    searched = time.perf_counter()
    if len(kept) and index.rooms:
        peaks, alike, done = find_peaks(seen, index.table, limits, content, mapping, least)
    else:
        peaks, alike, done = (
            np.empty((0, 5)),
            np.zeros(len(kept), dtype=np.int64),
            np.zeros(4, dtype=np.int64),
        )
    shift = peaks[:, 0].astype(np.int64)
    peaks[:, 0] = shifts[shift] if len(shift) else 0.0
    outside = log_outside(alike, seen.shape, index.rooms, settings)
    inputs = Inputs(
        online, index, settings, semantics, kept, source, seen, middle, content, mapping, limits
    )
    if semantics == "likelihood":
        for k in range(len(peaks)):
            yaw, x, y = peaks[k, 1:4].tolist()
            peaks[k, 4] += inputs.evidence(int(shift[k]), yaw, x, y).value
    posterior = judge(peaks, shift, outside, index.area, settings)
    end = time.perf_counter()
    return MatchResult(inputs, posterior, alike, done, (end - searched, end - begin))
