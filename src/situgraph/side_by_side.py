"""Our map beside another system's map of the same log: rooms, walls and trajectory.

S-Graphs+ leaves its own graph (``graph.g2o``) and its estimate of each keyframe beside the clouds.
Both are only compared with ours; nothing of them enters a run.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np

from situgraph.geometry.poses import Array
from situgraph.scenegraph.graph import Room, SceneGraph

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from situgraph.io.recording import Recording
    from situgraph.pipeline import Pipeline

NEAR = 1.0  # m between the centres of one room, as in S-Graphs+
SAME_WAY = 0.95  # cosine between the normals of one wall
FILE = "side-by-side.png"


class Pair(msgspec.Struct, frozen=True):
    """One room of theirs and ours: m between the centres, walls of both, offset differences (m).

    ``ours`` is None where we have no such room; ``walls`` are those that both bound the room with.
    """

    theirs: str
    ours: str | None
    apart: float | None
    planes_theirs: int
    planes_ours: int
    walls: tuple[float, ...] = ()


class Comparison(msgspec.Struct, frozen=True):
    """Rooms of theirs, rooms that only we have, and how far the trajectories lie apart (m, plan).

    ``trajectory_rms`` is without alignment: both maps start in the same frame.
    """

    rooms: tuple[Pair, ...]
    only_ours: tuple[str, ...]
    wall_median: float | None
    trajectory_rms: float | None


def other_map(recording: Recording, log: str | Path) -> SceneGraph | None:
    """The other system's map that lies beside a log of keyframes; None where there is none."""
    from situgraph.io.keyframes import KeyframeRecording

    file = Path(log) / "graph.g2o"
    if not isinstance(recording, KeyframeRecording) or not file.is_file():
        return None
    from situgraph.io.g2o import read_g2o

    return read_g2o(file, "free")


def save_beside(
    recording: Recording, log: str | Path, pipeline: Pipeline, folder: str | Path
) -> Comparison | None:
    """Compare a run with the map that lies beside its log and draw both; None without one."""
    from situgraph.view import save_figure

    theirs = other_map(recording, log)
    if theirs is None:
        return None
    ours = pipeline.graph
    comparison = compare(ours, theirs, pipeline.slam.trajectory(), recording)
    save_figure(draw(ours, theirs, comparison), Path(folder) / FILE)
    return comparison


def compare(
    ours: SceneGraph, theirs: SceneGraph, trajectory: tuple[Array, Array], recording: Recording
) -> Comparison:
    """Compare both maps, given in the same frame, and the poses (n, 7) at the stamps (n,)."""
    pairs, used = [], set()
    for room in theirs.rooms:
        near = min(ours.rooms, key=lambda r, room=room: _apart(r, room), default=None)  # type: ignore[misc]
        if near is None or _apart(near, room) > NEAR:
            pairs.append(Pair(room.id, None, None, len(room.planes), 0))
            continue
        used.add(near.id)
        walls = tuple(_walls(near, ours, room, theirs))
        apart = _apart(near, room)
        pairs.append(Pair(room.id, near.id, apart, len(room.planes), len(near.planes), walls))
    offsets = np.abs([w for p in pairs for w in p.walls])
    return Comparison(
        tuple(pairs),
        tuple(r.id for r in ours.rooms if r.id not in used),
        float(np.median(offsets)) if len(offsets) else None,
        _trajectories(trajectory, recording),
    )


def _apart(a: Room, b: Room) -> float:
    return float(np.hypot(a.center[0] - b.center[0], a.center[1] - b.center[1]))


def _walls(a: Room, ours: SceneGraph, b: Room, theirs: SceneGraph) -> list[float]:
    """Their walls of a room less ours, measured from the room's centre."""
    out = []
    middle = np.array(b.center[:2])
    for name in b.planes:
        their = theirs.plane_by_id[name]
        n = np.array(their.normal[:2]) / np.hypot(*their.normal[:2])
        for key in a.planes:
            our = ours.plane_by_id[key]
            m = np.array(our.normal[:2]) / np.hypot(*our.normal[:2])
            if float(n @ m) > SAME_WAY:
                d = n @ middle + their.offset / np.hypot(*their.normal[:2])
                out.append(float(d - (m @ middle + our.offset / np.hypot(*our.normal[:2]))))
                break
    return out


