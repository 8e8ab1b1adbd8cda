"""A small symbol for every category of object."""

from __future__ import annotations

import zlib
from collections.abc import Iterable
from types import MappingProxyType

import msgspec

from situgraph.view import palette


class Glyph(msgspec.Struct, frozen=True):
    """A marker of matplotlib with its colours."""

    marker: str
    face: str = palette.PAPER
    edge: str = palette.OBJECT


# Filled: part of the building; coloured: what people look for; hollow: furniture.
_KNOWN = MappingProxyType(
    {
        "door": Glyph("D", palette.DOOR, palette.DOOR),
        "window": Glyph("s", palette.WINDOW, palette.WINDOW),
        "column": Glyph("s", palette.WALL, palette.WALL),
        "stairs": Glyph("^", palette.WALL_ONE, palette.WALL),
        "ramp": Glyph(">", palette.WALL_ONE, palette.WALL),
        "elevator": Glyph("X", palette.WALL_ONE, palette.WALL),
        "railing": Glyph("d", palette.WALL_ONE, palette.WALL),
        "chimney": Glyph("P", palette.WALL_ONE, palette.WALL),
        "furniture": Glyph("s"),
        "table": Glyph("h"),
        "desk": Glyph("h"),
        "chair": Glyph("o"),
        "sofa": Glyph("p"),
        "bed": Glyph("8"),
        "cabinet": Glyph("D"),
        "shelf": Glyph("d"),
        "sink": Glyph("v", palette.PAPER, palette.WINDOW),
        "toilet": Glyph("o", palette.PAPER, palette.WINDOW),
        "bathtub": Glyph("8", palette.PAPER, palette.WINDOW),
        "radiator": Glyph("d", palette.PAPER, palette.MOVED),
        "extinguisher": Glyph("P", palette.MOVED, palette.MOVED),
        "light": Glyph("*", palette.PAPER, palette.ADVICE),
    }
)
_MARKERS = ("o", "s", "^", "D", "v", "p", "h", "8", "P", "X", "*", "d", "<", ">")
_EDGES = (palette.OBJECT, palette.ONLINE, palette.GOOD, palette.PATH, palette.ADVICE)


def glyphs(categories: Iterable[str]) -> dict[str, Glyph]:
    """A symbol for each category; unknown ones get a free one chosen by their name."""
    found: dict[str, Glyph] = {}
    taken = {(g.marker, g.edge) for g in _KNOWN.values()}
    for name in sorted(set(categories)):
        if name in _KNOWN:
            found[name] = _KNOWN[name]
            continue
        start = zlib.crc32(name.encode())
        for step in range(len(_MARKERS) * len(_EDGES)):
            marker = _MARKERS[(start + step) % len(_MARKERS)]
            edge = _EDGES[(start // len(_MARKERS) + step // len(_MARKERS)) % len(_EDGES)]
            if (marker, edge) not in taken:
                break
        taken.add((marker, edge))
        found[name] = Glyph(marker, palette.PAPER, edge)
    return found
