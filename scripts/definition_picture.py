"""Draw what docs/matching.md defines.

    python scripts/definition_picture.py docs/pictures/definition.png

Left, what becomes of a room's planes at a placement; right, L along a line of placements, as the
brute force (which is written from that page alone) has it, and the candidate that the matcher
lists.
"""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import msgspec
import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

from situgraph.experiments.oracle.answer import explained_at
from situgraph.experiments.oracle.definition import Definition
from situgraph.experiments.oracle.grids import grid
from situgraph.experiments.oracle.likelihood import wall_evidence
from situgraph.experiments.oracle.problem import Problem
from situgraph.geometry.poses import Placement
from situgraph.matching import MatchingConfig, PlanIndex, match
from situgraph.scenegraph.graph import SceneGraph
from situgraph.view.palette import HAIRLINE, INK, MATCH, MOVED, MUTED, ONLINE, WALL

WIDTH, DEPTH = 4.0, 5.0  # of the rooms, metres
ASIDE, STEP = 0.2, 0.0005  # how far L is looked at to both sides, metres
MOVES = {"w0-0": 0.3, "e0-1": 0.22}  # walls of the rooms that were built elsewhere, metres


def built(plan: SceneGraph) -> SceneGraph:
    """The plan as it was built, and seen: two walls are elsewhere."""
    planes = [
        msgspec.structs.replace(p, offset=p.offset - MOVES.get(p.id, 0.0)) for p in plan.planes
    ]
    return plan.replace(planes=tuple(planes), kind="online")


def draw_states(axes: Axes) -> None:
    """A room over its plan: walls that fit, one that was moved, one that is missing."""
    fit, moved = Definition().fit_limit, Definition().moved_limit
    for reach, shade in ((moved, 0.10), (fit, 0.22)):
        axes.add_patch(Rectangle((-reach, 0), 2 * reach, DEPTH, color=MATCH[0], alpha=shade, lw=0))
        axes.add_patch(
            Rectangle((WIDTH - reach, 0), 2 * reach, DEPTH, color=MATCH[0], alpha=shade, lw=0)
        )
        axes.add_patch(
            Rectangle((0, DEPTH - reach), WIDTH, 2 * reach, color=MATCH[0], alpha=shade, lw=0)
        )
    axes.plot([WIDTH, WIDTH, 0, 0], [0, DEPTH, DEPTH, 0], color=WALL, lw=4, solid_capstyle="butt")
    west, east, north, south = 0.06, WIDTH + 0.28, DEPTH - 0.1, 0.0
    axes.plot([west, west], [0.25, DEPTH - 0.35], color=ONLINE, lw=2)
    axes.plot([0.3, WIDTH - 0.3], [north, north], color=ONLINE, lw=2)
    axes.plot([east, east], [0.25, DEPTH - 0.35], color=MOVED, lw=2)
    axes.plot([0.3, WIDTH - 0.3], [south, south], color=MUTED, lw=2, ls=(0, (4, 3)))
    axes.text(west + 0.2, 2.4, "fits: 0.06 m", color=ONLINE, rotation=90, va="center")
    axes.text(WIDTH / 2, north - 0.42, "fits: 0.10 m", color=ONLINE, ha="center")
    axes.text(east - 0.67, 2.4, "moved: 0.28 m", color=MOVED, rotation=90, va="center")
    axes.text(WIDTH / 2, 0.2, "missing: none planned", color=MUTED, ha="center")
    axes.set(xlim=(-0.7, WIDTH + 0.7), ylim=(-0.4, DEPTH + 0.6), aspect="equal")
    axes.set_axis_off()
    axes.set_title("Planned walls dark, seen ones in colour", fontsize=9)


def draw_profile(axes: Axes) -> None:
    """L over a shift along x, of two rooms with two moved walls."""
    plan = grid(1, 2, WIDTH, DEPTH)
    online = built(plan)
    problem = Problem(online, plan, "none", Definition())
    shifts = np.arange(-ASIDE, ASIDE + STEP / 2, STEP)
    views = [explained_at(problem, Placement(x=float(x))) for x in shifts]
    heights = np.array([wall_evidence(problem, v) if v.feasible else np.nan for v in views])
    axes.plot(shifts, heights, color=INK, lw=1.5)
    listed = match(
        online, PlanIndex(plan), semantics="none", config=MatchingConfig(rival_ratio=0.0)
    )
    (at,) = [s.transform for s in listed.solutions if abs(s.transform.yaw) < 0.1]
    best = wall_evidence(problem, explained_at(problem, at))
    rival = best - np.log(100)
    axes.axvspan(at.x - 0.3, at.x + 0.3, color=MATCH[0], alpha=0.08, lw=0)
    axes.plot(at.x, best, "o", color=MATCH[0], ms=7)
    axes.axhline(rival, color=MUTED, lw=1, ls=(0, (4, 3)))
    notes = (
        (at.x, best + 0.25, "the candidate: the highest peak of this place", "center", MATCH[0]),
        (0.0, 22.7, "a lower peak", "center", INK),
        (0.108, 21.9, "a wall ceases to fit,\nand is moved", "left", INK),
        (0.155, 18.9, "a room is not explained\nbeyond this", "left", INK),
        (0.365, rival - 0.32, "1 % of the best", "right", MUTED),
        (at.x, 16.2, "the same as the candidate: within 0.3 m", "center", MATCH[0]),
    )
    for x, y, text, side, color in notes:
        axes.text(x, y, text, color=color, ha=side, fontsize=8)
    axes.set(xlim=(-0.25, 0.4), ylim=(16, best + 0.8), xlabel="placement along x (m)", ylabel="L")
    axes.grid(color=HAIRLINE, lw=0.5)
    axes.spines[["top", "right"]].set_visible(False)
    axes.set_title("Two rooms with two moved walls: L of placements side by side", fontsize=9)


def main() -> None:
    figure, (left, right) = plt.subplots(
        1, 2, figsize=(10, 4.2), width_ratios=(1, 1.35), layout="constrained"
    )
    draw_states(left)
    draw_profile(right)
    figure.savefig(Path(sys.argv[1]), dpi=130)


if __name__ == "__main__":
    main()