def _trajectories(trajectory: tuple[Array, Array], recording: Recording) -> float | None:
    from situgraph.io.keyframes import KeyframeRecording
    from situgraph.slam.evaluation import associated

    if not isinstance(recording, KeyframeRecording):
        return None
    stamps, estimates = recording.estimates()
    i, j = associated(stamps, trajectory[0])
    if not len(i):
        return None
    off = np.linalg.norm(estimates[i, :2] - trajectory[1][j, :2], axis=1)
    return float(np.sqrt(np.mean(off**2)))


def table(comparison: Comparison) -> tuple[list[str], list[list[Any]]]:
    """Columns and rows for people."""
    columns = ["theirs", "ours", "centres apart", "walls, theirs", "walls, ours", "offsets apart"]
    rows: list[list[Any]] = [
        [
            p.theirs,
            p.ours or "not found",
            "" if p.apart is None else f"{p.apart:.2f} m",
            p.planes_theirs,
            p.planes_ours or None,
            ", ".join(f"{100 * w:+.0f}" for w in p.walls) + (" cm" if p.walls else ""),
        ]
        for p in comparison.rooms
    ]
    return columns, rows + [["", name, "", None, None, ""] for name in comparison.only_ours]


def draw(ours: SceneGraph, theirs: SceneGraph, comparison: Comparison) -> Figure:
    """Their map and ours in two pictures of one scale: walls of rooms, rooms, keyframes."""
    from matplotlib.figure import Figure

    found = sum(p.ours is not None for p in comparison.rooms)
    rms = comparison.trajectory_rms
    figure = Figure(figsize=(10.0, 8.5))
    figure.suptitle(
        f"{found} of their {len(comparison.rooms)} rooms found"
        + ("" if rms is None else f"; trajectories {100 * rms:.0f} cm apart (rms, in the plan)")
    )
    panels = figure.subplots(1, 2, sharex=True, sharey=True)
    for axes, graph, name in zip(panels, (theirs, ours), ("the other system", "situgraph")):
        for room in graph.rooms:
            corners = _outline(room, graph)
            axes.fill(corners[:, 0], corners[:, 1], color="#dfe6ee", zorder=1)
            x, y = room.center[:2]
            axes.annotate(f"{room.id}\n{len(room.planes)} walls", (x, y), ha="center", va="center",
                          fontsize=8, zorder=4)  # fmt: skip
            for a, b in zip(corners, np.roll(corners, -1, axis=0)):
                axes.plot([a[0], b[0]], [a[1], b[1]], color="#2f3a4f", linewidth=1.4, zorder=2)
        path = np.array([k.pose[:2] for k in graph.keyframes])
        if len(path):
            axes.plot(path[:, 0], path[:, 1], ".-", color="#b0457c", linewidth=0.8, zorder=3)
        axes.set_title(f"{name}: {len(graph.rooms)} rooms")
        axes.set_aspect("equal")
        axes.set_xlabel("x (m)")
    panels[0].set_ylabel("y (m)")
    figure.tight_layout()
    return figure


def _outline(room: Room, graph: SceneGraph) -> Array:
    """The footprint (n, 2), or where there is none the corners of the room's planes."""
    if room.footprint:
        return np.array(room.footprint, dtype=float)
    lines = [
        (p.normal[0], p.normal[1], p.offset) for p in map(graph.plane_by_id.get, room.planes) if p
    ]
    lines.sort(key=lambda n: float(np.arctan2(n[1], n[0])))
    corners = []
    for a, b in zip(lines, [*lines[1:], lines[0]]):
        matrix = np.array([a[:2], b[:2]])
        if abs(np.linalg.det(matrix)) > 0.1:
            corners.append(np.linalg.solve(matrix, [-a[2], -b[2]]))
    return np.array(corners).reshape(-1, 2)
