"""situgraph locates a robot in its building by matching scene graphs.

The public names are loaded on first use, so that ``import situgraph`` is quick.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

# public name -> the module it comes from
_HOME = {
    "ConfigError": "situgraph.errors",
    "InputError": "situgraph.errors",
    "MissingExtraError": "situgraph.errors",
    "SituGraphError": "situgraph.errors",
    "Placement": "situgraph.geometry.poses",
    "SceneGraph": "situgraph.scenegraph.graph",
    "Settings": "situgraph.config",
    "load_settings": "situgraph.config",
    "load": "situgraph.api",
    "read_plan": "situgraph.api",
    "save": "situgraph.api",
    "Sampler": "situgraph.plan.sampler",
    "make_layout": "situgraph.plan.layouts",
    "MatchResult": "situgraph.matching",
    "Matcher": "situgraph.matching",
    "PlanIndex": "situgraph.matching",
    "match": "situgraph.matching",
    "Located": "situgraph.coupling",
    "locate": "situgraph.coupling",
    "pairs_of": "situgraph.coupling",
    "Pipeline": "situgraph.pipeline",
    "open_recording": "situgraph.io.recording",
}

__all__ = [
    "ConfigError",
    "InputError",
    "Located",
    "MatchResult",
    "Matcher",
    "MissingExtraError",
    "Pipeline",
    "Placement",
    "PlanIndex",
    "Sampler",
    "SceneGraph",
    "Settings",
    "SituGraphError",
    "__version__",
    "load",
    "load_settings",
    "locate",
    "make_layout",
    "match",
    "open_recording",
    "pairs_of",
    "read_plan",
    "save",
]

if TYPE_CHECKING:
    from situgraph.api import load, read_plan, save
    from situgraph.config import Settings, load_settings
    from situgraph.coupling import Located, locate, pairs_of
    from situgraph.errors import ConfigError, InputError, MissingExtraError, SituGraphError
    from situgraph.geometry.poses import Placement
    from situgraph.io.recording import open_recording
    from situgraph.matching import Matcher, MatchResult, PlanIndex, match
    from situgraph.pipeline import Pipeline
    from situgraph.plan.layouts import make_layout
    from situgraph.plan.sampler import Sampler
    from situgraph.scenegraph.graph import SceneGraph


def __getattr__(name: str) -> Any:
    """Import a public name from its module when it is first asked for."""
    if name not in _HOME:
        raise AttributeError(f"module 'situgraph' has no attribute {name!r}")
    value = getattr(importlib.import_module(_HOME[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
