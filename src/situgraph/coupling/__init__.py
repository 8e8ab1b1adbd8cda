"""A match and both scene graphs in one factor graph: the robot in the building.

The public names are loaded on first use: gtsam and shapely are heavy.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

# public name -> the module it comes from
_HOME = {
    "Coupled": "situgraph.coupling.coupled",
    "CouplingConfig": "situgraph.coupling.config",
    "Deviation": "situgraph.coupling.deviation",
    "Event": "situgraph.coupling.state",
    "Evidence": "situgraph.coupling.evidence",
    "Located": "situgraph.coupling.located",
    "Locator": "situgraph.coupling.state",
    "Pairs": "situgraph.coupling.located",
    "Reading": "situgraph.coupling.readings",
    "WallEstimate": "situgraph.coupling.coupled",
    "from_scene": "situgraph.coupling.evidence",
    "from_slam": "situgraph.coupling.evidence",
    "locate": "situgraph.coupling.located",
    "pairs_of": "situgraph.coupling.state",
    "spread": "situgraph.coupling.readings",
    "write_bcf": "situgraph.coupling.bcf",
}

__all__ = [
    "Coupled",
    "CouplingConfig",
    "Deviation",
    "Event",
    "Evidence",
    "Located",
    "Locator",
    "Pairs",
    "Reading",
    "WallEstimate",
    "from_scene",
    "from_slam",
    "locate",
    "pairs_of",
    "spread",
    "write_bcf",
]

if TYPE_CHECKING:
    from situgraph.coupling.bcf import write_bcf
    from situgraph.coupling.config import CouplingConfig
    from situgraph.coupling.coupled import Coupled, WallEstimate
    from situgraph.coupling.deviation import Deviation
    from situgraph.coupling.evidence import Evidence, from_scene, from_slam
    from situgraph.coupling.located import Located, Pairs, locate
    from situgraph.coupling.readings import Reading, spread
    from situgraph.coupling.state import Event, Locator, pairs_of


def __getattr__(name: str) -> Any:
    """Import a public name from its module when it is first asked for."""
    if name not in _HOME:
        raise AttributeError(f"module 'situgraph.coupling' has no attribute {name!r}")
    value = getattr(importlib.import_module(_HOME[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
