"""Draws the storeys of a building on axes: one collection for all things of a kind."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Final

import msgspec
import numpy as np

from situgraph.geometry.poses import Array, pose_to_matrix
from situgraph.scenegraph.graph import Object
from situgraph.view import palette
from situgraph.view.faces import Faces
from situgraph.view.floors import Floor, Shape
from situgraph.view.glyphs import glyphs
from situgraph.view.openings import Opening
from situgraph.view.outlines import Outline

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_READABLE_DOOR = 2.5  # points, a narrower door is a gap in the wall
READABLE_OBJECT = 2.0  # points a metre, below which objects are left out
_DOUBLE = 1.35  # m, wider doors have two leaves
_ARC = np.linspace(0.0, 0.5 * np.pi, 13)
NO_WALL: Final = (3.0, 2.2)  # dashes, in line widths
ENDLESS: Final = (5.0, 4.0)
CUT: Final = (1.2, 2.2)


class Look(msgspec.Struct, frozen=True):
    """The colours of a drawn storey, and whether its objects and path are drawn."""

    wall: str = palette.WALL
    one_face: str = palette.WALL_ONE
    door: str = palette.DOOR
    window: str = palette.WINDOW
    contents: bool = True


PLAIN: Final = Look()
# A plan that something else is drawn over.
UNDER: Final = Look(
    palette.WALL_ONE, palette.HAIRLINE, palette.UNEXPLAINED, palette.UNEXPLAINED, False
)


def draw_floor(axes: Axes, floor: Floor, scale: float, look: Look = PLAIN) -> None:
    """Rooms, walls, doors, windows, objects and path of a storey; for names: ``draw_names``.

    ``scale`` is in points a metre.
    """
    _rooms(axes, floor.rooms)
    if floor.walls.solid or floor.walls.one_face:
        fill_rings(axes, floor.walls.one_face, look.one_face, 2.0)
        fill_rings(axes, floor.walls.solid, look.wall, 2.1)
        strokes(axes, floor.walls.edges, look.wall, 0.7, 2.2)
    else:
        real = floor.faces.only(~floor.faces.virtual & floor.faces.in_room)
        strokes(axes, real.segments, look.wall, min(0.9, max(0.15, 0.12 * scale)), 2.2)
    virtual = floor.faces.only(floor.faces.virtual)
    strokes(axes, virtual.segments, palette.UNEXPLAINED, 0.7, 2.3, NO_WALL)
    endless = floor.faces.only(floor.faces.infinite)
    strokes(axes, endless.segments, palette.WALL_ONE, 0.6, 1.5, ENDLESS)
    _loose_faces(axes, floor.loose_faces(), scale, look.wall)
    _doors(axes, [o for o in floor.openings if o.kind == "door"], scale, look.door)
    _windows(axes, [o for o in floor.openings if o.kind == "window"], scale, look)
    if look.contents:
        draw_objects(axes, floor.objects, scale)
        draw_path(axes, floor.path)


def strokes(
    axes: Axes, segments: Sequence[Array] | Array, color: str, width: float, order: float,
    dashes: tuple[float, float] | None = None, alpha: float = 1.0,
) -> None:  # fmt: skip
    """Polylines in one collection."""
    if len(segments):
        from matplotlib.collections import LineCollection

        style = "solid" if dashes is None else (0, dashes)
        axes.add_collection(
            LineCollection(
                list(segments), colors=color, linewidths=width, zorder=order, linestyles=[style],
                capstyle="butt" if dashes else "projecting", alpha=alpha,
            ),
            autolim=False,
        )  # fmt: skip


def fill_polygons(
    axes: Axes, polygons: Sequence[Array], colors: Sequence[str] | str, order: float,
    edge: str = "none", width: float = 0.0, alpha: float = 1.0, hatch: str | None = None,
) -> None:  # fmt: skip
    """Polygons in one collection."""
    if len(polygons):
        from matplotlib.collections import PolyCollection

        axes.add_collection(
            PolyCollection(
                list(polygons), facecolors=colors, edgecolors=edge, linewidths=width, zorder=order,
                alpha=alpha, hatch=hatch,
            ),
            autolim=False,
        )  # fmt: skip


def fill_rings(axes: Axes, polygons: Sequence[tuple[Array, ...]], color: str, order: float) -> None:
    """Polygons with holes, as one path."""
    if polygons:
        from matplotlib.patches import PathPatch
        from matplotlib.path import Path

        rings = [ring for polygon in polygons for ring in polygon]
        codes = [np.full(len(r), Path.LINETO, dtype=np.uint8) for r in rings]
        for code in codes:
            code[0], code[-1] = Path.MOVETO, Path.CLOSEPOLY
        path = Path(np.concatenate(rings), np.concatenate(codes))
        axes.add_patch(PathPatch(path, facecolor=color, edgecolor="none", zorder=order))


def _rooms(axes: Axes, shapes: Iterable[Shape]) -> None:
    outlines = [s.outline for s in shapes if s.outline is not None]
    fill_polygons(axes, [o.polygon for o in outlines], palette.FLOOR, 1.0)
    given = [o.polygon for o in outlines if not o.derived]
    fill_polygons(axes, given, "none", 1.1, palette.FLOOR_EDGE, 0.5)
    strokes(axes, open_edges(outlines), palette.UNEXPLAINED, 0.7, 1.2, CUT)
    lost = np.array([s.center for s in shapes if s.outline is None]).reshape(-1, 2)
    if len(lost):
        axes.scatter(lost[:, 0], lost[:, 1], s=70.0, facecolors="none", linestyles="dotted",
                     edgecolors=palette.UNEXPLAINED, linewidths=0.8, zorder=1.2)  # fmt: skip


def open_edges(outlines: Iterable[Outline]) -> list[Array]:
    """The edges where a room is cut off because nothing bounds it."""
    found = []
    for o in outlines:
        after = np.roll(o.polygon, -1, axis=0)
        found += [np.stack([a, b]) for a, b, cut in zip(o.polygon, after, o.open) if cut]
    return found


def _loose_faces(axes: Axes, faces: Faces, scale: float, color: str) -> None:
    """Faces of no room: a line, and a tick to the side they look to."""
    strokes(axes, faces.segments, color, 0.9, 2.2)
    if len(faces.ids):
        middle = faces.segments.mean(axis=1)
        ticks = np.stack([middle, middle + faces.normals * 5.0 / scale], axis=1)
        strokes(axes, ticks, color, 0.7, 2.2)


def _doors(axes: Axes, doors: Sequence[Opening], scale: float, color: str) -> None:
    fill_polygons(axes, [d.outline(margin=0.005) for d in doors], palette.FLOOR, 2.4)
    readable = [d for d in doors if 2.0 * d.half_width * scale >= _READABLE_DOOR]
    leaves, arcs, bare = [], [], []
    for door in readable:
        if door.leaf:
            for hinge, along, length in _hinges(door):
                leaves.append(np.stack([hinge, hinge + length * door.normal]))
                turn = np.outer(np.cos(_ARC), door.normal) + np.outer(np.sin(_ARC), along)
                arcs.append(hinge + length * turn)
        else:
            corners = door.outline()
            bare += [corners[[0, 1]], corners[[2, 3]]]
    width = min(1.0, 0.05 * scale + 0.25)
    strokes(axes, leaves, color, 1.25 * width, 3.1)
    strokes(axes, arcs, color, 0.55 * width, 3.0)
    strokes(axes, bare, color, 0.6, 3.0, (2.0, 1.5))


def _hinges(door: Opening) -> list[tuple[Array, Array, float]]:
    """Hinge, direction to the other jamb and length of each leaf."""
    t, front = door.tangent, door.middle + door.front * door.normal
    w = door.half_width
    if 2.0 * w <= _DOUBLE:
        return [(front - w * t, t, 2.0 * w)]
    return [(front - w * t, t, w), (front + w * t, -t, w)]


def _windows(axes: Axes, windows: Sequence[Opening], scale: float, look: Look) -> None:
    corners = [w.outline() for w in windows]
    fill_polygons(axes, corners, palette.PAPER, 2.5)
    width = min(0.8, 0.04 * scale + 0.2)
    strokes(axes, [np.concatenate([c, c[:1]]) for c in corners], look.wall, 0.7 * width, 3.0)
    panes = [
        np.stack([c[0] + f * (c[3] - c[0]), c[1] + f * (c[2] - c[1])])
        for c in corners
        for f in (0.36, 0.64)
    ]
    strokes(axes, panes, look.window, width, 3.1)


def draw_objects(axes: Axes, objects: Sequence[Object], scale: float) -> None:
    """A symbol for each category, and the size of what stands in a room, where known."""
    if scale < READABLE_OBJECT or not objects:
        return
    _footprints(axes, [o for o in objects if o.ellipsoid is not None and o.rooms], scale)
    size = float(np.clip(0.3 * scale, 2.0, 5.5))
    for name, glyph in glyphs(o.category for o in objects).items():
        at = np.array([o.center[:2] for o in objects if o.category == name])
        axes.scatter(at[:, 0], at[:, 1], s=size**2, marker=glyph.marker, facecolors=glyph.face,
                     edgecolors=glyph.edge, linewidths=0.14 * size + 0.1, zorder=4.0)  # fmt: skip


def _footprints(axes: Axes, objects: Sequence[Object], scale: float) -> None:
    """A rectangle as long and wide as each object's ellipsoid."""
    ellipsoids = [o.ellipsoid for o in objects if o.ellipsoid is not None]
    if not ellipsoids:
        return
    turn = pose_to_matrix([(0.0, 0.0, 0.0, *e.rotation) for e in ellipsoids])[:, :2, :3]
    shape = turn * np.array([e.axes for e in ellipsoids])[:, None, :]
    # The columns of ``half`` are the half axes of the ellipsoid's shadow on the floor.
    values, vectors = np.linalg.eigh(shape @ np.swapaxes(shape, 1, 2))
    half = vectors * np.sqrt(np.maximum(values, 0.0))[:, None, :]
    signs = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
    centers = np.array([o.center[:2] for o in objects])
    corners = centers[:, None, :] + signs @ np.swapaxes(half, 1, 2)
    width = min(0.5, 0.02 * scale)
    fill_polygons(axes, list(corners), palette.HAIRLINE, 3.5, palette.OBJECT, width, alpha=0.5)


def draw_path(axes: Axes, path: Array, color: str = palette.PATH) -> None:
    """A trajectory, hollow where it starts and filled where it ends."""
    if not len(path):
        return
    strokes(axes, [path], color, 1.1, 4.5, alpha=0.9)
    if len(path) <= 300:
        axes.scatter(path[:, 0], path[:, 1], s=3.0, color=color, linewidths=0.0, zorder=4.6)
    ends = ((path[:1], palette.PAPER), (path[-1:], color))
    for at, face in ends:
        axes.scatter(
            at[:, 0],
            at[:, 1],
            s=24.0,
            facecolors=face,
            edgecolors=color,
            linewidths=1.0,
            zorder=4.7,
        )
