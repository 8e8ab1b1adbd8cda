"""IFC file -> A-Graph: parse, understand, assemble; in a child process by default.

The parser is a large C++ library and the file is nobody's friend: in a child process a crash, a
flood of memory or an endless loop ends that process and becomes one sentence here.
"""

from __future__ import annotations

import contextlib
import os
import sys
import time
from pathlib import Path

import msgspec

from situgraph.errors import InputError
from situgraph.plan.config import PlanConfig
from situgraph.scenegraph.graph import SceneGraph


class Reading(msgspec.Struct, frozen=True):
    """An A-Graph, the wall-clock seconds it took, and its reader's CPU seconds and peak memory."""

    graph: SceneGraph
    seconds: float
    cpu_seconds: float
    peak_mb: float


def read_ifc(path: str | os.PathLike[str], config: PlanConfig | None = None) -> SceneGraph:
    """The A-Graph of an IFC file (2x, 2x3, 4, 4.3), in metres, in the building frame.

    The building frame is the file's world frame, less ``offset_x``, ``offset_y`` and ``offset_z``
    of the graph's attributes where the building stands far from the origin. See ``docs/plan.md``.

    Raises:
        InputError: the file is no IFC, cut off, too large, too slow to read, or holds neither
            spaces nor walls.
    """
    return read_measured(path, config).graph


def read_measured(path: str | os.PathLike[str], config: PlanConfig | None = None) -> Reading:
    """As :func:`read_ifc`, with the time and memory it took.

    Raises:
        InputError: as :func:`read_ifc`.
    """
    from situgraph.plan.ifc_file import check_ifc

    settings = config or PlanConfig()
    start = time.perf_counter()
    check_ifc(path, settings)
    if settings.isolate and sys.executable:
        from situgraph.plan.ifc_child import read_in_child

        graph, cpu, peak = read_in_child(Path(path), settings)
    else:
        before = time.process_time()
        graph = build_graph(path, settings)
        cpu, peak = time.process_time() - before, peak_memory_mb()
    return Reading(graph, time.perf_counter() - start, cpu, peak)


def build_graph(path: str | os.PathLike[str], config: PlanConfig) -> SceneGraph:
    """The A-Graph of an IFC file, made in this process.

    Raises:
        InputError: as :func:`read_ifc`.
    """
    from situgraph.plan.assembly import assemble
    from situgraph.plan.ifc_file import open_ifc
    from situgraph.plan.ifc_model import read_building
    from situgraph.scenegraph.validation import validate

    opened = open_ifc(path, config)
    try:
        building = read_building(opened.model, opened.schema, config)
    except MemoryError:
        raise
    except Exception as error:  # whatever a broken model makes the parser or its entities raise
        reason = " ".join(f"{type(error).__name__}: {error}".split())[:200]
        raise InputError(
            path, f"its contents make no sense ({reason})", "export it again"
        ) from error
    if not building.spaces and not building.walls:
        raise InputError(path, "holds neither spaces nor walls", "export the model with its rooms")
    warnings = (*opened.warnings, *building.warnings)
    graph = assemble(msgspec.structs.replace(building, warnings=warnings), config)
    if not graph.rooms:
        problem = "has no spaces, and its walls enclose no room"
        raise InputError(path, problem, "export the model with its rooms (IfcSpace)")
    return validate(graph.replace(name=Path(path).stem), path)


def peak_memory_mb() -> float:
    """The largest resident memory of this process so far (MB), 0 where it is not known."""
    with contextlib.suppress(OSError):  # Linux; what `resource` says there begins with the parent's
        for line in Path("/proc/self/status").read_text(encoding="ascii").splitlines():
            if line.startswith("VmHWM:"):
                return float(line.split()[1]) * 1.024 / 1e3
    try:
        import resource
    except ImportError:  # no such thing on Windows
        return 0.0
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (1e6 if sys.platform == "darwin" else 1e3 / 1.024)
