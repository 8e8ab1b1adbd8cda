"""A synthetic case as files: the plan, what a robot saw of it, and the truth, each by itself."""

from __future__ import annotations

import os
from collections import Counter
from pathlib import Path
from typing import Any

import msgspec

from situgraph.plan.ifc_writer import write_ifc
from situgraph.plan.sample_truth import OnlineSample, truth_to_json
from situgraph.scenegraph.codec import write_json
from situgraph.scenegraph.files import atomic_folder, write_atomic
from situgraph.scenegraph.graph import SceneGraph


class Synthesis(msgspec.Struct, frozen=True):
    """A prior graph and, where one was asked for, a sample of it."""

    prior: SceneGraph
    sample: OnlineSample | None = None

    def save(self, folder: str | os.PathLike[str], *, ifc: bool = False) -> list[Path]:
        """Write ``prior.json``, ``online.json``, ``truth.json`` and ``prior.ifc`` to a new folder.

        The truth stands in a file of its own, so that nothing that reads the graphs sees it.

        Raises:
            InputError: the folder exists and is not empty, or cannot be written; or ``ifc`` and a
                room has no footprint.
        """
        with atomic_folder(folder) as made:
            write_json(self.prior, made / "prior.json")
            if self.sample is not None:
                write_json(self.sample.online, made / "online.json")
                write_atomic(made / "truth.json", truth_to_json(self.sample.truth))
            if ifc:
                write_ifc(self.prior, made / "prior.ifc")
            names = sorted(p.name for p in made.iterdir())
        return [Path(folder) / name for name in names]

    def summary(self) -> dict[str, Any]:
        """What was made, in counts: JSON-able."""
        found: dict[str, Any] = {"prior": _counts(self.prior)}
        if self.sample is not None:
            truth = self.sample.truth
            found["online"] = _counts(self.sample.online)
            found["truth"] = {
                "placement": msgspec.to_builtins(truth.placement),
                "rooms": len(truth.rooms),
                "contiguous": truth.contiguous,
                "walked_m": truth.walked[-1],
                "missing_planes": len(truth.missing_planes),
                "moved_planes": len(truth.moved),
                "false_rooms": len(truth.false_rooms),
                "missed_objects": len(truth.missed_objects),
                "false_objects": len(truth.false_objects),
                "duplicates": len(truth.duplicates),
                "confused": len(truth.confused),
                "wrong_wall": len(truth.wrong_wall),
            }
        return found


def _counts(graph: SceneGraph) -> dict[str, Any]:
    nodes = len(graph.rooms) + len(graph.planes) + len(graph.objects)
    return {
        "name": graph.name,
        "storeys": len(graph.storeys),
        "rooms": len(graph.rooms),
        "planes": len(graph.planes),
        "objects": len(graph.objects),
        "object_density": round(len(graph.objects) / max(1, nodes), 4),
        "categories": dict(sorted(Counter(o.category for o in graph.objects).items())),
    }
