"""Draw a map that drift has bent, placed in parts (docs/matching.md, section 12).

    python scripts/bent_picture.py docs/pictures/bent.png

Left the map as it is, under the one rigid motion that is nearest to all parts; right each part
where it lies.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import matplotlib.pyplot as plt
from matplotlib.axes import Axes

from situgraph.matching import match
from situgraph.matching.bent_solution import BentSolution
from situgraph.plan.layouts import make_layout
from situgraph.plan.sampler import sample_online
from situgraph.plan.sampler_config import REALISTIC
from situgraph.scenegraph.graph import SceneGraph
from situgraph.scenegraph.transform import transformed
from situgraph.view.palette import INK, MATCH, MUTED, UNEXPLAINED
from situgraph.view.placed import placed
from situgraph.view.record import read_record


def main(target: Path) -> None:
    """Draw it."""
    plan = make_layout("random", 100, 4)
    online = sample_online(plan, 30, 4, REALISTIC).online
    result = match(online, plan)
    best = result.best
    assert isinstance(best, BentSolution)
    colors = {
        room: MATCH[k % len(MATCH)] for k, part in enumerate(best.parts) for room in part.rooms
    }
    figure, axes = plt.subplots(1, 2, figsize=(9.0, 6.6), layout="constrained")
    solution = read_record(result.to_dict()).solutions[0]
    for ax, graph, title in (
        (axes[0], transformed(online, best.transform), "one placement for all: none explains 24"),
        (
            axes[1],
            placed(online, solution),
            f"{len(best.parts)} parts, bent by {math.degrees(best.bend):.1f} deg",
        ),
    ):
        _outline(ax, plan, dict.fromkeys((r.id for r in plan.rooms), "none"), MUTED, 2.0)
        _outline(ax, graph, {r.id: colors.get(r.id, "none") for r in graph.rooms}, INK, 0.8)
        ax.set_title(title, fontsize=10)
        ax.set_aspect("equal")
        ax.axis("off")
        _frame(ax, graph)
    figure.savefig(target, dpi=130)


def _outline(ax: Axes, graph: SceneGraph, fills: dict[str, str], color: str, width: float) -> None:
    for room in graph.rooms:
        if room.footprint:
            x, y = zip(*room.footprint, strict=True)
            fill = fills[room.id]
            if fill != "none":
                ax.fill(x, y, facecolor=fill, alpha=0.5, linewidth=0)
            edge = UNEXPLAINED if fill == "none" and color == INK else color
            ax.plot([*x, x[0]], [*y, y[0]], color=edge, linewidth=width)


def _frame(ax: Axes, graph: SceneGraph) -> None:
    points = [p for room in graph.rooms for p in room.footprint or ()]
    x, y = zip(*points, strict=True)
    ax.set_xlim(min(x) - 2, max(x) + 2)
    ax.set_ylim(min(y) - 2, max(y) + 2)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
