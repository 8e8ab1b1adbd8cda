"""The report of one scene graph."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from situgraph.scenegraph.graph import SceneGraph
from situgraph.view.config import USUAL, ViewConfig
from situgraph.view.floors import survey
from situgraph.view.plan import draw_graph, summary
from situgraph.view.report import Report


def graph_report(
    graph: SceneGraph,
    path: str | os.PathLike[str],
    *,
    storeys: Sequence[str] = (),
    config: ViewConfig = USUAL,
) -> Path:
    """Write a self-contained HTML report of a scene graph and return its path.

    Raises:
        InputError: there is no storey of that name, or the file cannot be written.
    """
    building = survey(graph, config)
    report = Report(graph.name or "Scene graph", summary(building), config)
    for label, count in (
        ("rooms", len(graph.rooms)), ("wall faces", len(graph.planes)),
        ("doors", sum(o.category == "door" for o in graph.objects)),
        ("windows", sum(o.category == "window" for o in graph.objects)),
        ("other objects", sum(o.category not in ("door", "window") for o in graph.objects)),
        ("keyframes", len(graph.keyframes)), ("warnings", len(graph.warnings)),
    ):  # fmt: skip
        report.fact(label, count)
    report.section("Plan").picture(draw_graph(building, config, storeys=storeys, heading=False))
    items = Counter(o.category for o in graph.objects)
    if items:
        rows = [(name.replace("_", " "), count) for name, count in items.most_common()]
        report.section("Objects").table(("category", "count"), rows)
    report.warnings(graph.warnings)
    if graph.attributes:
        report.settings(graph.attributes, "About the source")
    return report.save(path)
