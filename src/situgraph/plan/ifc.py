"""IFC file -> A-Graph."""

from __future__ import annotations

import os

from situgraph.plan.config import PlanConfig
from situgraph.scenegraph.graph import SceneGraph


def build_graph(path: str | os.PathLike[str], config: PlanConfig) -> SceneGraph:
    """The A-Graph of an IFC file, made in this process."""
    from situgraph.plan.assembly import assemble
    from situgraph.plan.ifc_file import open_ifc
    from situgraph.plan.ifc_model import read_building

    model, schema = open_ifc(path, config)
    return assemble(read_building(model, schema, config), config)


def read_ifc(path: str | os.PathLike[str], config: PlanConfig | None = None) -> SceneGraph:
    """The A-Graph of an IFC file."""
    return build_graph(path, config or PlanConfig())
