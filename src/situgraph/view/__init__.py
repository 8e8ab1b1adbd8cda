"""Pictures and reports of graphs, matches and experiments.

Everything here draws from scene graphs and from the match JSON, so it depends on no other stage.
The public names are loaded on first use: matplotlib is heavy.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

# public name -> the module it comes from
_HOME = {
    "Report": "situgraph.view.report",
    "Section": "situgraph.view.report",
    "Status": "situgraph.view.track",
    "Surface": "situgraph.view.surfaces",
    "ViewConfig": "situgraph.view.config",
    "draw_advice": "situgraph.view.advice",
    "draw_deviations": "situgraph.view.deviations",
    "draw_graph": "situgraph.view.plan",
    "draw_history": "situgraph.view.track",
    "draw_lines": "situgraph.view.experiments",
    "draw_match": "situgraph.view.match",
    "draw_outcomes": "situgraph.view.experiments",
    "draw_reliability": "situgraph.view.experiments",
    "draw_rivals": "situgraph.view.rivals",
    "draw_scale": "situgraph.view.experiments",
    "draw_surfaces": "situgraph.view.surfaces",
    "draw_track": "situgraph.view.track",
    "graph_report": "situgraph.view.graph_report",
    "match_report": "situgraph.view.match_report",
    "save_figure": "situgraph.view.canvas",
}

__all__ = [
    "Report",
    "Section",
    "Status",
    "Surface",
    "ViewConfig",
    "draw_advice",
    "draw_deviations",
    "draw_graph",
    "draw_history",
    "draw_lines",
    "draw_match",
    "draw_outcomes",
    "draw_reliability",
    "draw_rivals",
    "draw_scale",
    "draw_surfaces",
    "draw_track",
    "graph_report",
    "match_report",
    "save_figure",
]

if TYPE_CHECKING:
    from situgraph.view.advice import draw_advice
    from situgraph.view.canvas import save_figure
    from situgraph.view.config import ViewConfig
    from situgraph.view.deviations import draw_deviations
    from situgraph.view.experiments import draw_lines, draw_outcomes, draw_reliability, draw_scale
    from situgraph.view.graph_report import graph_report
    from situgraph.view.match import draw_match
    from situgraph.view.match_report import match_report
    from situgraph.view.plan import draw_graph
    from situgraph.view.report import Report, Section
    from situgraph.view.rivals import draw_rivals
    from situgraph.view.surfaces import Surface, draw_surfaces
    from situgraph.view.track import Status, draw_history, draw_track


def __getattr__(name: str) -> Any:
    """Import a public name from its module when it is first asked for."""
    if name not in _HOME:
        raise AttributeError(f"module 'situgraph.view' has no attribute {name!r}")
    value = getattr(importlib.import_module(_HOME[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
