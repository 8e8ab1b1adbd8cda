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
    "ViewConfig": "situgraph.view.config",
    "draw_advice": "situgraph.view.advice",
    "draw_graph": "situgraph.view.plan",
    "draw_match": "situgraph.view.match",
    "draw_rivals": "situgraph.view.rivals",
    "graph_report": "situgraph.view.graph_report",
    "match_report": "situgraph.view.match_report",
    "save_figure": "situgraph.view.canvas",
}

__all__ = [
    "Report",
    "Section",
    "ViewConfig",
    "draw_advice",
    "draw_graph",
    "draw_match",
    "draw_rivals",
    "graph_report",
    "match_report",
    "save_figure",
]

if TYPE_CHECKING:
    from situgraph.view.advice import draw_advice
    from situgraph.view.canvas import save_figure
    from situgraph.view.config import ViewConfig
    from situgraph.view.graph_report import graph_report
    from situgraph.view.match import draw_match
    from situgraph.view.match_report import match_report
    from situgraph.view.plan import draw_graph
    from situgraph.view.report import Report, Section
    from situgraph.view.rivals import draw_rivals


def __getattr__(name: str) -> Any:
    """Import a public name from its module when it is first asked for."""
    if name not in _HOME:
        raise AttributeError(f"module 'situgraph.view' has no attribute {name!r}")
    value = getattr(importlib.import_module(_HOME[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
